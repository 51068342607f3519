"""How far a trunk leans in a picture: what is told of a person's sides is told about it."""

import math
from typing import Final

TILTED_DEG: Final = 30.0
"""Who leans by less counts as upright: so are most of the people who taught what tells facings."""


def lean_deg(right: float, down: float) -> float:
    """How far a trunk leans, degrees clockwise; 0 where it is less than TILTED_DEG, or no trunk.

    Args:
        right: From its pelvis to its neck, along the rows of the picture.
        down: And along its columns.
    """
    found = math.degrees(math.atan2(right, -down))
    return found if abs(found) > TILTED_DEG and math.hypot(right, down) > 0.0 else 0.0
