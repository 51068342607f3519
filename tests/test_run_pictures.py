"""A run's pictures: those of its own instants, cameras beside each other, late ones set back."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from written_runs import SIZE, body, grey_of, written

from common.body.body import rest_pose
from common.config.settings import Settings
from common.video.decoding import Decoder
from runtime.store.past_run import open_run
from runtime.store.runs import write_run
from tritrack.reporting.run_pictures import NoPictures, clip_of, moments

LATE = 3
"""Frames by which camera 2 is late."""


def greys(folder: Path) -> dict[int, tuple[int, int]]:
    """The grey of both tiles by row, read in their corners, where nothing is drawn."""
    run = open_run(folder)
    with Decoder() as decoder:
        clip = clip_of(run, decoder)
    found = {}
    for moment in moments(run, clip):
        below = moment.picture[SIZE[1] - 8 : SIZE[1] - 2].mean(axis=(0, 2))
        tiles = below[4:12].mean(), below[SIZE[0] + 4 : SIZE[0] + 12].mean()
        found[moment.rows[0]] = (round(tiles[0]), round(tiles[1]))
    return found


@pytest.mark.parametrize("late", [0, LATE])
def test_each_row_has_the_pictures_of_its_instant(tmp_path: Path, late: int) -> None:
    """Where view 2 is late by three frames, row 2 has picture 5 of it."""
    bodies = [body(n, rest_pose()) for n in range(2, 6)]
    found = greys(written(tmp_path, bodies, late_s=late / 10.0))
    assert [*found] == [0, 1, 2, 3]
    for row, tiles in found.items():
        frame = row + 2
        assert tiles == pytest.approx((grey_of(1, frame), grey_of(2, frame + late)), abs=3)


def test_the_body_is_drawn_where_its_pixels_are(tmp_path: Path) -> None:
    run = open_run(written(tmp_path, [body(0, rest_pose()), body(1, None, "lost")]))
    with Decoder() as decoder:
        clip = clip_of(run, decoder)
    posed, lost = (moment.picture for moment in moments(run, clip))
    for beside in (0, SIZE[0]):
        line = (slice(58, 63), slice(40 + beside, 56 + beside))
        assert np.ptp(posed[line]) > 60
        assert np.ptp(lost[line]) < 10


def test_videos_that_are_gone_are_named(tmp_path: Path) -> None:
    folder = written(tmp_path, [body(0, rest_pose())])
    (tmp_path / "clip" / "cam2.avi").unlink()
    with Decoder() as decoder, pytest.raises(NoPictures, match=r"cam2\.avi"):
        clip_of(open_run(folder), decoder)


def test_a_run_is_of_its_own_videos_whatever_the_present_folder_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its clip was named by a relative path, by which another folder has another clip."""
    made, elsewhere = tmp_path / "made", tmp_path / "elsewhere"
    made.mkdir()
    (elsewhere / "clip").mkdir(parents=True)
    folder = written(made, [body(0, rest_pose())])
    monkeypatch.chdir(made)
    write_run(folder, [body(0, rest_pose())], Settings(clip="clip"), {})
    monkeypatch.chdir(elsewhere)
    for camera in ("cam1.avi", "cam2.avi"):
        shutil.copy(made / "clip" / camera, elsewhere / "clip" / camera)
    with Decoder() as decoder:
        clip = clip_of(open_run(folder), decoder)
    assert [view.source for view in clip.views] == [
        str(made / "clip" / camera) for camera in ("cam1.avi", "cam2.avi")
    ]


@pytest.mark.parametrize("kept", [True, False])
def test_a_live_run_says_where_what_its_cameras_showed_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kept: bool
) -> None:
    folder = written(tmp_path, [body(0, rest_pose())])
    monkeypatch.setattr("tritrack.reporting.run_pictures.is_recorded", lambda _: False)
    if kept:
        (folder / "pictures").mkdir()
    says = rf"tritrack track .*{folder.name}/pictures$" if kept else "of cameras, which keep none"
    with Decoder() as decoder, pytest.raises(NoPictures, match=says):
        clip_of(open_run(folder), decoder)
