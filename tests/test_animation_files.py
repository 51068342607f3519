"""What is written beside a followed film: none of an earlier run, frames that key frames name."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from common.body.body import ANGLE_NAMES, JOINT_NAMES, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from runtime.store.runs import RunError
from tritrack.single import animation_files
from tritrack.single.animation_files import FLAG, NAMES, marked, write_files
from viewer.background.background import learn

FRAMES = 14


def run(lost: int = 3) -> dict[str, Any]:
    """Somebody who sinks evenly; clearest in the frames 5 and 11; one frame without a pose."""
    body, pose = body_vector(thesis_bdp(1.7)), rest_pose()
    joints_m = np.empty((FRAMES, len(JOINT_NAMES), 3))
    for n in range(FRAMES):
        moved = pose.copy()
        moved[1] -= 0.01 * n
        joints_m[n] = joints(body, moved)
    joints_m[lost] = np.nan
    confidence = np.full((FRAMES, len(JOINT_NAMES)), 0.5)
    confidence[[5, 11]] = 0.9
    return {
        "frame": np.arange(100, 100 + FRAMES),
        "time_s": np.arange(FRAMES) / 15,
        "joints_m": joints_m,
        "confidence": confidence,
        "angles_deg": np.zeros((FRAMES, len(ANGLE_NAMES))),
        "angle_names": np.array(ANGLE_NAMES),
    }


@pytest.fixture(autouse=True)
def plotless(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(animation_files, "angle_plot", lambda _: b"plot")


def test_key_frames_are_told_by_the_frames_of_the_film_and_how_far_they_are_off(
    tmp_path: Path,
) -> None:
    """Sinking evenly is the same between key frames as in them."""
    assert write_files(tmp_path, run(), None) == []
    told = json.loads((tmp_path / "keyframes.json").read_text())
    assert {100, 105, 111, 112, 113} <= {*told["frames"]}, "the clearest of six, and the ends"
    assert (told["of"], told["interpolated"]) == (FRAMES, FRAMES - len(told["frames"]))
    off_mm = told["off_body_bvh_mm"]
    assert off_mm["median"] <= off_mm["p95"] <= off_mm["most"] <= 10.0
    for name in ("body.bvh", "keyframes.bvh"):
        assert f"Frames: {FRAMES}" in (tmp_path / name).read_text()
        assert "Frame Time: 0.0666" in (tmp_path / name).read_text()
    assert (tmp_path / "body.bvh").read_text() != (tmp_path / "keyframes.bvh").read_text()
    assert (tmp_path / "angles.png").read_bytes() == b"plot"
    assert not (tmp_path / "background.png").exists()


def test_nothing_of_an_earlier_run_is_left_where_there_is_no_animation(tmp_path: Path) -> None:
    for name in NAMES:
        (tmp_path / name).write_text("old")
    arrays = run()
    arrays["joints_m"][:] = np.nan
    (told,) = write_files(tmp_path, arrays, None)
    assert told.startswith("there is no animation: ")
    assert [path.name for path in tmp_path.iterdir()] == ["angles.png"]
    with pytest.raises(RunError, match="nowhere"):
        write_files(tmp_path / "nowhere", arrays, None)


def test_what_was_never_uncovered_is_hatched_in_red(tmp_path: Path) -> None:
    picture = np.full((8, 8, 3), (30, 60, 90), np.uint8)
    background = learn([picture] * 4)
    background = background._replace(uncertain=np.zeros((8, 8), np.bool_))
    assert (marked(background) == picture).all()
    background.uncertain[:4] = True
    shown = marked(background)
    red = (shown == FLAG).all(axis=2)
    assert not red[4:].any()
    assert red[:4].sum() == 16
    assert red[0].tolist() == [True, True, False, False] * 2
    assert red[1].tolist() == [True, False, False, True] * 2
    write_files(tmp_path, run(), background)
    assert (tmp_path / "background.png").read_bytes().startswith(b"\x89PNG")
