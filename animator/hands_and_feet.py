"""Hands and feet of a drawn body: ellipsoids at the ends of its arms and legs."""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from animator.scene import Colours, Shapes, faded, side_colour
from animator.turns import arc
from common.body.body import LIMBS
from common.body.extremities import ALL_JOINT_NAMES, EXTREMITY_NAMES
from common.bus.messages import Body

FINGERS: Final = 1.7
"""Reach of a half open hand from the wrist, over that of its third knuckle."""
HAND_THICK, FOOT_THICK = 0.45, 0.3
"""Half width of a hand and of a foot, in half lengths."""

_AT: Final = {name: i for i, name in enumerate(ALL_JOINT_NAMES)}
_UP: Final = np.array([0.0, 1.0, 0.0])
_SIDES: Final = ("r", "l")
_ENDS: Final = {"wrist": "lower_arm", "ankle": "lower_leg"}
"""The joint of a hand or a foot, and the limb that ends there."""


def hands_and_feet(body: Body, limbs: Shapes) -> Shapes:
    """Copies of the unit ball: both hands, then both feet, right before left.

    Args:
        body: With a pose and extremities.
        limbs: The body's, from `limb_shapes`. Drawn limbs deviate a little from the joints, and
            hands and feet are placed at their ends.
    """
    places = np.array((*body.joints_m, *body.extremities_m))
    starts, ends = _eggs(places)
    shifts = _far_ends(limbs) - places[[_AT[f"{s}_{end}"] for end in _ENDS for s in _SIDES]]
    along = ends - starts
    half = np.linalg.norm(along, axis=1) / 2
    wide = half * np.repeat([HAND_THICK, FOOT_THICK], len(_SIDES))
    return Shapes(
        (starts + ends) / 2 + shifts,
        arc(_UP, along).as_quat(scalar_first=True),
        np.stack([wide, half, wide], axis=1),
        _colours(body),
    )


def _eggs(places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Start and end of each, (4, 3): a hand from the wrist, a foot from above its heel."""

    def of(part: str) -> NDArray[np.float64]:
        return places[[_AT[f"{side}_{part}"] for side in _SIDES]]

    hands = of("wrist"), of("wrist") + FINGERS * (of("knuckle") - of("wrist"))
    feet = (of("ankle") + of("heel")) / 2, of("toe")
    return np.concatenate([hands[0], feet[0]]), np.concatenate([hands[1], feet[1]])


def _far_ends(limbs: Shapes) -> NDArray[np.float64]:
    rows = [LIMBS.index(f"{side}_{limb}") for limb in _ENDS.values() for side in _SIDES]
    turns = Rotation.from_quat(limbs.wxyzs[rows], scalar_first=True)
    found: NDArray[np.float64] = limbs.positions[rows] + turns.apply(
        limbs.scales[rows] * (0.0, 1.0, 0.0)
    )
    return found


def _colours(body: Body) -> Colours:
    """Colours by side or person, pale where no knuckle or toe was measured."""
    sure = dict(zip(EXTREMITY_NAMES, body.extremities_confidence, strict=False))
    strength = [sure.get(f"{s}_{end}", 0.0) for end in ("knuckle", "toe") for s in _SIDES]
    full = [side_colour(side, body.person) for side in _SIDES] * 2
    return faded(np.array(full, float), np.array(strength))
