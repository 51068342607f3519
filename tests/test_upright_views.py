"""Clips of rolled cameras: worked on upright, told as they were filmed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lying_cameras import filmed_lying

from common.config.settings import Settings
from common.rig.camera import Rig, project
from common.rig.rig_file import load_rig
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.upright_views import filed_rig
from tritrack.offline.lockstep import Decoders, Tracked, track_clip
from tritrack.store.pose_arrays import poses


def tracked(clip: Path, views: tuple[Any, ...] = (1, 2), **settings: Any) -> Tracked:
    with Decoders() as decoders:
        return track_clip(Settings(clip=str(clip), size="160x160", **settings), decoders, views)


@pytest.mark.parametrize(
    "quarters",
    [(1, 3), *(pytest.param(q, marks=pytest.mark.slow) for q in ((1, 1), (2, 2), (0, 2)))],
    ids=str,
)
def test_cameras_that_lie_are_tracked_as_those_that_stand(
    clip: Path, tmp_path: Path, quarters: tuple[int, int]
) -> None:
    """The pictures are the same, turned: so are the bodies; joints_px are the files'."""
    folder = filmed_lying(clip, tmp_path / clip.name, quarters)
    stands, lies = (poses(tracked(each).bodies) for each in (clip, folder))
    assert lies["joints_m"] == pytest.approx(stands["joints_m"], abs=1e-6, nan_ok=True)
    assert lies["score"] == pytest.approx(stands["score"], abs=1e-6)
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
