"""The compiled passes over a picture, held against the same rules in plain numpy."""

from itertools import product

import numpy as np
import pytest
from picture_rules import CELL, held, scene

from viewer.silhouette.difference import adapted, label, seeds

SEEDS = pytest.mark.parametrize("seed", [0, 1, 2])


@SEEDS
def test_a_cell_is_a_seed_where_one_of_two_pixels_is_six_spreads_off(seed: int) -> None:
    frame, model = scene(seed)
    far = held(frame, model)
    found = seeds(frame, model, CELL)
    assert found.shape == (6, 7)
    for i, j in product(range(6), range(7)):
        places = [(min(i * CELL + k, 21), min(j * CELL + k, 26)) for k in (0, CELL // 2)]
        assert found[i, j] == any(far.unshaded[place] > 36.0 for place in places), (i, j)
    assert 0 < found.sum() < found.size


@SEEDS
def test_a_pixel_is_decided_by_itself_its_colour_and_its_neighbours(seed: int) -> None:
    """Evidence up to two spreads; neighbours at an edge weigh 0.3, at a corner 0.7 of that."""
    frame, model = scene(seed)
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


@SEEDS
def test_the_background_follows_what_is_calm_and_not_near_the_body(seed: int) -> None:
    """By a fifth of the difference, taken back to the background's own light."""
    frame, model = scene(seed)
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
