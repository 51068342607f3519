"""Two people before both cameras of the paper's rig, with exact landmarks."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray
from staging import PERSON, RIG, observation, standing

from common.body.body import POSE_INDEX
from common.body.kinematics import joints
from common.body.observation import Box, Landmarks, Observation
from common.body.proportions import body_vector
from common.bus.instant import Instant
from common.bus.messages import View
from common.rig.camera import Rig, project

PERIOD_S = 1.0 / 15.0
THERE_M = (2.2, -2.2)
"""Where the other person stands: behind the first, to the right of camera 1's picture."""


def first_m(n: int) -> NDArray[np.float64]:
    """Joints (15, 3) of a person who lifts both arms and lets them down, once in two seconds."""
    pose = standing((0.2 * math.sin(n / 9.0), 0.0))
    for name in ("l_shoulder_z", "r_shoulder_z"):
        if name in POSE_INDEX:
            pose[POSE_INDEX[name]] += 70.0 * math.sin(math.pi * n / 15.0) ** 2
    return np.asarray(joints(body_vector(PERSON), pose))


def other_m(n: int) -> NDArray[np.float64]:
    """Joints of another person, who walks to and fro and leans."""
    lean = math.radians(35.0) * math.sin(n / 4.0)
    found = np.asarray(joints(body_vector(PERSON), standing()))
    above = found - [0.0, 0.9, 0.0]
    turn = np.array(
        [[math.cos(lean), -math.sin(lean), 0], [math.sin(lean), math.cos(lean), 0], [0, 0, 1]]
    )
    found = np.where(above[:, 1:2] > 0.0, above @ turn.T, above) + np.array([0.0, 0.9, 0.0])
    walked_m = THERE_M[0] + 0.3 * math.sin(n / 5.0), 0.0, THERE_M[1] + 0.3 * math.cos(n / 3.0)
    return np.asarray(found + np.array(walked_m))


def seen(
    view: int, joints_m: NDArray[np.float64], sure: float = 0.9, rig: Rig = RIG
) -> Observation:
    """A person as a view shows them."""
    places_px = project(rig.cameras[view], joints_m)
    (left, top), (right, bottom) = places_px.min(axis=0), places_px.max(axis=0)
    shown = Landmarks(tuple((x, y) for x, y in places_px.tolist()), (sure,) * 15)
    box = Box(round(left), round(right), round(top), round(bottom))
    return msgspec.structs.replace(observation(), landmarks=shown, box=box)


def instant(n: int, *people: Sequence[Observation]) -> Instant:
    """An instant with these people in each view."""
    return Instant(
        tuple(
            View(
                viewer=number,
                frame=n,
                captured_s=n * PERIOD_S,
                clock_s=n * PERIOD_S,
                width=RIG.width,
                height=RIG.height,
                people=tuple(each),
            )
            for number, each in enumerate(people, 1)
        )
    )
