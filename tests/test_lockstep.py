"""Offline runs: repeatable to the byte, and honest about frames that are missing."""

import json
import os
import shutil
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from rich.console import Console
from spoiling import Film, copied, cut_off, edit_json, refilmed
from staging import PERIOD_S, RIG

from calibration.gate.odd_camera import OddCamera
from calibration.tracks.lateness import Clock
from common.bus.messages import Body
from common.config.part_settings import SettingsError
from common.config.settings import Settings
from common.method import METHODS, Mode
from common.video.clip_facts import Act, Clip, ClipView, Meta
from common.video.clip_sources import ClipError
from common.video.pictures import Ending
from integrator import diagnostics, merge_state
from integrator.people import recognition
from lab.accuracy.accuracy import compare
from runtime.odd_view import turned_clip
from runtime.offline import lockstep
from runtime.offline.batch import Asked, track_all
from runtime.offline.lockstep import Decoders, Tracked, track_clip
from runtime.offline.performance import Performance, Prepared, Watch
from runtime.offline.rig_check import Witness
from runtime.offline.rig_from_person import Looked
from runtime.overrides import overridden
from runtime.steps.method_cameras import (
    refuse_everyone_unmeasured,
    refuse_too_many,
    refuse_uncalibrated,
)
from runtime.store.past_run import open_run
from runtime.store.pose_arrays import poses
from runtime.store.runs import NO_PERSON_SEEN
from runtime.unfinished.work import Course, InMemory
from synth.write import ClipSet, write_set

QUIET = Console(quiet=True)


def tracked(clip: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    with Decoders() as decoders:
        done = track_clip(Settings(clip=str(clip)), decoders)
    return poses([body for body in done.bodies if body.frame >= 0]), done.facts


@pytest.mark.slow
def test_the_same_clip_gives_the_same_bytes_and_nothing_is_written_but_the_run_folder(
    clip: Path, recorded_run: Path, tmp_path: Path
) -> None:
    before = {path: path.stat().st_mtime_ns for path in clip.parent.rglob("*")}
    track_all([clip], tmp_path, Asked(), QUIET)
    assert {path: path.stat().st_mtime_ns for path in clip.parent.rglob("*")} == before
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert files == {f"{clip.name}/poses.npz", f"{clip.name}/summary.json"}
    again = tmp_path / clip.name / "poses.npz"
    assert (recorded_run / "poses.npz").read_bytes() == again.read_bytes()


@pytest.mark.slow
def test_the_order_of_clips_does_not_change_one(
    clip: Path, tracked_clip: Tracked, tmp_path: Path
) -> None:
    """A decoder that was left in the middle of a film, or used before, reads the next as new."""
    other = copied(clip, tmp_path / "other")
    cut_off(other)
    alone = poses(tracked_clip.bodies)
    with Decoders() as decoders:
        track_clip(Settings(clip=str(other)), decoders)
        after = poses(track_clip(Settings(clip=str(clip)), decoders).bodies)
    for name, values in alone.items():
        np.testing.assert_array_equal(after[name], values, err_msg=name)


@pytest.mark.slow
def test_a_view_that_ends_early_leaves_the_other_to_go_on(clip: Path, tmp_path: Path) -> None:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[:40], cameras=(2,))
    rows, facts = tracked(folder)
    assert rows["frame"].tolist() == list(range(69))
    assert set(rows["views"][15:40]) == {"both"}
    assert set(rows["views"][40:]) == {"1"}
    assert np.isfinite(rows["joints_m"][40:]).all()
    assert facts["warnings"] == ["the views differ in length: 69 and 40 frames"]


def only(kept: list[int]) -> Callable[[Film], Film]:
    return lambda film: [film[i] for i in kept]


