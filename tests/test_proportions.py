"""The proportions of bodies, held against the numbers that both documents print."""

import pytest

from common.body.body import body_of_lengths
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
    assert thesis_bdp(1.75).torso.long_radius == pytest.approx(0.2)
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


def test_joints_of_a_body_whose_sides_differ_lie_by_each_sides_own_lengths() -> None:
    """Hip 0.530, knee 0.285 and ankle 0.039 statures over the sole, shoulders 0.20 apart; elbow and
    wrist at their shares of the arm from the trunk's axis of the shoulder."""
    bdp = body_of_lengths([0.01 * n + 0.2 for n in range(26)])
    body = body_vector(bdp)
    tall = stature(bdp)
    assert tall == pytest.approx(
        bdp.head.height + bdp.torso.height + bdp.r_upper_leg.height + bdp.r_lower_leg.height
    )
    radius = bdp.torso.long_radius
    inset = radius - 0.1 * tall
    assert body[38] == pytest.approx(inset)
    assert body[26:29] == pytest.approx(
        [radius, bdp.torso.height - 0.45 * radius, radius - bdp.r_upper_leg.long_radius]
    )
    leg = bdp.r_upper_leg.height + bdp.r_lower_leg.height
    assert body[37] == pytest.approx(0.530 * tall - leg)
    legs = [leg, bdp.l_upper_leg.height + bdp.l_lower_leg.height]
    assert body[33:35] == pytest.approx([own - 0.285 * tall for own in legs])
    assert body[35:37] == pytest.approx([own - 0.039 * tall for own in legs])
    arms = [
        bdp.r_upper_arm.height + bdp.r_lower_arm.height,
        bdp.l_upper_arm.height + bdp.l_lower_arm.height,
    ]
    assert body[29:31] == pytest.approx([0.186 / 0.415 * (inset + own) for own in arms])
    assert body[31:33] == pytest.approx([0.332 / 0.415 * (inset + own) for own in arms])
