"""Clips of rolled cameras: worked on upright, told as they were filmed."""

from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from lying_cameras import filmed_lying

from common.config.settings import Settings
from common.rig.camera import Camera, Rig, as_matrix, as_row, paper_rig, project
from common.rig.rig_file import load_rig
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.upright_views import filed_rig, upright_views
from runtime.offline.lockstep import Decoders, Tracked, track_clip
from runtime.store.pose_arrays import poses


def tracked(clip: Path, views: tuple[Any, ...] = (1, 2), **settings: Any) -> Tracked:
    with Decoders() as decoders:
        return track_clip(Settings(clip=str(clip), size="160x160", **settings), decoders, views)


@pytest.fixture(scope="module")
def standing(clip: Path) -> dict[str, Any]:
    """What is tracked by cameras that stand."""
    return poses(tracked(clip).bodies)


@pytest.mark.slow
@pytest.mark.parametrize("quarters", [(1, 3), (2, 2), (0, 2)], ids=str)
def test_cameras_that_lie_are_tracked_as_those_that_stand(
    clip: Path, standing: dict[str, Any], tmp_path: Path, quarters: tuple[int, int]
) -> None:
    """The pictures are the same, turned: so are the bodies; joints_px are the files'."""
    folder = filmed_lying(clip, tmp_path / clip.name, quarters)
    lies = poses(tracked(folder).bodies)
    assert lies["joints_m"] == pytest.approx(standing["joints_m"], abs=1e-6, nan_ok=True)
    assert lies["score"] == pytest.approx(standing["score"], abs=1e-6)
    rig = load_rig(folder / "calibration.json")
    shown(lies, rig)


def shown(arrays: dict[str, Any], rig: Rig) -> None:
    """The joints in the files' pictures are where the files' calibration has them."""
    posed = np.isfinite(arrays["joints_m"][:, 0, 0])
    for n, camera in enumerate(rig.cameras):
        for where, at in (("joints_m", "joints_px"), ("extremities_m", "extremities_px")):
            wanted = project(camera, arrays[where][posed].reshape(-1, 3))
            assert arrays[at][posed, n].reshape(-1, 2) == pytest.approx(wanted, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["default", "thesis"])
def test_one_camera_that_lies_is_the_same_too(clip: Path, tmp_path: Path, mode: str) -> None:
    folder = filmed_lying(clip, tmp_path / clip.name, (3, 0))
    stands, lies = (poses(tracked(each, (1,), mode=mode).bodies) for each in (clip, folder))
    assert lies["joints_m"] == pytest.approx(stands["joints_m"], abs=1e-6, nan_ok=True)
    rig = load_rig(folder / "calibration.json")
    posed = np.isfinite(lies["joints_m"][:, 0, 0])
    wanted = project(rig.cameras[0], lies["joints_m"][posed].reshape(-1, 3))
    assert lies["joints_px"][posed, 0].reshape(-1, 2) == pytest.approx(wanted, abs=1e-6)


def test_a_clip_of_lying_cameras_has_upright_pictures(clip: Path, tmp_path: Path) -> None:
    """And the calibration of its files is there again."""
    folder = filmed_lying(clip, tmp_path / "clip", (1, 3))
    with Decoder() as decoder:
        opened = open_clip(Settings(clip=str(folder), size="80x80"), decoder)
    told = load_rig(folder / "calibration.json")
    assert [view.size for view in opened.views] == [(80, 60), (80, 60)]
    assert [view.filed_size for view in opened.views] == [(60, 80), (60, 80)]
    assert [view.upright_source for view in opened.views] == [(160, 120), (160, 120)]
    assert [view.quarters for view in opened.views] == [1, 3]
    again = filed_rig(opened)
    assert again is not None
    points = np.random.default_rng(1).uniform(-0.7, 1.2, (20, 3))
    for one, other in zip(again.cameras, told.cameras, strict=True):
        assert project(one, points) == pytest.approx(project(other, points) / 2, abs=1e-6)


def lying_rig() -> tuple[Rig, tuple[ClipView, ClipView]]:
    """Two cameras of 160x120, the first of which is rolled by a quarter turn to the left."""
    rig = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.5))
    one, two = rig.cameras
    turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    rolled = Camera(
        one.name, one.K, as_matrix(turn @ np.array(one.R)), as_row(turn @ np.array(one.t))
    )
    views = (
        ClipView(1, "a.avi", (640, 480), (160, 120), 15.0, 9),
        ClipView(2, "b.avi", (640, 480), (160, 120), 15.0, 9),
    )
    return msgspec.structs.replace(rig, cameras=(rolled, two)), views


def test_of_a_lying_and_a_standing_camera_one_alone_is_turned_and_comes_back() -> None:
    filed, views = lying_rig()
    rig, worked = upright_views(filed, views)
    assert [view.size for view in worked] == [(120, 160), (160, 120)]
    assert [view.quarters % 2 for view in worked] == [1, 0]
    assert worked[1] == views[1]
    assert (rig.width, rig.height) == (120, 160)
    assert rig.cameras[1] == filed.cameras[1]
    foot, crown = project(rig.cameras[0], np.array([[0.0, 0.2, 0.0], [0.0, 1.8, 0.0]]))
    assert crown[0] == pytest.approx(foot[0])
    assert foot[1] - crown[1] == pytest.approx(80.0)
    clip = Clip("walk", worked, 1, rig, Meta())
    again = filed_rig(clip)
    assert again is not None
    assert (again.width, again.height) == (160, 120)
    points = np.random.default_rng(1).uniform(-0.7, 1.2, (20, 3))
    for one, other in zip(again.cameras, filed.cameras, strict=True):
        assert project(one, points) == pytest.approx(project(other, points), abs=1e-6)
    assert filed_rig(msgspec.structs.replace(clip, rig=None)) is None


def test_a_lens_that_cannot_be_turned_is_refused_as_a_clip() -> None:
    filed, views = lying_rig()
    bent = msgspec.structs.replace(filed.cameras[0], distortion=(0.0,) * 12 + (0.01, 0.0))
    rig = msgspec.structs.replace(filed, cameras=(bent, filed.cameras[1]))
    with pytest.raises(ClipError, match="camera cam1 is rolled by more than 45 degrees"):
        upright_views(rig, views)
