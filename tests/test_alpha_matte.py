"""What share of a pixel the body covers, held against the same rules in plain numpy."""

import cv2
import numpy as np
import pytest
from picture_rules import LUMA, held, scene

from viewer.silhouette.alpha_matte import FACTS, SIDES, matte, sides_of

SEEDS = pytest.mark.parametrize("seed", [0, 1, 2])
CORNER = (3, 2)
"""Row and column at which the window begins."""
WINDOW = (15, 22)


def inside_of(seed: int) -> np.ndarray:
    """How many of a pixel's neighbours are in a body of the window, 0 to 9."""
    body = np.zeros(WINDOW, np.float32)
    body[3:12, 4 + seed : 13] = 1
    means = cv2.blur(body, (3, 3), borderType=cv2.BORDER_CONSTANT)
    return np.asarray(np.rint(9 * means), np.uint8)


def window(picture: np.ndarray) -> np.ndarray:
    top, left = CORNER
    cut: np.ndarray = picture[top : top + WINDOW[0], left : left + WINDOW[1]].astype(float)
    return cut


@SEEDS
def test_sides_are_the_bodys_colour_and_the_light_seen_and_due_beside_it(seed: int) -> None:
    frame, model = scene(seed)
    inside = inside_of(0)
    found = sides_of(frame, model, inside, CORNER)
    assert found.shape == (*WINDOW, SIDES)
    body, out = inside == 9, inside == 0
    assert (found[body][:, :3] == window(frame)[body]).all()
    assert (found[body][:, 3] == 1).all()
    assert (found[~body][:, :4] == 0).all()
    due = np.minimum(window(model.centre) * model.gain, 255.0)
    for column, picture in ((4, window(frame)), (5, due)):
        assert np.abs(found[out][:, column] - (picture[out] @ LUMA)).max() <= 0.51
        assert (found[~out][:, column] == 0).all()


def opponent(off: np.ndarray) -> np.ndarray:
    """(..., 4) brightness, and the rest of the channels at 0.4."""
    luma = off @ LUMA
    return np.concatenate([luma[..., None], 0.4 * (off - luma[..., None])], axis=-1)


@SEEDS
def test_a_pixel_is_a_mix_of_the_body_beside_it_and_the_shaded_background(seed: int) -> None:
    frame, model = scene(seed)
    inside = inside_of(0)
    sides = cv2.blur(
        sides_of(frame, model, inside, CORNER).astype(np.float32), (7, 7), borderType=0
    )
    reach = np.zeros(WINDOW, np.uint8)
    reach[1:14, 1:20] = 1
    reach[2:6, 2:18] = 2
    shares, places, facts = matte(frame, model, sides, reach, CORNER)

    seen = reach > 0
    shade = np.ones(WINDOW)
    lit = sides[..., 5] > 1e-3
    shade[lit] = np.clip(sides[..., 4][lit] / sides[..., 5][lit], 0.5, 1.1)
    there = sides[..., 3] > 1e-3
    colours = np.zeros((*WINDOW, 3))
    colours[there] = sides[..., :3][there] / sides[..., 3][there][:, None]
    due = np.minimum(window(model.centre) * model.gain, 255.0) * shade[..., None]
    off, full = opponent(window(frame) - due), opponent(colours - due)
    square = (full**2).sum(axis=-1)
    share = np.clip((off * full).sum(axis=-1) / (square + 25.0), -0.5, 1.5)
    share[~there] = -1.0
    assert shares[seen][:, 0] == pytest.approx(share[seen], abs=1e-3)
    assert shares[seen][:, 1] == pytest.approx(
        np.minimum(np.abs(off[..., 0][seen]) / 20.0, 2.0), abs=1e-3
    )

    assert np.array_equal(places, np.argwhere(reach == 2))
    assert facts.shape == (len(places), FACTS)
    band = reach == 2
    third = np.maximum((off**2).sum(axis=-1) - share**2 * square, 0.0)
    part = there / 20.0
    for column, told in enumerate((np.sqrt(square), np.abs(full[..., 0]), np.sqrt(third))):
        expected = part * np.minimum(told, 100.0)
        assert facts[:, column] == pytest.approx(expected[band], abs=0.02)
    assert facts[:, 3] == pytest.approx(shade[band], abs=1e-4)
    far = held(frame, model)
    weight = model.weight.astype(float)
    luma = far.off @ LUMA
    colour = np.sqrt(((far.off - luma[..., None]) ** 2).sum(axis=-1) * weight[..., 1])
    bright = luma * np.sqrt(weight[..., 0])
    spreads = (np.sqrt(far.unshaded), bright, colour)
    for column, told in enumerate(spreads, 4):
        expected = np.clip(window(told), -20.0, 20.0) / 8.0
        assert facts[:, column] == pytest.approx(expected[band], abs=2e-3)
    body_colours = model.body_colours[window(far.shades).astype(int)]
    assert facts[:, 7] == pytest.approx(body_colours[band], abs=1e-6)