@pytest.mark.slow
def test_frames_that_one_camera_missed_are_paired_by_their_moments(
    clip: Path, tmp_path: Path
) -> None:
    """Camera 1 misses frames 30 and 31, camera 2 frame 50; `capture_s` says so."""
    folder = copied(clip, tmp_path / "clip")
    gone = {1: {30, 31}, 2: {50}}
    kept = {n: [i for i in range(69) if i not in gone[n]] for n in (1, 2)}
    for n in (1, 2):
        refilmed(folder, only(kept[n]), cameras=(n,))
    moments = {f"cam{n}": [i / 15 for i in kept[n]] for n in (1, 2)}
    edit_json(folder / "meta.json", lambda meta: meta.update(capture_s=moments))
    rows, facts = tracked(folder)
    assert rows["frame"].tolist() == list(range(67))
    np.testing.assert_allclose(rows["time_s"], moments["cam1"])
    alone = np.flatnonzero(rows["views"] == "1")
    assert [kept[1][row] for row in alone if kept[1][row] > 12] == [50]
    assert facts["warnings"] == []


@pytest.mark.slow
def test_the_stressed_clip_has_a_row_for_each_of_camera_1s_frames(data_dir: Path) -> None:
    folder = data_dir / "dev_stress" / "frame_drops"
    rows, facts = tracked(folder)
    moments = json.loads((folder / "meta.json").read_text())["capture_s"]["cam1"]
    assert rows["frame"].tolist() == list(range(len(moments)))
    np.testing.assert_allclose(rows["time_s"], moments)
    assert facts["warnings"] == []


@pytest.mark.slow
def test_every_nth_frame_keeps_its_number_and_time(clip: Path) -> None:
    with Decoders() as decoders:
        rows = poses(track_clip(Settings(clip=str(clip), every=2), decoders).bodies)
    assert rows["frame"].tolist() == list(range(0, 69, 2))
    np.testing.assert_allclose(rows["time_s"], np.arange(0, 69, 2) / 15)


def test_a_command_line_goes_before_the_settings() -> None:
    given = Settings(mode="paper", size="80x60")
    assert overridden(given, None, None) == given
    assert overridden(given, "default", None) == Settings(mode="default", size="80x60")
    assert overridden(given, None, "96x96") == Settings(mode="paper", size="96x96")
    with pytest.raises(SettingsError, match="must be from 32x32 to 4096x4096 pixels, got 5000x50"):
        overridden(given, None, "5000x50")


@pytest.mark.slow
def test_a_pair_filmed_without_calibration_is_tracked(data_dir: Path, tmp_path: Path) -> None:
    """configs/frontside_walk.toml: its run folder bears the file's name, not a video's."""
    config = Path(__file__).parents[1] / "configs" / "frontside_walk.toml"
    if "TRITRACK_DATA" not in os.environ:
        pytest.skip("the settings name the clips by TRITRACK_DATA")
    pytest.importorskip("skimage", reason="a busy clip needs the extra `single`")
    done = track_all([config], tmp_path, Asked(), QUIET)
    assert list(done["clips"]) == ["frontside_walk"]
    assert done["clips"]["frontside_walk"]["scale_source"] == "person"
    with np.load(tmp_path / "frontside_walk" / "poses.npz", allow_pickle=False) as found:
        assert np.isfinite(found["joints_m"]).all(axis=(1, 2)).mean() > 0.9


