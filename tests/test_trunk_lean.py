"""How far a trunk leans in a picture, by hand."""

import pytest

from common.body.trunk_lean import lean_deg


@pytest.mark.parametrize(
    ("right", "down", "deg"),
    [
        (0.0, -5.0, 0.0),
        (29.0, -52.0, 0.0),  # 29.1
        (30.0, -51.0, 30.466),
        (-30.0, -51.0, -30.466),
        (4.0, 0.0, 90.0),
        (-4.0, 3.0, -126.870),
        (0.0, 2.0, 180.0),
        (0.0, 0.0, 0.0),
        (0.0, -0.0, 0.0),
    ],
)
def test_a_trunk_leans_clockwise_by_its_angle_from_30_degrees_on(
    right: float, down: float, deg: float
) -> None:
    """Rows grow down: upright is a neck above its pelvis."""
    assert lean_deg(right, down) == pytest.approx(deg, abs=1e-3)
