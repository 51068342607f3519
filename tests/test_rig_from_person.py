"""Clips that come without a calibration, held against the truth beside them."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from common.config.part_settings import BodySettings
from common.config.settings import Settings
from tritrack.offline.lockstep import Decoders, track_clip
from tritrack.store.pose_arrays import poses

CLIPS = ("r01_t1_03_walk_toward", "r04_t1_05_raise_right_lateral")


@pytest.mark.parametrize("name", CLIPS)
def test_a_clip_without_a_calibration_is_calibrated_by_its_person(
    data_dir: Path, tmp_path: Path, name: str
) -> None:
    """In the world of the truth, unaligned: 40 mm on average (issue's goal for all clips)."""
    folder = tmp_path / name
    shutil.copytree(data_dir / "dev" / name, folder)
    stature_m = json.loads((folder / "meta.json").read_text())["measures"]["stature_m"]
    settings = Settings(clip=str(folder), body=BodySettings(stature_m=stature_m))
    with Decoders() as decoders:
        done = track_clip(settings, decoders)
    assert done.facts["scale_source"] == "person"
    assert done.facts["calibration"]["quality"]["gap_mm"] < 30.0
    found = poses(done.bodies)
    with np.load(folder / "truth.npz") as truth:
        names = truth["joint_names"].tolist()
        real = truth["joints3d"][:, [names.index(n) for n in found["joint_names"].tolist()]]
    off_mm = 1e3 * np.linalg.norm(found["joints_m"] - real, axis=-1)
    assert np.nanmean(off_mm) < 40.0
