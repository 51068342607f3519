"""Videos of one camera followed to their animations, and what is refused (T1, T2)."""

import json
import re
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from rich.console import Console
from spoiling import film_of, write_uneven, write_video

from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.notes.notes import Note, Notes
from common.notes.notes_file import save_notes
from common.rig.camera import Camera, project
from runtime.faults import Unfollowed, refuse_unfollowed
from runtime.offline.batch import Asked, track_all
from runtime.store.clip_paths import ClipsFailed
from tritrack.single import single
from tritrack.single.single import (
    UNUSABLE,
    Given,
    Job,
    job_of,
    line_of,
    mean_confidence,
    name_of,
    single_all,
)

QUIET = Console(quiet=True)
SMALL = Settings(size="160x120")


@pytest.fixture(scope="module")
def video(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Part of a clip under a name of its own, without a calibration beside it."""
    path = tmp_path_factory.mktemp("videos") / "waving.avi"
    write_video(path, film_of(next(clip.glob("cam1.*")))[:40])
    return path


@pytest.fixture(scope="module")
def run(video: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("runs")
    single_all([video], out, Given(), SMALL, QUIET)
    return out / "waving"


@pytest.mark.slow
def test_a_run_has_all_that_the_thesis_shows(run: Path) -> None:
    """T1: background, silhouettes, poses, key frames, animation."""
    assert {path.name for path in run.iterdir()} == {
        *("poses.npz", "summary.json", "background.png", "overlay.mp4", "angles.png"),
        *("body.bvh", "keyframes.bvh", "keyframes.json"),
    }
    summary = json.loads((run / "summary.json").read_text())
    assert summary["scale_source"] == "assumed"
    assert summary["effort"]["inputs"]["all"] == 0
    film = cv2.VideoCapture(str(run / "overlay.mp4"))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == summary["frames"] == 40
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(15.0)


def test_poses_follow_the_person_in_the_picture(run: Path, clip: Path) -> None:
    """Shows 3: in the picture within 6 % of the body's height."""
    with np.load(run / "poses.npz") as poses, np.load(clip / "truth.npz") as truth:
        names = [str(name) for name in truth["joint_names"]]
        joints = [str(name) for name in poses["joint_names"]]
        both = [name for name in joints if name[1] == "_" and name in names]
        seen = poses["joints_px"][:, 0][:, [joints.index(name) for name in both]]
        true = truth["joints2d_cam1"][:40][:, [names.index(name) for name in both]]
        tall = np.ptp(true[..., 1], axis=1)[:, None]
        off = np.linalg.norm(seen - true, axis=2) / tall
        assert poses["orientation"].shape == (40,)
    assert np.nanmean(off) < 0.06


def test_the_camera_that_was_assumed_is_told_and_shows_the_joints_where_they_are(run: Path) -> None:
    """T19: what is lifted is shown where it was seen."""
    summary = json.loads((run / "summary.json").read_text())
    camera = msgspec.convert(summary["camera"], Camera)
    with np.load(run / "poses.npz") as poses:
        joints_m, joints_px = poses["joints_m"], poses["joints_px"][:, 0]
    seen = np.isfinite(joints_m[:, 0, 0])
    shown = project(camera, joints_m[seen, :15].reshape(-1, 3)).reshape(-1, 15, 2)
    assert np.abs(shown - joints_px[seen, :15]).max() < 0.01


@pytest.mark.slow
def test_one_view_of_a_clip_is_tracked_by_the_same_code(
    run: Path, video: Path, tmp_path: Path
) -> None:
    (tmp_path / "clip").mkdir()
    (tmp_path / "clip" / "cam1.avi").write_bytes(video.read_bytes())
    track_all([tmp_path / "clip"], tmp_path / "runs", Asked(size="160x120", views=(1,)), QUIET)
    with np.load(run / "poses.npz") as one, np.load(tmp_path / "runs/clip/poses.npz") as other:
        assert one.files == other.files
        assert all(np.array_equal(one[n], other[n], equal_nan=n[0] in "jac") for n in one.files[:1])
        assert np.array_equal(one["joints_m"], other["joints_m"], equal_nan=True)


@pytest.mark.slow
def test_the_notes_beside_a_video_are_obeyed(video: Path, tmp_path: Path) -> None:
    """T22, T26: who is told to face away does so from that frame on."""
    path = tmp_path / "waving.avi"
    path.write_bytes(video.read_bytes())
    save_notes(tmp_path / "notes.toml", Notes(note=(Note(20, orientation="backward_left"),)))
    facts = single_all([path], tmp_path / "runs", Given(), SMALL, QUIET)
    with np.load(tmp_path / "runs/waving/poses.npz") as poses:
        assert set(poses["orientation"][20:]) == {"backward_left"}
        assert "backward_left" not in poses["orientation"][:20]
    assert facts["clips"]["waving"]["effort"]["inputs"]["orientation"] == 1


@pytest.mark.slow
def test_a_film_whose_rate_varies_is_told_in_true_time(video: Path, tmp_path: Path) -> None:
    """Each third frame is missing: poses keep their moments, the overlay its length."""
    ticks = [n for n in range(40) if n % 3]
    pictures = [picture for n, picture in enumerate(film_of(video)) if n % 3]
    write_uneven(tmp_path / "waving.mp4", pictures, ticks, 15)
    single_all([tmp_path / "waving.mp4"], tmp_path / "runs", Given(), SMALL, QUIET)
    with np.load(tmp_path / "runs" / "waving" / "poses.npz") as poses:
        assert poses["time_s"] == pytest.approx((np.array(ticks) - ticks[0]) / 15, abs=1e-4)
    film = cv2.VideoCapture(str(tmp_path / "runs" / "waving" / "overlay.mp4"))
    lasts_s = film.get(cv2.CAP_PROP_FRAME_COUNT) / film.get(cv2.CAP_PROP_FPS)
    assert lasts_s == pytest.approx((ticks[-1] - ticks[0] + 1) / 15, abs=0.1)


@pytest.mark.slow
def test_an_empty_picture_is_the_background_where_it_is_given(video: Path, tmp_path: Path) -> None:
    """Of somebody who never leaves a film alone does not tell what is behind."""
    pictures = film_of(video)
    cv2.imwrite(str(tmp_path / "empty room.png"), pictures[0])
    write_video(tmp_path / "waving.avi", pictures[9:])
    given = Given(background=tmp_path / "empty room.png")
    facts = single_all([tmp_path / "waving.avi"], tmp_path / "runs", given, SMALL, QUIET)
    assert facts["clips"]["waving"]["never_uncovered"] == 0.0
    assert facts["clips"]["waving"]["warnings"] == []
    found = np.array(cv2.imread(str(tmp_path / "runs" / "waving" / "background.png")), int)
    assert np.abs(found - pictures[0]).max() <= 1


@pytest.mark.slow
def test_the_last_line_tells_what_was_followed_how_well_and_what_to_open(
    video: Path, tmp_path: Path
) -> None:
    facts = single_all([video], tmp_path, Given(), SMALL, QUIET)["clips"]["waving"]
    line = line_of("waving", facts)
    assert re.fullmatch(
        r"waving: a pose in 31 of 40 frames \(7\d%\), believed in \d+%, "
        r"mean confidence 0\.\d\d; open "
        rf"{tmp_path}/waving/overlay\.mp4 \((H\.264|MPEG-4)\)",
        line,
    )
    assert ", believed in 60%, mean" in line_of("waving", {**facts, "believed": 0.6})


@pytest.mark.slow
def test_of_a_clip_of_two_cameras_is_said_which_one_is_followed(
    clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    single_all([clip], tmp_path, Given(), SMALL, Console(stderr=True, width=999))
    told, *_ = capsys.readouterr().err.splitlines()
    assert told == f"{clip}: camera 1 alone is followed; all of them: tritrack track {clip}"


def refusal(path: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Of the only video, in one line; nothing is written."""
    with pytest.raises(UNUSABLE) as caught:
        single_all([path], out, Given(), SMALL, Console(stderr=True))
    assert not (out / name_of(path)).exists()
    assert capsys.readouterr().err == ""
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.slow
def test_of_several_videos_the_good_ones_are_followed_and_said(
    video: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also under a name with spaces; one name is given to one run."""
    (tmp_path / "my films").mkdir()
    first, twin = tmp_path / "my films" / "a wave.avi", tmp_path / "a wave.avi"
    first.write_bytes(video.read_bytes())
    twin.write_bytes(video.read_bytes())
    videos = [tmp_path / "missing.avi", first, twin]
    with pytest.raises(ClipsFailed, match="2 of 3 videos could not be followed"):
        single_all(videos, tmp_path / "my runs", Given(), SMALL, Console(stderr=True, width=999))
    said = capsys.readouterr().err.splitlines()
    assert [line.split(":")[0] for line in said] == ["error", "a wave", "error"]
    assert "a wave.avi would be written to" in said[2]
    assert (tmp_path / "my runs" / "a wave" / "overlay.mp4").is_file()


@pytest.mark.slow
def test_a_camera_that_moves_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """T2: a static background."""
    scene = np.random.default_rng(5).integers(0, 255, (30, 120, 3), np.uint8)
    scene = cv2.resize(scene, (960, 120), interpolation=cv2.INTER_NEAREST)
    write_video(tmp_path / "pan.avi", [scene[:, 20 * n : 20 * n + 160] for n in range(40)])
    assert "its camera moves" in refusal(tmp_path / "pan.avi", tmp_path / "runs", capsys)


def test_what_is_no_video_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty.avi").touch()
    (tmp_path / "text.avi").write_text("no film" * 99)
    for name, reason in (
        ("missing.avi", "there is no file"),
        ("empty.avi", "is empty"),
        ("text.avi", "text.avi"),
        ("missing.npz#walk", "cannot read the masks"),
    ):
        assert reason in refusal(tmp_path / name, tmp_path / "runs", capsys)


@pytest.mark.filterwarnings("error")
def test_a_speck_among_silhouettes_is_nobody(tmp_path: Path) -> None:
    masks = np.zeros((24, 120, 160), np.bool_)
    masks[:, 20:110, 70:90] = True
    masks[3] = False
    masks[3, 50, 50] = True
    np.savez(tmp_path / "speck.npz", masks=masks)
    single_all([tmp_path / "speck.npz"], tmp_path / "runs", Given(), SMALL, QUIET)
    with np.load(tmp_path / "runs" / "speck" / "poses.npz") as poses:
        assert (poses["status"] == "empty").tolist() == [row == 3 for row in range(24)]


@pytest.mark.filterwarnings("error")
def test_where_nobody_is_seen_that_is_said(tmp_path: Path) -> None:
    """It is not followed, as `faults` tells, but what the video shows is written all the same."""
    np.savez(tmp_path / "empty.npz", masks=np.zeros((3, 120, 160), np.bool_))
    done = single_all([tmp_path / "empty.npz"], tmp_path / "runs", Given(), SMALL, QUIET)
    with pytest.raises(Unfollowed, match=r"empty: nobody was found"):
        refuse_unfollowed(done["clips"])
    written = tmp_path / "runs" / "empty"
    facts = json.loads((written / "summary.json").read_text())
    assert "nobody was seen" in facts["warnings"][0]
    assert (facts["frames"], facts["frames_with_pose"]) == (3, 0)
    assert (written / "overlay.mp4").is_file()


def test_no_animation_outlives_the_run_it_is_of(tmp_path: Path) -> None:
    """A film that was made again shows nobody: there is no body of the one before."""
    masks = np.zeros((6, 120, 160), np.bool_)
    masks[:, 20:110, 70:90] = True
    for shown in (masks, np.zeros_like(masks)):
        np.savez(tmp_path / "film.npz", masks=shown)
        single_all([tmp_path / "film.npz"], tmp_path / "runs", Given(), SMALL, QUIET)
    assert {path.name for path in (tmp_path / "runs" / "film").iterdir()} == {
        *("poses.npz", "summary.json", "overlay.mp4", "angles.png"),
    }


@pytest.mark.slow
def test_the_effort_is_told_as_the_camera_sees_it(video: Path, clip: Path, tmp_path: Path) -> None:
    """What leans towards a camera does so whichever way the world's axes lie."""
    rig = json.loads((clip.parent / "calibration.json").read_text())
    efforts = []
    for way, turn in (("as it was", np.eye(3)), ("turned", [[0, 0, 1], [0, 1, 0], [-1, 0, 0]])):
        room = tmp_path / way
        room.mkdir()
        (room / "cam1.avi").write_bytes(video.read_bytes())
        camera = rig["cameras"][0] | {"R": (np.array(rig["cameras"][0]["R"]) @ turn).tolist()}
        (room / "calibration.json").write_text(json.dumps(rig | {"cameras": [camera]}))
        facts = single_all([room], tmp_path / "runs", Given(), SMALL, QUIET)["clips"][way]
        assert facts["scale_source"] == "calibrated"
        efforts.append(facts["effort"])
    assert efforts[0] == efforts[1]


def test_a_background_and_notes_that_are_named_take_the_place_of_those_beside(
    tmp_path: Path,
) -> None:
    path, other = tmp_path / "dance.avi", tmp_path / "mine.toml"
    path.write_bytes(b"")
    beside, mine = Notes(note=(Note(1, "left"),)), Notes(note=(Note(2, "right"),))
    assert job_of(path, Given(), SMALL).notes == Notes()
    save_notes(tmp_path / "notes.toml", beside)
    save_notes(other, mine)
    job = job_of(path, Given(), SMALL)
    assert (job.notes, job.path, job.masks) == (beside, path, None)
    assert job.settings.cameras["cam1"] == CameraSettings(source=str(path))
    assert job.settings.size == "160x120"
    given = Given(notes=other, background=tmp_path / "room.png", landmarks="none")
    job = job_of(path, given, SMALL)
    assert job.notes == mine
    assert job.settings.landmarks == "none"
    assert job.settings.cameras["cam1"] == CameraSettings(str(path), -1, str(tmp_path / "room.png"))


def test_a_clip_folder_has_the_notes_of_its_first_camera_and_may_have_no_camera_settings(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "clip"
    folder.mkdir()
    (folder / "cam1.avi").write_bytes(b"")
    save_notes(folder / "notes.toml", Notes(note=(Note(3, "left"),)))
    job = job_of(folder, Given(background=Path("room.png")), SMALL)
    assert job.notes.note[0].frame == 3
    assert job.settings.cameras["cam1"] == CameraSettings(background="room.png")
    assert job.settings.clip == str(folder)


def test_masks_have_no_notes_but_those_that_are_named(tmp_path: Path) -> None:
    slow, fast = np.ones((2, 8, 9), np.bool_), np.ones((3, 8, 9), np.bool_)
    np.savez(tmp_path / "walks.npz", slow=slow, fast=fast)
    save_notes(tmp_path / "notes.toml", Notes(note=(Note(1, "left"),)))
    path = Path(f"{tmp_path / 'walks.npz'}#fast")
    job = job_of(path, Given(), SMALL)
    assert job.masks is not None
    assert (job.notes, len(job.masks.reports), job.settings) == (Notes(), 3, SMALL)
    named = job_of(path, Given(notes=tmp_path / "notes.toml"), SMALL)
    assert named.notes.note[0].frame == 1
    assert [name_of(each) for each in (path, tmp_path / "walks.npz")] == ["fast", "walks"]


def test_confidence_is_the_mean_over_frames_that_have_a_pose() -> None:
    joints_m = np.zeros((3, 15, 3))
    joints_m[1, 4, 2] = np.nan
    confidence = np.repeat([[0.5], [0.9], [0.75]], 15, axis=1)
    assert mean_confidence({"joints_m": joints_m, "confidence": confidence}) == 0.625
    assert mean_confidence({"joints_m": joints_m[1:2], "confidence": confidence[1:2]}) == 0.0


def test_the_line_says_what_share_has_a_pose_even_of_no_frames() -> None:
    facts = {"frames": 0, "frames_with_pose": 0, "confidence": 0.0}
    facts |= {"overlay": "o.mp4", "overlay_codec": "H.264"}  # type: ignore[dict-item]
    assert line_of("a", facts) == (
        "a: a pose in 0 of 0 frames (0%), mean confidence 0.00; open o.mp4 (H.264)"
    )
    more = facts | {"frames": 8, "frames_with_pose": 6, "believed": 0.25, "confidence": 0.876}
    assert line_of("a", more) == (
        "a: a pose in 6 of 8 frames (75%), believed in 25%, mean confidence 0.88; "
        "open o.mp4 (H.264)"
    )
    assert line_of("a", facts | {"overlay_codec": "MPEG-4"}).endswith(
        "open o.mp4 (MPEG-4: pip install 'tritrack[video]' for browsers)"
    )


def test_two_videos_of_one_name_are_not_written_over_each_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of three the second is left out and the third followed."""
    console = Console(width=400, stderr=True)
    followed: list[str] = []

    def kept(job: Job, wanted: Any, *_: Any) -> Any:
        followed.append(str(job.path))
        assert wanted.folder == tmp_path / "out" / name_of(job.path)
        return {"frames": 2, "frames_with_pose": 1, "confidence": 0.5} | dict.fromkeys(
            ("overlay", "overlay_codec"), "x"
        )

    paths = [tmp_path / "a" / "one.avi", tmp_path / "b" / "one.avi", tmp_path / "c" / "two.avi"]
    for path in paths:
        path.parent.mkdir()
        path.write_bytes(b"")
    monkeypatch.setattr(single, "_kept", kept)
    with pytest.raises(ClipsFailed, match="1 of 3 videos could not be followed"):
        single_all(paths, tmp_path / "out", Given(), SMALL, console)
    assert followed == [str(paths[0]), str(paths[2])]
    said = capsys.readouterr().err
    assert f"{paths[1]} would be written to {tmp_path / 'out' / 'one'} too: rename it" in said
    assert "one: a pose in 1 of 2 frames (50%)" in said
