"""Runs, recordings and settings that version 0.2.0 wrote, read by this one.

`data/run_0_2` is what its `tritrack track small.toml --out . --record` made of a clip of its own
`tritrack synth --seed 4242 --posture kick_right_forward --size 160x120`; small.toml is
`data/settings_0_2.toml` with `every = 4` and `size = "80x60"`.
"""

import csv
import shutil
from pathlib import Path

import msgspec
import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.body.observation import Search
from common.bus.false_messages import MalformedMessage
from common.bus.message_codec import encode
from common.bus.messages import PROTOCOL, Body, View
from common.config.config_file import load
from common.config.renamed_settings import RenamedSetting, settings_of
from common.raster.silhouette_report import unpack
from common.rig.camera import project
from integrator.landmarks import joint_marks
from lab.accuracy.tracking_evaluation import _cases
from runtime.store.journal import HEAD, NAME, framed
from runtime.store.older_messages import read_message
from runtime.store.past_journal import read_journal
from runtime.store.past_run import open_run
from runtime.store.recording import read_recording
from tritrack.exporting import export_run
from tritrack.replay_page import show
from tritrack.replaying import integrated, replay_run

DATA = Path(__file__).parent / "data"
RUN = DATA / "run_0_2"
FRAMES = 18
EMPTY = 3
"""Its first frames show no person."""
JUDGED = {"joints_m", "joints_px", "angles_deg", "angles_raw_deg", "confidence", "score"}
"""Arrays that hold what an integrator finds: a later one may find it nearer to the truth."""


def test_its_settings_are_read_with_a_word_on_each_camera() -> None:
    with pytest.warns(RenamedSetting, match=r"\[cameras\.cam[12]\]") as told:
        settings = load(DATA / "settings_0_2.toml")
    assert len(told) == 2
    assert [*settings.cameras] == ["cam1", "cam2"]
    assert settings.cameras["cam2"].source.endswith("kick_right_forward/cam2.avi")


def test_its_run_is_read_as_one_of_a_person_and_two_cameras() -> None:
    run = open_run(RUN)
    before = np.load(RUN / "poses.npz")
    assert run.poses["person"].tolist() == [0] * FRAMES
    assert run.poses["camera_names"].tolist() == ["cam1", "cam2"]
    assert run.poses["seen"].tolist() == [[False] * 2] * EMPTY + [[True] * 2] * (FRAMES - EMPTY)
    assert run.poses["views"].tolist() == before["views"].tolist()
    assert np.array_equal(run.poses["joints_px"], before["joints_px"][:, :, :15], equal_nan=True)
    assert [*settings_of(run.summary["settings"]).cameras] == ["cam1", "cam2"]


@pytest.mark.parametrize(
    ("word", "seen"),
    [("both", [True, True]), ("1", [True, False]), ("2", [False, True]), ("none", [False, False])],
)
def test_its_word_for_who_sees_the_person_is_told_by_camera(
    tmp_path: Path, word: str, seen: list[bool]
) -> None:
    arrays = dict(np.load(RUN / "poses.npz"))
    arrays["views"] = np.full(FRAMES, word)
    shutil.copy(RUN / "summary.json", tmp_path)
    np.savez(tmp_path / "poses.npz", **arrays)
    assert open_run(tmp_path).poses["seen"].tolist() == [seen] * FRAMES


def test_its_run_is_exported_with_the_cameras_names(tmp_path: Path) -> None:
    export_run(RUN, "csv", tmp_path / "kick.csv")
    with (tmp_path / "kick.csv").open() as file:
        rows = [*csv.DictReader(file)]
    assert [(row["person"], row["seen_cam1"], row["seen_cam2"]) for row in rows[EMPTY - 1 : 4]] == [
        ("0", "0", "0"),
        ("0", "1", "1"),
    ]


def test_its_recording_gives_a_body_of_each_instant_that_it_recorded() -> None:
    pytest.importorskip("mcap", reason="recordings are an extra: install tritrack[mcap]")
    recording = read_recording(RUN)
    assert [len(reports) for reports in recording.reports] == [FRAMES, FRAMES, *[0] * 6]
    done = integrated(recording)
    assert [body.frame for body in done.bodies] == [body.frame for body in recording.bodies]
    assert [body.status for body in done.bodies] == [body.status for body in recording.bodies]


def test_a_recording_of_protocol_10_is_read_as_views_of_people() -> None:
    """`data/protocol_10` is the first sixteen instants of `tritrack synth --size 160x120 --posture
    squat --seed 3`, tracked by the last version of that protocol; nine are of an empty room."""
    pytest.importorskip("mcap", reason="recordings are an extra: install tritrack[mcap]")
    recording = read_recording(DATA / "protocol_10")
    assert [len(views) for views in recording.reports] == [16, 16, *[0] * 6]
    for number, views in enumerate(recording.reports[:2], start=1):
        assert [(view.viewer, view.frame) for view in views] == [(number, n) for n in range(16)]
        assert not any(view.people for view in views[:7])
        for person in (person for view in views[9:] for person in view.people):
            assert np.count_nonzero(unpack(person)) == person.area_px > 100
            assert person.landmarks is not None
            assert len(person.landmarks.joints_px) == len(JOINT_NAMES)
        assert all(len(view.people) == 1 for view in views[9:])
    assert recording.head.rig is not None
    for body in recording.bodies[9:]:
        assert (body.protocol, body.person, body.seen) == (PROTOCOL, 0, (True, True))
        shown = project(recording.head.rig.cameras[1], np.array(body.joints_m))
        assert np.allclose(shown, body.joints_px[1], atol=1e-6)


