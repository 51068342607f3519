"""Silhouettes of a lens that bends, held against those of one that does not."""

import msgspec
import numpy as np
from rolling import ROLLED, on_one_leg, outlines, told

from common.camera import project
from common.similarity import Mask, similarity
from integrator import straight
from integrator.two_outlines import outlines_of

LENS = (-0.9, 0.4, 0.002, -0.001, 0.0)
BENT = msgspec.structs.replace(
    ROLLED,
    cameras=tuple(msgspec.structs.replace(camera, distortion=LENS) for camera in ROLLED.cameras),
)


def bent(mask: Mask, n: int) -> Mask:
    """What the bending lens makes of a silhouette: each pixel is looked up, by `project`."""
    camera = BENT.cameras[n]
    K, R, t = np.array(camera.K), np.array(camera.R), np.array(camera.t)
    fine = 3
    rows, columns = np.nonzero(np.kron(mask, np.ones((fine, fine), np.bool_)))
    pixels = np.stack([columns + 0.5, rows + 0.5, np.full(len(rows), fine)]) / fine
    rays = np.linalg.inv(K) @ pixels
    places_m = (rays * 3.0 - t[:, None]).T @ R
    seen = np.zeros_like(mask)
    u, v = np.floor(project(camera, places_m)).astype(int).T
    inside = (u >= 0) & (v >= 0) & (u < mask.shape[1]) & (v < mask.shape[0])
    seen[v[inside], u[inside]] = True
    return seen


def test_a_bent_silhouette_is_the_straight_one_again() -> None:
    for n, mask in enumerate(outlines(on_one_leg())):
        shown = bent(mask, n)
        assert similarity(mask, shown) < 0.94
        assert similarity(mask, straight.straight(shown, BENT.cameras[n])) > 0.94


def test_a_lens_that_does_not_bend_changes_nothing() -> None:
    mask = outlines(on_one_leg())[0]
    assert straight.straight(mask, ROLLED.cameras[0]) is mask
    assert straight.straight_rig(ROLLED) is ROLLED


def test_the_kernel_is_given_what_its_views_draw() -> None:
    """A body drawn through the views covers the outlines that two bending lenses show."""
    pose = on_one_leg()
    first, second = (bent(mask, n) for n, mask in enumerate(outlines(pose)))
    found = outlines_of(BENT, (told(1, first), told(2, second)))
    plain = outlines_of(ROLLED, (told(1, outlines(pose)[0]), told(2, outlines(pose)[1])))
    assert np.array_equal(found.views, plain.views)
    for seen, due in zip(found.seen, plain.seen, strict=True):
        off = int(np.bitwise_count(seen ^ due).sum())
        assert off < 0.06 * int(np.bitwise_count(due).sum())
