"""One camera's outlines made into bodies, the stick body fitted only where it is needed."""

from pathlib import Path

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.config import Mode, Settings
from common.notes.notes import Note, Notes
from common.raster.bounds import box_of, is_cut
from tritrack.single.one_camera_poses import Poses, poses_of
from tritrack.single.single_silhouettes import Outline, outline_of

SIZE = (160, 120)
FEW = 10
"""Matches of a frame whose outline is enough; a stick body takes hundreds."""


@pytest.fixture(scope="module")
def outlines(clip: Path) -> list[Outline]:
    """True silhouettes of somebody who raises an arm."""
    with np.load(clip / "truth.npz") as truth:
        masks = np.unpackbits(truth["mask_cam1"], axis=2)[:, :, : SIZE[0]].astype(np.bool_)
    return [
        outline_of(n, n / 15, mask, is_cut(box_of(mask), mask.shape))
        for n, mask in enumerate(masks)
    ]


def posed(outlines: list[Outline], mode: Mode = "default", notes: Notes = Notes()) -> Poses:
    return poses_of(outlines, SIZE, None, Settings(mode=mode), 1 / 15, notes)


def test_who_is_known_by_the_outline_is_not_fitted(outlines: list[Outline], clip: Path) -> None:
    """Shows 7: the search of the stick body took half of the time. Shows 3 holds all the same."""
    found = posed(outlines)
    seen = [body for body in found.bodies if body.joints_m]
    assert len(seen) == sum(outline.somebody for outline in outlines)
    assert np.mean([body.matches <= FEW for body in seen]) > 0.8
    with np.load(clip / "truth.npz") as truth:
        names = [str(name) for name in truth["joint_names"]]
        at = {name: truth["joints2d_cam1"][:, names.index(name)] for name in JOINT_NAMES}
    for name in ("head_top", "r_wrist", "l_ankle"):
        shown = np.array([body.joints_px[0][JOINT_NAMES.index(name)] for body in seen])
        true = at[name][[body.frame for body in seen]]
        tall = np.ptp([at["head_top"][-1][1], at["l_ankle"][-1][1]])
        assert np.linalg.norm(shown - true, axis=1).mean() < 0.06 * tall


def test_the_thesis_fits_every_frame(outlines: list[Outline]) -> None:
    """T10 to T18: as printed, nothing is proposed."""
    some = outlines[20:23]
    assert min(body.matches for body in posed(some, "thesis").bodies) > 100


def test_who_is_told_to_face_elsewhere_is_fitted(outlines: list[Outline]) -> None:
    """T22: what is proposed faces the camera; the user's word goes before it."""
    some = outlines[20:24]
    notes = Notes(note=(Note(some[2].frame, orientation="left"),))
    found = posed(some, notes=notes)
    assert [body.matches <= FEW for body in found.bodies] == [True, True, False, False]
    assert [own.orientation for own in found.settled[2:]] == ["left", "left"]


def test_who_left_is_met_afresh(outlines: list[Outline]) -> None:
    """P9: a frame without anybody has no pose, and the next one owes it nothing."""
    empty = outline_of(2, 2 / 15, np.zeros((SIZE[1], SIZE[0]), np.bool_), False)
    some = [outlines[20], outlines[21], empty, outlines[20], outlines[21]]
    bodies = posed(some).bodies
    assert [bool(body.joints_m) for body in bodies] == [True, True, False, True, True]
    assert bodies[3].joints_m == bodies[0].joints_m
