"""Silhouettes of a lens that bends, held against those of one that does not."""

import msgspec
import numpy as np
import pytest
from rolling import BODY, ROLLED, on_one_leg, outlines, person_in, told

from common.body.observation import Observation, Search
from common.bus.instant import Instant
from common.raster.silhouette_report import unpack
from common.raster.similarity import Mask, similarity
from common.rig.camera import project
from integrator.proposal import pose_proposal
from integrator.rig.undistortion import (
    undistorted,
    undistorted_instant,
    undistorted_observation,
    undistorted_rig,
)

LENS = (-0.9, 0.4, 0.002, -0.001, 0.0)
BENT = msgspec.structs.replace(
    ROLLED,
    cameras=tuple(msgspec.structs.replace(camera, distortion=LENS) for camera in ROLLED.cameras),
)
HEIGHT, WIDTH = ROLLED.height, ROLLED.width


def bent(mask: Mask, n: int) -> Mask:
    """What the bending lens makes of a silhouette: each third of a pixel goes where it projects."""
    camera = BENT.cameras[n]
    K, R, t = np.array(camera.K), np.array(camera.R), np.array(camera.t)
    rows, columns = np.nonzero(np.kron(mask, np.ones((3, 3), np.bool_)))
    rays = np.linalg.inv(K) @ (np.stack([columns + 0.5, rows + 0.5, np.full(len(rows), 3)]) / 3)
    u, v = np.floor(project(camera, (rays * 3.0 - t[:, None]).T @ R)).astype(int).T
    inside = (u >= 0) & (v >= 0) & (u < mask.shape[1]) & (v < mask.shape[0])
    seen = np.zeros_like(mask)
    seen[v[inside], u[inside]] = True
    return seen


def at(rows: slice, columns: slice) -> Observation:
    mask = np.zeros((HEIGHT, WIDTH), np.bool_)
    mask[rows, columns] = True
    return person_in(mask)


def test_a_bent_silhouette_is_the_straight_one_again() -> None:
    for n, mask in enumerate(outlines(on_one_leg())):
        shown = bent(mask, n)
        assert similarity(mask, shown) < 0.94
        assert similarity(mask, undistorted(shown, BENT.cameras[n])) > 0.94


def test_a_lens_that_does_not_bend_changes_nothing() -> None:
    first, second = outlines(on_one_leg())
    pair = Instant((told(1, first), told(2, second)))
    assert undistorted_instant(ROLLED, pair) == pair
    assert undistorted_instant(None, pair) == pair
    assert undistorted_rig(ROLLED) is ROLLED


def test_the_navel_goes_where_a_straight_lens_shows_it() -> None:
    place_m = np.array([[0.6, 1.7, 0.2]])
    bent_px, straight_px = (project(rig.cameras[0], place_m)[0] for rig in (BENT, ROLLED))
    assert np.hypot(*(bent_px - straight_px)) > 1.0
    person = person_in(outlines(on_one_leg())[0])
    search = Search((bent_px[0], bent_px[1]), {}, False, 0.0, 0)
    person = msgspec.structs.replace(person, search=search)
    straight = undistorted_observation(person, BENT.cameras[0]).search
    assert straight is not None
    assert straight.root_px == pytest.approx(straight_px, abs=0.01)


def test_what_the_straight_picture_does_not_hold_is_cut() -> None:
    """Four pixels from the side of the bent one somebody is whole, and not in the straight one."""
    report = at(slice(100, 140), slice(4, 30))
    assert not report.cut
    found = undistorted_observation(report, BENT.cameras[0])
    assert found.cut
    assert found.box.left == 0
    assert found.area_px == unpack(found).sum()


def test_somebody_of_whom_nothing_would_be_left_is_still_somebody() -> None:
    """Who enters from a side, seen in the lens's corner alone: a pose is proposed all the same."""
    report = at(slice(0, 6), slice(0, 4))
    assert not undistorted(unpack(report), BENT.cameras[0]).any()
    found = undistorted_observation(report, BENT.cameras[0])
    assert found == report
    shown = pose_proposal.step(None, BODY, undistorted_rig(BENT), (found, None), 1 / 15)
    assert np.isfinite(shown.joints_m).all()
