"""The proportions of bodies, held against the numbers that both documents print."""

import pytest

from common.body.proportions import (
    THESIS_DIAMETERS,
    THESIS_RATIOS,
    body_vector,
    stature,
    thesis_bdp,
)


def test_the_thesis_lengths_add_up_to_the_stature() -> None:
    """T4: head + torso + legs = 175."""
    table = THESIS_RATIOS
    assert table["head"] + table["torso"] + table["upper_leg"] + table["lower_leg"] == 175.0
    assert (table["upper_arm"], table["lower_arm"], table["stature"]) == (25.0, 35.0, 175.0)
    assert stature(thesis_bdp(1.75)) == pytest.approx(1.75)


def test_the_thesis_widths_are_diameters() -> None:
    """T5, M18: as diameters the torso is 40 of 175 wide, as radii it would be 80."""
    bdp = thesis_bdp(175.0)
    assert 2 * bdp.torso.long_radius == pytest.approx(40.0)
    assert 2 * bdp.head.long_radius == pytest.approx(20.0)
    assert 2 * bdp.r_upper_arm.radius == 2 * bdp.l_lower_arm.radius == pytest.approx(10.0)
    assert 2 * bdp.r_lower_leg.long_radius == pytest.approx(20.0)
    assert set(THESIS_DIAMETERS) == set(THESIS_RATIOS) - {"stature"}


def test_shoulders_and_hips_are_where_the_paper_puts_them() -> None:
    """P18: the shoulder is a long radius aside of the trunk's axis and 0.45 of it below the top;
    legs stand within the trunk's width."""
    bdp = thesis_bdp(1.75)
    body = body_vector(bdp)
    radius = bdp.torso.long_radius
    assert len(body) == 39
    assert body[:26].tolist() == bdp.lengths()
    assert body[26] == pytest.approx(radius)
    assert body[27] == pytest.approx(bdp.torso.height - 0.45 * radius)
    assert body[28] + bdp.r_upper_leg.long_radius == pytest.approx(radius)
