"""Made-up clips, as the command makes them."""

import json
import os
from pathlib import Path

import pytest
from rich.console import Console

from common.config.part_settings import SettingsError
from synth.scene.scene_clips import SceneSet
from synth.write import ClipSet, SynthError
from tritrack.making import make_clips

QUIET = Console(quiet=True)


def made(out: Path, **changes: object) -> list[Path]:
    asked = {
        "motion": "postures",
        "performers": 1,
        "takes": 1,
        "seed": 3,
        "size": "64x48",
        "postures": ("squat",),
    }
    wanted = {**asked, **changes}
    size = str(wanted.pop("size"))
    return make_clips(out, ClipSet(**wanted), size, QUIET)  # type: ignore[arg-type]


def test_clips_are_named_after_performer_take_and_posture(tmp_path: Path) -> None:
    folders = made(tmp_path, takes=2)
    assert [folder.name for folder in folders] == ["s03_t1_12_squat", "s03_t2_12_squat"]
    meta = json.loads((folders[1] / "meta.json").read_text())
    assert (meta["posture"], meta["take"], meta["performer"]) == ("squat", 2, "s03")
    assert (tmp_path / "calibration.json").is_file()


@pytest.mark.slow
def test_free_motion_is_of_no_posture(tmp_path: Path) -> None:
    """posture_id -1 tells a live run not to ask a model for it."""
    (folder,) = made(tmp_path, motion="free", postures=())
    assert json.loads((folder / "meta.json").read_text())["posture_id"] == -1


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"size": "64"}, "size must look like 160x120, got '64'"),
        ({"size": "9999x9999"}, "from 32x32 to 4096x4096 pixels, got 9999x9999"),
        ({"postures": ("squat", "dance")}, "unknown posture 'dance'; known are walk_in_place"),
        ({"motion": "free"}, "no posture belongs to this motion: leave --posture or --motion free"),
    ],
    ids=["half a size", "huge", "unknown posture", "a free posture"],
)
def test_silly_values_are_refused_before_anything_is_written(
    tmp_path: Path, changes: dict[str, object], error: str
) -> None:
    with pytest.raises(SettingsError, match=error):
        made(tmp_path / "out", **changes)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("posture", "error"),
    [("dance", "unknown posture 'dance'"), ("walk_toward", "walk_toward leads away, and people")],
)
def test_people_of_a_scene_perform_known_postures_at_their_place(
    tmp_path: Path, posture: str, error: str
) -> None:
    with pytest.raises(SettingsError, match=error):
        make_clips(tmp_path / "out", SceneSet(2, postures=("squat", posture)), "64x48", QUIET)
    assert not (tmp_path / "out").exists()


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(SynthError, match=r"cannot write .*file: .*name another --out"):
        made(tmp_path / "file")
    assert os.listdir(tmp_path) == ["file"]


def test_the_calibration_of_other_cameras_is_never_lost(tmp_path: Path) -> None:
    """Clips of the same cameras may be added; the calibration serves those that are there."""
    made(tmp_path)
    made(tmp_path, seed=4)
    before = (tmp_path / "calibration.json").read_bytes()
    with pytest.raises(SynthError, match=r"calibration\.json is of other cameras"):
        made(tmp_path, seed=5, size="128x96")
    assert (tmp_path / "calibration.json").read_bytes() == before
    assert not (tmp_path / "s05_t1_12_squat").exists()
