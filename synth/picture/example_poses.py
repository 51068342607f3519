"""Poses of people for pictures: of one performance, or random."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from synth.person.people import Person
from synth.person.skeleton import ANGLES
from synth.picture.silhouette_examples import AT_LARGE, course

WILD_SHARE: Final = 0.5
"""Share of the people with unrelated poses."""
FALLEN_SHARE: Final = 0.3
"""Share of the random poses that lie, crawl or fall."""
WILD_DEG: Final[dict[str, tuple[float, float]]] = {
    "torso_pitch": (-20.0, 75.0),
    "torso_roll": (-25.0, 25.0),
    "torso_yaw": (-40.0, 40.0),
    "head_pitch": (-35.0, 40.0),
    "head_yaw": (-60.0, 60.0),
    "head_roll": (-20.0, 20.0),
    "sh_abd": (-10.0, 165.0),
    "sh_flex": (-55.0, 175.0),
    "sh_twist": (-60.0, 80.0),
    "elbow": (0.0, 145.0),
    "hip_abd": (-5.0, 50.0),
    "hip_flex": (-25.0, 125.0),
    "hip_twist": (-10.0, 35.0),
    "knee": (0.0, 140.0),
    "foot": (0.0, 1.0),
    "root_pitch": (-12.0, 25.0),
    "root_roll": (-12.0, 12.0),
    "root_yaw": (-180.0, 180.0),
}
"""Range of each joint in a random pose, by its name in ANGLES without the side."""
CALM: Final = 1.3
"""Exponent that concentrates random angles around the rest pose."""
REST_DEG: Final = {"sh_abd": 10.0, "sh_flex": 5.0, "elbow": 15.0, "hip_flex": 3.0, "knee": 5.0}
FALLEN_DEG: Final = (50.0, 110.0)


def poses_deg(someone: Person, n: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Angles in the order of ANGLES, (n, 27).

    Args:
        someone: The person.
        n: Number of poses.
        rng: Source of them.
    """
    if rng.random() < WILD_SHARE:
        return _wild(n, rng)
    moved = course(someone, AT_LARGE, rng)
    angles = moved[rng.integers(len(moved), size=n)]
    angles[:, ANGLES.index("root_yaw")] += rng.uniform(-180.0, 180.0)
    return angles


def _wild(n: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """(n, 27) angles of random poses."""
    columns = []
    for name in ANGLES:
        low, high = WILD_DEG[name[2:] if name[1] == "_" else name]
        rest = REST_DEG.get(name[2:], 0.5 * (low + high) if name[1] == "_" else 0.0)
        reach = rng.uniform(low, high, n)
        if name != "root_yaw":
            reach = rest + (reach - rest) * rng.random(n) ** CALM
        columns.append(reach)
    angles = np.stack(columns, axis=1)
    fallen = rng.random(n) < FALLEN_SHARE
    for name in ("root_pitch", "root_roll"):
        lying = rng.uniform(*FALLEN_DEG, n) * rng.choice([-1.0, 0.0, 1.0], n)
        angles[fallen, ANGLES.index(name)] += lying[fallen]
    return angles