@pytest.fixture(scope="module")
def squats(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Somebody who squats, which repeats nothing within two seconds."""
    wanted = ClipSet("postures", seed=90_001, postures=("squat",))
    return write_set(tmp_path_factory.mktemp("squats"), wanted, (160, 120))[0]


@pytest.mark.slow
@pytest.mark.parametrize("calibrated", [True, False], ids=["calibrated", "by the person"])
def test_a_view_that_is_late_is_found_and_the_clip_is_tracked_with_its_times_set_back(
    squats: Path, tmp_path: Path, calibrated: bool
) -> None:
    """Camera 2 was started six frames later: it shows all 0.4 s earlier, and is told so."""
    folder = copied(squats, tmp_path / "clip")
    refilmed(folder, lambda film: film[6:], cameras=(2,))
    if not calibrated:
        (folder / "calibration.json").unlink()
    shown: list[object] = []
    with Decoders() as decoders:
        watch = Watch(lambda *_: shown.append(1), shown.clear)
        done = track_clip(Settings(clip=str(folder)), decoders, watch=watch)
    assert done.facts["clock"]["state"] == "found"
    assert done.facts["clock"]["applied_s"] == pytest.approx(-0.4, abs=0.05)
    assert len(shown) == len(done.bodies)
    if calibrated:
        found = poses([body for body in done.bodies if body.frame >= 0])
        truth = np.load(squats / "truth.npz")
        names = truth["joint_names"].tolist()
        true_m = truth["joints3d"][:, [names.index(name) for name in found["joint_names"]]]
        off_m = np.linalg.norm(found["joints_m"] - true_m[found["frame"]], axis=-1)[29:]
        assert np.nanmean(off_m) < 0.04


@pytest.mark.slow
def test_an_offset_that_is_given_is_used_and_not_looked_for(squats: Path, tmp_path: Path) -> None:
    folder = copied(squats, tmp_path / "clip")
    refilmed(folder, lambda film: film[:40])
    refilmed(folder, lambda film: film[6:], cameras=(2,))
    track_all([folder], tmp_path / "runs", Asked(offset_s=-0.4), QUIET)
    told = json.loads((tmp_path / "runs/clip/summary.json").read_text())
    assert told["clock"] == {
        "state": "given",
        "applied_s": -0.4,
        "may_be_s": [],
        "may_be_on_time": True,
    }
    assert told["settings"]["offset_s"] == -0.4


VIEWS = (
    ClipView(1, "a.avi", (320, 240), (160, 120), 15.0, 60),
    ClipView(2, "b.avi", (320, 240), (160, 120), 15.0, 50, late_s=0.125),
)
PAIR = Clip("pair", VIEWS, 1, None, Meta("anna", "squat", acts=(Act("kick", 3, 9),)), ("short",))


def ready_made(clip: Clip = PAIR) -> Prepared:
    """A clip of which view 2 was cut off."""
    state = merge_state.init(RIG, PERIOD_S, Settings(), METHODS["default"])
    endings = {1: Ending(60), 2: Ending(20, 1)}
    frame_caches: Any = {
        view.number: SimpleNamespace(ending=endings[view.number]) for view in clip.views
    }
    return Prepared(clip, frame_caches, {}, recognition.State(state), ["nothing moves"], 2.34567)


def performed_so(*bodies: Body) -> Performance:
    state = merge_state.init(RIG, PERIOD_S, Settings(), METHODS["default"])
    state = state._replace(scale_source="person")
    seconds = {"viewers": 3.00004, "integrator": 1.0, "following": 4.0}
    noticed = diagnostics.State()
    return Performance(bodies, recognition.State(state), noticed, ("a new rig",), seconds)


def seen_body(frame: int = 0) -> Body:
    moment: dict[str, Any] = {"frame": frame, "captured_s": 0.0, "clock_s": 0.0}
    return Body(
        status="tracking", views="both", joints_m=((0.0, 0.0, 0.0),), confidence=(0.8,), **moment
    )


def test_a_summary_tells_the_clip_its_times_and_all_that_was_odd() -> None:
    """Two bodies in 4 s of following; what a source and the rig told comes last."""
    source: Any = SimpleNamespace(odd=["a landmark is odd"])
    done = performed_so(seen_body(0), seen_body(1))
    facts = lockstep._facts(ready_made(), done, {1: source})
    assert facts["seconds"] == {
        "preparation": 2.3457,
        "viewers": 3.0,
        "integrator": 1.0,
        "following": 4.0,
        "all": 6.3457,
    }
    assert (facts["clip"], facts["performer"], facts["posture_meant"]) == ("pair", "anna", "squat")
    assert [*facts["acts"]] == [{"name": "kick", "first": 3, "last": 9}]
    assert facts["unread"] == {"b.avi": {"read": 20, "of": 50}}
    assert (facts["frames_a_second"], facts["scale_source"]) == (0.5, "person")
    first, second, cut_off, odd, *further = facts["warnings"]
    assert (first, second, odd) == ("short", "nothing moves", "a landmark is odd")
    assert cut_off.startswith("b.avi was cut off or is damaged: 20 of 50 frames")
    assert further[-1] == "a new rig"
    plain = msgspec.structs.replace(PAIR, meta=Meta())
    empty = msgspec.structs.replace(seen_body(), joints_m=(), status="empty")
    facts = lockstep._facts(ready_made(plain), performed_so(empty), {})
    assert "acts" not in facts
    assert NO_PERSON_SEEN in facts["warnings"]


class Told:
    """What is asked when all was followed."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[Any] = []
        monkeypatch.setattr(lockstep, "trust_facts", self.trust)

    def trust(
        self, clip: Clip, witness: Any, clocks: Any, *, insisted: bool, different_people: bool
    ) -> dict[str, Any]:
        assert not different_people
        self.asked.append((clip, witness, clocks, insisted))
        return {}


def job_of(settings: Settings, **more: Any) -> Any:
    given: dict[str, Any] = {"sources": {}, "watch": None, "course": Course(), "heard": {}, **more}
    return lockstep._Job(settings, METHODS["default"], None, **given)  # type: ignore[arg-type]


def test_what_is_told_of_the_clock_is_of_the_clip_as_it_was_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Which clock set the times is told; by the one that is left bodies are doubted, unless the
    user said how late view 2 is."""
    told, witness = Told(monkeypatch), Witness()
    done = lockstep._Followed(ready_made(), performed_so(seen_body()), witness)
    found, left = Clock(0.125), Clock(0.5, (1.0,), False)
    result = lockstep._told(Looked(PAIR, clocks=(found,)), job_of(Settings()), done, (left,))
    assert result.clip == PAIR
    assert result.facts["clock"]["state"] == "found"
    assert result.facts["clock"]["applied_s"] == 0.125
    assert told.asked == [(PAIR, witness, (left,), False)]
    assert [body.confidence for body in result.bodies] == [pytest.approx((0.05 * 0.8,))]
    result = lockstep._told(Looked(PAIR), job_of(Settings()), done, (left,))
    assert result.facts["clock"]["state"] == "ambiguous"
    insists = Settings(offset_s=0.125, trust_calibration=True)
    result = lockstep._told(Looked(PAIR), job_of(insists), done, (left,))
    assert result.facts["clock"]["state"] == "given"
    assert [body.confidence for body in result.bodies] == [(0.8,)]
    assert told.asked[-1][-1] is True
    by_sound = job_of(Settings(offset_s=0.125), heard={2: 0.125})
    assert lockstep._told(Looked(PAIR), by_sound, done, (left,)).facts["clock"]["state"] == "heard"


def test_a_run_that_was_being_tracked_again_goes_on_with_that_clock() -> None:
    """It was left with 0.5 s set back, of which the files tell 0.125."""
    looked = Looked(PAIR)
    left: Any = SimpleNamespace(late_s=(0.5,), odd_camera=None)
    again = lockstep._as_left(looked, Course(work=Left(left)))
    assert [view.late_s for view in again.clip.views] == [0.0, 0.5]
    assert again.clocks == (Clock(0.375),)
    assert lockstep._as_left(looked, Course(work=Left(None))) == looked
    same: Any = SimpleNamespace(late_s=(0.125,), odd_camera=None)
    assert lockstep._as_left(looked, Course(work=Left(same))) == looked


ODD = OddCamera(1, (0.0, 0.03, 0.0), 0.06, 0.01)


def test_a_run_that_was_being_tracked_again_goes_on_with_that_rig() -> None:
    looked = Looked(msgspec.structs.replace(PAIR, rig=RIG))
    left: Any = SimpleNamespace(late_s=(0.125,), odd_camera=ODD)
    again = lockstep._as_left(looked, Course(work=Left(left)))
    assert (again.clip, again.odd) == (turned_clip(looked.clip, ODD), ODD)
    assert again.clip.rig != RIG


@pytest.mark.parametrize(
    ("trusted", "found", "times"),
    [(False, None, 2), (True, None, 1), (False, "by the person", 1)],
    ids=["is odd", "is trusted", "the person told the rig"],
)
def test_a_clip_is_followed_again_where_one_camera_contradicts_all_others(
    monkeypatch: pytest.MonkeyPatch, trusted: bool, found: Any, times: int
) -> None:
    """Once: by the rig in which that camera is turned back."""
    followed: list[Any] = []
    calibrated = msgspec.structs.replace(PAIR, rig=RIG)

    def follow(looked: Looked, *_: object) -> Any:
        followed.append(looked.odd)
        return lockstep._Followed(ready_made(), performed_so(), Witness())

    monkeypatch.setattr(lockstep, "open_clip", lambda *_: calibrated)
    monkeypatch.setattr(lockstep, "outside_sources", lambda *_: nullcontext({}))
    monkeypatch.setattr(lockstep, "by_person", lambda *_: Looked(calibrated, found))
    monkeypatch.setattr(lockstep, "_followed", follow)
    monkeypatch.setattr(lockstep, "clocks_seen", lambda *_: (Clock(0.0),))
    monkeypatch.setattr(lockstep, "odd_camera_of", lambda *_: ODD)
    monkeypatch.setattr(lockstep, "_told", lambda looked, *_: looked)
    decoders: Any = SimpleNamespace(of={1: None, 2: None})
    told: Any = track_clip(Settings(trust_calibration=trusted), decoders)
    assert followed == [None, ODD][:times]
    assert told.odd == followed[-1]


def test_a_clip_whose_person_tells_no_rig_is_refused_for_everyone_with_the_cause(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lockstep, "open_clip", lambda *_: PAIR)
    monkeypatch.setattr(lockstep, "outside_sources", lambda *_: nullcontext({}))
    monkeypatch.setattr(lockstep, "by_person", lambda *_: Looked(PAIR, None, "nobody moves"))
    decoders: Any = SimpleNamespace(of={1: None, 2: None})
    with pytest.raises(ClipError, match=r"takes a calibration \(nobody moves\): make one"):
        track_clip(Settings(people="all"), decoders)


class Left(InMemory):
    """What a run left in its second half."""

    def __init__(self, going: Any) -> None:
        self.going, self.restarts = going, 0

    def resumed(self, stage: str, _kind: type[Any]) -> Any:
        assert stage == "instants"
        return self.going

    def restart(self) -> None:
        self.restarts += 1


@pytest.mark.parametrize(
    ("by_files", "given_s", "late_s", "times"),
    [
        (True, None, 0.4, 2),
        (True, None, 0.01, 1),
        (True, 0.0, 0.4, 1),
        (False, None, 0.4, 1),
    ],
    ids=["is late", "is on time", "its offset is given", "the first pass told it"],
)
def test_a_clip_is_followed_again_where_its_clock_is_found_to_be_off(
    monkeypatch: pytest.MonkeyPatch,
    by_files: bool,
    given_s: float | None,
    late_s: float,
    times: int,
) -> None:
    """With its times set back by that, from nothing that was kept or watched."""
    followed: list[float] = []
    begun: list[int] = []
    clock, work = Clock(late_s), Left(None)
    looked = Looked(PAIR, clocks=() if by_files else (Clock(0.0),))

    def follow(looked: Looked, *_: object) -> Any:
        followed.append(looked.clip.views[1].late_s)
        return lockstep._Followed(ready_made(), performed_so(), Witness())

    monkeypatch.setattr(lockstep, "open_clip", lambda *_: PAIR)
    monkeypatch.setattr(lockstep, "outside_sources", lambda *_: nullcontext({}))
    monkeypatch.setattr(lockstep, "by_person", lambda *_: looked)
    monkeypatch.setattr(lockstep, "_followed", follow)
    monkeypatch.setattr(lockstep, "clocks_seen", lambda *_: (clock,))
    monkeypatch.setattr(lockstep, "_told", lambda looked, *_: looked)
    decoders: Any = SimpleNamespace(of={1: None, 2: None})
    watch = Watch(lambda *_: None, lambda: begun.append(1))
    told: Any = track_clip(
        Settings(offset_s=given_s), decoders, watch=watch, course=Course(work=work)
    )
    assert followed == [0.125, pytest.approx(0.125 + late_s)][:times]
    assert (work.restarts, len(begun)) == (times - 1, times - 1)
    assert told.clip.views[1].late_s == followed[-1]


def test_the_thesis_refuses_two_views_and_one_camera_is_followed_in_two_passes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clips = {2: PAIR, 1: msgspec.structs.replace(PAIR, views=PAIR.views[:1])}
    passes: list[Any] = []
    count = 2
    monkeypatch.setattr(lockstep, "open_clip", lambda *_: clips[count])
    monkeypatch.setattr(lockstep, "_in_two_passes", lambda *given: passes.append(given[2]))
    decoders: Any = SimpleNamespace(of={1: None})
    with pytest.raises(ClipError, match=r"^pair: the thesis's mode is for one camera: add --views"):
        track_clip(Settings(mode="thesis"), decoders)
    assert passes == []
    count = 1
    rig = msgspec.structs.replace(RIG, cameras=RIG.cameras[:1])
    calibrated = msgspec.structs.replace(clips[1], rig=rig)
    track_clip(Settings(mode="thesis"), decoders)
    track_clip(Settings(), decoders)
    track_clip(Settings(mode="paper"), decoders, method=METHODS["default"])
    assert passes == [METHODS["thesis"], METHODS["default"], METHODS["default"]]
    clips[1] = calibrated
    track_clip(Settings(mode="thesis"), decoders)
    assert len(passes) == 4, "whatever it knows of its camera"


@pytest.mark.slow
def test_a_clip_of_three_cameras_is_tracked_by_all_of_them(
    three_views: Path, tmp_path: Path
) -> None:
    done = track_all([three_views], tmp_path, Asked(), Console(quiet=True))
    facts = done["clips"][three_views.name]
    assert facts["cameras"] == ["cam1", "cam2", "cam3"]
    assert facts["trust"]["believed"]
    assert [*facts["clocks"]] == ["cam2", "cam3"]
    run = open_run(tmp_path / three_views.name).poses
    truth = np.load(three_views / "truth.npz")
    both = compare(run, dict(truth))
    assert (both.ghosts, len(both.frames)) == (0, both.due)
    assert both.off_mm.mean() < 30.0
    for n, name in enumerate(run["camera_names"]):
        at = [*run["joint_names"]].index("neck")
        true_px = truth[f"joints2d_{name}"][both.rows, [*truth["joint_names"]].index("neck")]
        off_px = np.linalg.norm(run["joints_px"][both.frames, n, at] - true_px, axis=1)
        assert off_px.mean() < 2.0
    assert run["seen"][both.frames].all()


@pytest.mark.slow
def test_three_cameras_without_a_calibration_are_calibrated_by_their_person(
    three_views: Path, tmp_path: Path
) -> None:
    """The distances between joints are as true as with the calibration, but for the scale."""
    folder = tmp_path / "three"
    shutil.copytree(three_views, folder)
    with Decoders() as decoders:
        done = track_clip(Settings(clip=str(folder)), decoders)
    assert done.facts["scale_source"] == "person"
    assert len(done.facts["calibration"]["cameras"]) == 3
    assert done.facts["trust"]["believed"]
    found = poses(done.bodies)
    truth = np.load(three_views / "truth.npz")
    names = truth["joint_names"].tolist()
    real = truth["joints3d"][:, [names.index(n) for n in found["joint_names"].tolist()]]
    apart = []
    for joints_m in (found["joints_m"], real[found["frame"]]):
        between = np.linalg.norm(joints_m[:, :, None] - joints_m[:, None], axis=-1)
        apart.append(between[-30:])
    scale = np.nanmedian(apart[0][..., 0, 1] / apart[1][..., 0, 1])
    assert scale == pytest.approx(1.0, abs=0.25)
    assert np.nanmean(np.abs(apart[0] / scale - apart[1])) < 0.03


@pytest.mark.slow
def test_two_of_three_cameras_give_what_a_clip_of_these_two_gives(
    three_views: Path, tmp_path: Path
) -> None:
    """Bit for bit, though the rig has a place for the one between."""
    pair = tmp_path / "pair"
    pair.mkdir()
    for name, own in (("cam1", "cam1"), ("cam3", "cam2")):
        os.link(three_views / f"{name}.avi", pair / f"{own}.avi")
    rig = json.loads((three_views.parent / "calibration.json").read_text())
    del rig["cameras"][1]
    rig["cameras"][1]["name"] = "cam2"
    (pair / "calibration.json").write_text(json.dumps(rig))
    with Decoders() as decoders:
        some = poses(track_clip(Settings(clip=str(three_views)), decoders, (1, 3)).bodies)
        alone = poses(track_clip(Settings(clip=str(pair)), decoders).bodies)
    for name in ("frame", "time_s", "joints_m", "angles_deg", "confidence", "status"):
        assert some[name].tobytes() == alone[name].tobytes()
    assert np.array_equal(some["joints_px"][:, [0, 2]], alone["joints_px"], equal_nan=True)
    assert some["camera_names"].tolist() == ["cam1", "cam2", "cam3"]
    assert alone["seen"].any()


@pytest.mark.parametrize(
    ("mode", "calibrated", "said"),
    [
        ("thesis", True, "three: the thesis's mode is for one camera: add --views 1"),
        (
            "paper",
            True,
            "three: the paper's mode is for two cameras: name two .*--views 1,2",
        ),
        ("default", False, "three: 3 cameras need a calibration .it rained.: .*--views 1,2"),
        ("default", True, ""),
    ],
)
def test_three_cameras_are_for_the_default_mode_and_a_calibration(
    mode: Any, calibrated: bool, said: str
) -> None:
    third = ClipView(3, "c.avi", (320, 240), (160, 120), 15.0, 60)
    rig = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    clip = Clip("three", (*VIEWS, third), 1, rig if calibrated else None, Meta())
    if said:
        with pytest.raises(ClipError, match=f"^{said}"):
            _refuse(clip, mode)
    else:
        _refuse(clip, mode)


def _refuse(clip: Clip, mode: Mode) -> None:
    refuse_too_many(clip, METHODS[mode])
    refuse_uncalibrated(clip, "it rained")


def test_everyone_is_followed_where_a_calibration_says_who_is_where() -> None:
    clip = Clip("two", VIEWS, 1, RIG, Meta())
    uncalibrated = msgspec.structs.replace(clip, rig=None)
    everyone = Settings(people="all")
    refuse_everyone_unmeasured(clip, everyone)
    refuse_everyone_unmeasured(uncalibrated, Settings())
    with pytest.raises(ClipError, match=r"^two: to follow everyone takes a calibration: make one"):
        refuse_everyone_unmeasured(uncalibrated, everyone)
    with pytest.raises(ClipError, match=r"takes a calibration \(nobody moves\): make one"):
        refuse_everyone_unmeasured(uncalibrated, everyone, "nobody moves")
