"""What makes a rig unlikely, held against persons set up by hand."""

import math

import numpy as np
import pytest

from integrator.selfcalibration import person_prior as prior
from integrator.selfcalibration.rig_residuals import (
    ALL_WAYS,
    UPRIGHT_DEG,
    Explained,
    standing_misfits,
)
from integrator.selfcalibration.sight_lines import Meeting, Numbers


def standing(headings_deg: Numbers, lean_deg: float) -> Explained:
    """Who stands there leaning towards the world's x, whichever way they face."""
    points = np.zeros((len(headings_deg), 15, 3))
    points[:, prior.ANKLES, 1] = 0.05
    points[:, prior.NECK] = 0.05 * np.array([0.0, 1.0, 0.0])
    lean = math.radians(lean_deg)
    points[:, prior.NECK] += 1.4 * np.array([math.sin(lean), math.cos(lean), 0.0])
    turn = np.radians(headings_deg)
    across = np.stack([np.cos(turn), np.zeros(len(turn)), -np.sin(turn)], axis=1)
    for joint, side in zip(prior.SHOULDERS, (0.2, -0.2), strict=True):
        points[:, joint] += side * across
    seen = np.ones(points.shape[:2], bool)
    nothing = np.zeros(seen.shape)
    met = Meeting(points, np.zeros((3, *points.shape)), nothing[None], nothing, nothing, seen)
    return Explained(met, seen, nothing, seen, None)  # type: ignore[arg-type]


def test_who_faces_one_way_may_lean_by_a_habit() -> None:
    lean = standing_misfits(standing(np.zeros(40), 3.0), 1.75)[1]
    assert lean == pytest.approx([3.0 / UPRIGHT_DEG, 0.0], abs=1e-2)


def test_who_faces_all_ways_and_leans_one_way_shows_a_vertical_that_is_wrong() -> None:
    all_round = np.linspace(0.0, 351.0, 40)
    lean = standing_misfits(standing(all_round, 3.0), 1.75)[1]
    assert lean == pytest.approx([3.0 / (UPRIGHT_DEG * ALL_WAYS), 0.0], abs=1e-2)


def test_who_turns_to_and_fro_between_two_sides_is_between_both() -> None:
    lean = standing_misfits(standing(np.tile([-60.0, 60.0], 20), 3.0), 1.75)[1]
    assert lean[0] == pytest.approx(3.0 / (UPRIGHT_DEG * math.hypot(0.5, ALL_WAYS)), rel=1e-3)
