"""The compiled passes over a picture, held against the same rules in plain numpy."""

from itertools import product
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from viewer.background.background import BackgroundModel
from viewer.silhouette.difference import adapted, label, seeds

LUMA = np.array([0.114, 0.587, 0.299])
CELL = 4
Floats = NDArray[np.float64]


class Held(NamedTuple):
    """A picture against a background, pixel by pixel: the rules in doubles."""

    off: Floats
    """(H, W, 3) how it differs under this light."""
    total: Floats
    """(H, W) distance in spreads, squared."""
    unshaded: Floats
    """The same with soft shadows forgiven."""
    shades: NDArray[np.int64]


def held(frame: NDArray[np.uint8], model: BackgroundModel) -> Held:
    gain = model.gain.astype(float)
    due = np.minimum(model.centre * gain, 255.0)
    off = frame - due
    weight = model.weight.astype(float)
    luma = off @ LUMA
    colour = ((off - luma[..., None]) ** 2).sum(axis=-1) * weight[..., 1]
    total = luma**2 * weight[..., 0] + colour
    part = luma / np.maximum(due @ LUMA, 1.0)
    left = ((off - part[..., None] * due) ** 2).sum(axis=-1) * weight[..., 1]
    shaded = (part < 0.0) & (part > -0.3) & (left < 9.0)
    even = frame / gain
    bright = even @ LUMA
    blue, red = (even[..., c] - bright for c in (0, 2))
    shades = np.minimum(bright.astype(int) >> 5, 7) << 8
    for value, shift in ((blue, 4), (red, 0)):
        shades += np.clip((np.trunc(value).astype(int) + 64) >> 3, 0, 15) << shift
    return Held(off, total, np.where(shaded, np.minimum(left, total), total), shades)


@pytest.fixture(scope="module", params=[0, 1, 2])
def scene(request: pytest.FixtureRequest) -> tuple[NDArray[np.uint8], BackgroundModel]:
    """Noise about a room, a shadow over the left, a thing at the right, and colours of a body."""
    rng = np.random.default_rng(request.param)
    centre = rng.uniform(40, 255, (22, 27, 3)).astype(np.float32)
    spread = rng.uniform(1.0, 3.0, (22, 27, 2)).astype(np.float32)
    gain = np.array([0.9, 1.0, 1.1], np.float32)
    shown = np.minimum(centre * gain, 255.0) + rng.normal(0.0, 3.0, centre.shape)
    shown[:, :9] *= rng.uniform(0.6, 1.0, (22, 9, 1))
    shown[5:17, 20:] = rng.uniform(0, 255, 3)
    colours = rng.uniform(-1, 1, 1 << 11).astype(np.float32)
    model = BackgroundModel(centre, 1.0 / spread**2, gain, colours)
    return np.clip(np.rint(shown), 0, 255).astype(np.uint8), model


def test_a_cell_is_a_seed_where_one_of_two_pixels_is_six_spreads_off(
    scene: tuple[NDArray[np.uint8], BackgroundModel],
) -> None:
    frame, model = scene
    far = held(frame, model)
    found = seeds(frame, model, CELL)
    assert found.shape == (6, 7)
    for i, j in product(range(6), range(7)):
        places = [(min(i * CELL + k, 21), min(j * CELL + k, 26)) for k in (0, CELL // 2)]
        assert found[i, j] == any(far.unshaded[place] > 36.0 for place in places), (i, j)
    assert 0 < found.sum() < found.size


def test_a_pixel_is_decided_by_itself_its_colour_and_its_neighbours(
    scene: tuple[NDArray[np.uint8], BackgroundModel],
) -> None:
    """Evidence up to two spreads; neighbours at an edge weigh 0.3, at a corner 0.7 of that."""
    frame, model = scene
    high, wide = frame.shape[:2]
    cells = np.zeros((6, 7), np.uint8)
    cells[1:5, 1:] = cells[5, 6] = 1
    mask, doubt = np.full((high, wide), 7, np.uint8), np.full((high, wide), 7, np.uint8)
    label(mask, doubt, frame, model, cells, CELL)
    asked = np.kron(cells, np.ones((CELL, CELL), np.uint8))[:high, :wide] > 0
    far = held(frame, model)
    evidence = (np.sqrt(far.unshaded) - 4.75) * 0.25 + model.body_colours[far.shades]
    evidence = np.where(asked, np.clip(evidence, -2.0, 2.0), 0.0)
    around = np.pad(evidence, 1, mode="edge")
    edges = around[:-2, 1:-1] + around[2:, 1:-1] + around[1:-1, :-2] + around[1:-1, 2:]
    corners = around[:-2, :-2] + around[:-2, 2:] + around[2:, :-2] + around[2:, 2:]
    total = evidence + 0.3 * (edges + 0.7 * corners)
    sure = asked & (np.abs(total) > 1e-3) & (np.abs(np.abs(total) - 1.0) > 1e-3)
    assert np.array_equal(mask[sure], (total > 0)[sure])
    assert np.array_equal(doubt[sure], (np.abs(total) < 1.0)[sure])
    assert (mask[~asked] == 7).all()
    assert 0.2 < mask[asked].mean() < 0.8


def test_the_background_follows_what_is_calm_and_not_near_the_body(
    scene: tuple[NDArray[np.uint8], BackgroundModel],
) -> None:
    """By a fifth of the difference, taken back to the background's own light."""
    frame, model = scene
    far = held(frame, model)
    now = adapted(frame, model, (18, 24, 5, 19))
    calm = far.total < 4.75**2
    near = np.zeros(calm.shape, bool)
    near[5:20, 18:25] = True
    expected = model.centre + np.where((calm & ~near)[..., None], 0.2, 0.0) * far.off / model.gain
    sure = np.abs(far.total - 4.75**2) > 1e-3
    assert now[sure] == pytest.approx(expected[sure], abs=1e-3)
    assert (now[near] == model.centre[near]).all()
    assert 0.3 < calm.mean() < 1.0
