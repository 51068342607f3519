"""Two outlines of one piece of space: what one view alone shows is no part of the person."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from posing import posed
from rolling import ROLLED, on_one_leg, outlines, person_in

from common.raster.kernel import view_of
from common.raster.silhouette_report import unpack
from common.raster.similarity import Mask
from common.rig.camera import centre, project
from integrator.fit import visual_hull

REHEARSED = """
from common.config.settings import Settings
from common.raster.kernel import match
from integrator.fit import visual_hull
from integrator.integrator_warmup import warm_up
warm_up(Settings(), (160, 120))
from rolling import BODY, ROLLED, on_one_leg, outlines, person_in
from common.body.proportions import body_vector
from integrator.fit.silhouette_pair import poorest
known = len(match.signatures)
seen = tuple(person_in(mask) for mask in outlines(on_one_leg()))
poorest(on_one_leg(), body_vector(BODY), ROLLED, seen)
print(len(visual_hull._carve.signatures), len(match.signatures) - known)
"""


def share(part: Mask, whole: Mask) -> float:
    return float((part & whole).sum() / whole.sum())


def kept(first: Mask, second: Mask) -> tuple[Mask, Mask]:
    found = visual_hull.one_piece(ROLLED, (first, second))
    assert found is not None
    return found


def test_a_person_alone_is_kept_and_reported_as_before() -> None:
    for pose in (on_one_leg(), on_one_leg(20.0)):
        first, second = outlines(pose)
        for before, after in zip((first, second), kept(first, second), strict=True):
            assert share(after, before) > 0.97
        pair = (person_in(first), person_in(second))
        assert visual_hull.cleaned(ROLLED, pair) == (pair, False)


def test_what_one_view_alone_shows_goes_and_the_border_is_free_again() -> None:
    """Glare on the floor, as large as a trunk, to the border of the picture."""
    first, second = outlines(on_one_leg())
    glare = np.zeros_like(first)
    glare[200:240, 0:40] = True
    spoilt = first | glare
    found = visual_hull.cleaned(ROLLED, (person_in(spoilt), person_in(second)))
    assert found.clutter
    report = found.seen[0]
    assert report is not None
    assert person_in(spoilt).cut
    assert not report.cut
    assert share(unpack(report), first) > 0.98
    assert share(unpack(report), glare & ~first) < 0.02
    assert report.area_px == unpack(report).sum()


def test_of_two_pieces_the_taller_is_the_person() -> None:
    """A box on the floor that both views show, a metre away and more."""
    first, second = outlines(on_one_leg())
    side = np.linspace(-0.2, 0.2, 40)
    box_m = np.stack(np.meshgrid(1.0 + side, 0.2 + side, 1.0 + side), axis=-1).reshape(-1, 3)
    spoilt = []
    for mask, camera in zip((first, second), ROLLED.cameras, strict=True):
        columns, rows = np.floor(project(camera, box_m)).astype(int).T
        inside = (columns >= 0) & (rows >= 0) & (columns < 160) & (rows < 240)
        both = mask.copy()
        both[rows[inside], columns[inside]] = True
        assert both.sum() > 1.1 * mask.sum()
        spoilt.append(both)
    for mask, found in zip((first, second), kept(spoilt[0], spoilt[1]), strict=True):
        assert share(found, mask) > 0.97
        assert found.sum() < 1.03 * mask.sum()


def test_an_arm_that_leaves_one_picture_stays_in_the_other() -> None:
    """What the other view has outside its picture is not contradicted by it."""
    pose = posed(r_shoulder_z=90.0, l_shoulder_z=270.0)
    pose[1] = 0.95
    first, second = outlines(pose)
    reach = np.flatnonzero(first.any(axis=0))
    narrow = first[:, : reach[-1] - 14]
    assert narrow.sum() < 0.98 * first.sum()
    found = visual_hull.one_piece(ROLLED, (narrow, second))
    assert found is not None
    assert share(found[1], second) > 0.97


def test_outlines_without_a_common_place_are_left_alone() -> None:
    first, second = outlines(on_one_leg())
    corner = np.zeros_like(second)
    corner[:10, :10] = True
    pair = (person_in(first), person_in(corner))
    assert visual_hull.cleaned(ROLLED, pair) == (pair, False)
    alone = (person_in(first), None)
    assert visual_hull.cleaned(ROLLED, alone) == (alone, False)


def test_the_largest_piece_is_by_volume_times_height_and_reaches_ten_cells_into_one_view() -> None:
    """A plate of 25 cells against a column of 7: 25 x 1 against 7 x 7; corners do not touch."""
    full = np.full((30, 12, 30), -1, np.int8)
    full[0:5, 0, 0:5] = 2
    full[5, 1:8, 5] = 2
    full[6:30, 4, 5] = 1
    full[0:5, 5, 5] = 1
    found = {tuple(cell) for cell in visual_hull._largest(full).tolist()}
    column = {(5, up, 5) for up in range(1, 8)}
    assert found == column | {(x, 4, 5) for x in range(6, 16)} | {(x, 5, 5) for x in range(5)}
    assert not len(visual_hull._largest(np.ones((2, 2, 2), np.int8)))
    assert len(visual_hull._largest(np.full((2, 2, 2), 2, np.int8))) == 8


@pytest.mark.slow
def test_a_rehearsal_compiles_what_a_doubtful_pose_needs() -> None:
    """In a process of its own: nothing is left to compile in the middle of a live run."""
    rehearsal = subprocess.run(
        [sys.executable, "-c", REHEARSED],
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
        cwd=Path(__file__).parent,
    )
    assert rehearsal.stdout.split() == ["1", "0"]


def test_a_cell_counts_the_views_that_show_it_covered() -> None:
    """-1 where a view shows the room there; what is outside a picture or behind is not judged."""
    masks = outlines(on_one_leg())
    corner_m = np.array([-0.6, 0.05, -0.6])
    full = np.zeros((24, 40, 24), np.int8)
    full[3, 4, 5] = -1
    due = full.copy()
    places_m = corner_m + (np.moveaxis(np.indices(full.shape), 0, -1) + 0.5) * visual_hull.CELL_M
    for mask, camera in zip(masks, ROLLED.cameras, strict=True):
        u, v = project(camera, places_m.reshape(-1, 3)).T.reshape(2, *full.shape)
        inside = (u >= 0) & (v >= 0) & (u < mask.shape[1]) & (v < mask.shape[0])
        shown = np.zeros(full.shape, np.bool_)
        shown[inside] = mask[v[inside].astype(int), u[inside].astype(int)]
        due[inside & shown & (due >= 0)] += 1
        due[inside & ~shown & (due >= 0)] = -1
        visual_hull._carve(full, corner_m, view_of(camera), mask)
        assert np.array_equal(full, due)
    assert {-1, 0, 2} <= set(np.unique(full).tolist()) | {0}


def test_what_stands_behind_a_camera_is_not_judged_by_it() -> None:
    full = np.zeros((4, 4, 4), np.int8)
    camera = ROLLED.cameras[0]
    behind_m = centre(camera) - np.array(camera.R)[2] * 2.0
    visual_hull._carve(full, behind_m, view_of(camera), outlines(on_one_leg())[0])
    assert not full.any()


def test_of_two_pieces_the_one_of_more_volume_times_height_is_a_person() -> None:
    """A box that is low and broad, and one that is as large and tall; an arm that one view alone
    shows belongs to what it hangs on, as far as an arm reaches."""
    full = np.zeros((60, 40, 60), np.int8)
    full[5:15, 0:4, 5:15] = 2
    full[40:45, 2:18, 40:45] = 2
    full[45:58, 10, 42] = 1
    full[15:18, 0, 5] = 1
    found = visual_hull._largest(full)
    kept = np.zeros(full.shape, np.bool_)
    kept[tuple(found.T)] = True
    assert kept[40:45, 2:18, 40:45].all()
    assert not kept[:20].any()
    reach = visual_hull.REACH_CELLS
    assert kept[45 : 45 + reach, 10, 42].all()
    assert not kept[45 + reach :, 10, 42].any()
    assert not len(visual_hull._largest(np.zeros((4, 4, 4), np.int8)))


def test_little_clutter_is_left_as_it_is() -> None:
    """Its share of a silhouette is what counts, to either side of the bound."""
    first, second = outlines(on_one_leg())
    area = int(second.sum())
    for share, is_clutter in ((0.0, False), (3.0, True)):
        spoilt = second.copy()
        rows = int(np.ceil(share * visual_hull.CLUTTER_SHARE * area / 20))
        spoilt[10 : 10 + rows, 0:20] = True
        pair = (person_in(first), person_in(spoilt))
        found = visual_hull.cleaned(ROLLED, pair)
        assert found.clutter == is_clutter
        if not is_clutter:
            assert found.seen == pair