def test_a_journal_of_protocol_10_is_read() -> None:
    told = read_journal(DATA / "protocol_10")
    assert told is not None
    bodies = [*told.bodies]
    assert [body.frame for body in bodies] == list(range(16))
    assert [bool(body.joints_m) for body in bodies] == [False] * 9 + [True] * 7


def test_what_the_papers_search_found_and_a_stick_body_stand_with_the_person() -> None:
    """A Report of protocol 11, as its fields were called."""
    moment = {"frame": 4, "captured_s": 0.3, "clock_s": 9.3, "protocol": 11, "viewer": 2}
    fit = {
        "joints_px": [[1.0, 2.0]] * 15, "ratios": [1.0] * 10, "breadth": 0.5, "stature_px": 66.0,
        "hidden": [False] * 10, "score": 0.7, "matches": 300,
    }  # fmt: skip
    report = {
        **moment, "width": 8, "height": 2, "silhouette": b"\x02\x02",
        "box": {"left": 1, "right": 1, "top": 0, "bottom": 1},
        "area_px": 2, "blobs": 3, "cut": True, "upper_body_px": 9.0, "vote": "flank",
        "thresholds_px": [1.0, 2.0], "measure": None, "refusal": "why", "root_px": [3.0, 4.0],
        "angles_deg": {"r_hip_x": 5.0}, "squatting": True, "score": 0.8, "matches": 40,
        "fit": fit, "landmarks": None, "next_s": 0.4, "fault": "", "shift": None, "upright": None,
    }  # fmt: skip
    view = read_message(msgspec.msgpack.encode(report), View)
    assert (view.viewer, view.frame, view.blobs, view.next_s) == (2, 4, 3, 0.4)
    (person,) = view.people
    assert (person.area_px, person.cut, person.vote, person.refusal) == (2, True, "flank", "why")
    assert person.search == Search((3.0, 4.0), {"r_hip_x": 5.0}, True, 0.8, 40)
    assert person.stick is not None
    assert (person.stick.score, person.track) == (0.7, 0)
    nobody = {**report, "box": None, "silhouette": bytes(2), "root_px": None}
    assert read_message(msgspec.msgpack.encode(nobody), View).people == ()


def test_a_run_that_is_made_of_its_recording_is_one_of_this_version(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """But for the move from marks to joints' centres, which 0.2 did not know."""
    pytest.importorskip("mcap", reason="recordings are an extra: install tritrack[mcap]")
    monkeypatch.setattr(joint_marks, "centred", lambda _, proposed_m, rays, __: (proposed_m, rays))
    replay_run(RUN, tmp_path / "again")
    with np.load(RUN / "poses.npz") as before, np.load(tmp_path / "again" / "poses.npz") as now:
        assert {*now.files} - {*before.files} == {"person", "camera_names", "seen"}
        differ = {name for name in before.files if before[name].tobytes() != now[name].tobytes()}
        off_mm = 1000.0 * np.linalg.norm(before["joints_m"] - now["joints_m"], axis=2).mean(axis=1)
    assert differ <= JUDGED, "what is told of the instant is the same"
    off_mm = off_mm[np.isfinite(off_mm)]
    assert np.median(off_mm) < 1.0, "the integrator of 0.2, but where it judges otherwise now"
    assert off_mm.max() < 30.0


def test_its_journal_is_read_where_the_run_was_cut_short(tmp_path: Path) -> None:
    """A record of 0.2: the head with its two cameras, and a body without `seen`."""
    told = {"settings": {"clip": "walk", "camera_1": {"device": 3}}, "facts": {}, "protocol": 11}
    body = msgspec.msgpack.decode(
        encode(Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="2"))
    )
    del body["seen"]
    old = framed(b"b", msgspec.msgpack.encode({**body, "protocol": 11}))
    (tmp_path / NAME).write_bytes(framed(HEAD, msgspec.msgpack.encode(told)) + old)
    run = open_run(tmp_path)
    assert run.poses["seen"].tolist() == [[False, True]]
    assert run.summary["settings"]["cameras"]["cam1"]["device"] == 3


def test_a_message_of_another_protocol_is_refused() -> None:
    body = Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")
    for protocol in (9, 13, 99):
        with pytest.raises(MalformedMessage, match=f"protocol {protocol}"):
            read_message(encode(msgspec.structs.replace(body, protocol=protocol)), Body)


def test_the_page_plays_its_recording() -> None:
    pytest.importorskip("mcap", reason="recordings are an extra: install tritrack[mcap]")

    class Page:
        def __init__(self) -> None:
            self.shown = 0

        def set_rig(self, rig: object) -> None:
            assert rig is not None

        def show(self, snapshot: object, event: object) -> None:
            self.shown += 1

    page = Page()
    assert show(page, read_recording(RUN)) == page.shown == FRAMES  # type: ignore[arg-type]


def test_its_run_is_evaluated_against_a_truth(tmp_path: Path) -> None:
    """A truth 100 mm above what it tracked, every fourth frame of the clip."""
    with np.load(RUN / "poses.npz") as poses:
        joints_m = np.full((69, *poses["joints_m"].shape[1:]), np.nan)
        joints_m[::4] = poses["joints_m"] + (0.0, 0.1, 0.0)
        names = poses["joint_names"]
    present = np.isfinite(joints_m).all(axis=(1, 2))
    np.savez(tmp_path / "truth.npz", present=present, joints3d=joints_m, joint_names=names)
    cases, _ = _cases(RUN, tmp_path, None, None)
    case = cases[""]
    assert case.settings.mode == "default"
    assert len(case.compared.frames) == FRAMES - EMPTY
    assert case.compared.off_mm == pytest.approx(100.0)
