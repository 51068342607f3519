"""Colours that are counted, held against the same counting in plain numpy."""

import numpy as np
import pytest
from picture_rules import CELL, held, scene

from viewer.silhouette.colour_model import SHADES, body_colours_of, counted, fresh

SEEDS = pytest.mark.parametrize("seed", [0, 1, 2])


def test_a_colour_speaks_for_whom_it_was_seen_on_the_more_often_it_was() -> None:
    counts = fresh()
    assert counts.shape == (2, SHADES)
    counts[:, 5], counts[:, 6], counts[:, 7] = (0, 30), (30, 0), (4, 6)
    found = body_colours_of(counts)
    assert found[5:8] == pytest.approx([0.75, -0.75, 0.1])
    assert (np.delete(found, [5, 6, 7]) == 0).all()


@SEEDS
def test_pixels_well_inside_and_surely_outside_are_counted_and_old_ones_fade(seed: int) -> None:
    """Every other pixel, like a chessboard, of the cells alone."""
    frame, model = scene(seed)
    high, wide = frame.shape[:2]
    rng = np.random.default_rng(4)
    inside = rng.choice([0, 3, 9], (high, wide)).astype(np.uint8)
    cells = np.zeros((6, 7), np.uint8)
    cells[1:3, 2:] = cells[5, 0] = 1
    before = rng.uniform(0, 20, (2, SHADES)).astype(np.float32)
    found = counted(before, inside, frame, model, cells, CELL)
    far = held(frame, model)
    asked = np.kron(cells, np.ones((CELL, CELL), np.uint8))[:high, :wide] > 0
    y, x = np.indices((high, wide))
    asked &= (x % CELL + y) % 2 == 0
    expected = 0.95 * before.astype(float)
    np.add.at(expected[1], far.shades[asked & (inside == 9)], 1.0)
    np.add.at(expected[0], far.shades[asked & (inside == 0) & (far.unshaded < 6.25)], 1.0)
    assert found == pytest.approx(expected, abs=1e-3)
    assert (expected > before).sum() > 10
