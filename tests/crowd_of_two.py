"""Two people before both cameras of the paper's rig, as silhouettes with landmarks."""

from collections.abc import Sequence
from typing import Literal

import msgspec
import numpy as np
from staging import PERIOD_S, PERSON, RIG, observation, silhouettes, standing
from two_people import instant

from common.body.body import Vector
from common.body.kinematics import joints
from common.body.observation import Landmarks, Observation
from common.body.proportions import body_vector
from common.bus.instant import Instant
from common.bus.messages import Body
from common.config.settings import Settings
from common.method import DEFAULT
from common.rig.camera import project
from integrator import merge_state
from integrator.merge_state import Start
from integrator.people import several
from integrator.people.recognition import State

RED = (50.0, 60.0, 40.0, 40.0, 0.0, 0.0)
BLUE = (40.0, 10.0, -60.0, 60.0, 0.0, 0.0)
LEFT_M, RIGHT_M = (-0.7, 0.3), (0.6, -0.5)
"""Where the first and the second stand, (X, Z)."""
Tracks = tuple[int, int]
"""The viewers' numbers of a person, by view; -1: that view does not show them."""


def pose_at(place_m: tuple[float, float]) -> Vector:
    return standing(place_m, r_shoulder_z=60.0, l_shoulder_z=300.0)


def shown(
    place_m: tuple[float, float], tracks: Tracks, colours: tuple[float, ...]
) -> list[Observation | None]:
    """A person as each view shows them."""
    pose = pose_at(place_m)
    places_m = np.asarray(joints(body_vector(PERSON), pose))
    found: list[Observation | None] = []
    for view, mask in enumerate(silhouettes(pose)):
        px = project(RIG.cameras[view], places_m)
        landmarks = Landmarks(tuple((x, y) for x, y in px.tolist()), (0.9,) * 15)
        own = msgspec.structs.replace(
            observation(mask), landmarks=landmarks, track=max(tracks[view], 0), colours=colours
        )
        found.append(own if tracks[view] >= 0 else None)
    return found


def of_all(n: int, people: Sequence[Sequence[Observation | None]], order: int = 1) -> Instant:
    """An instant with these people, in any order."""
    views = [[one for one in view if one is not None] for view in zip(*people, strict=True)]
    if not people:
        views = [[], []]
    return instant(n, views[0], views[1][::order])


class Crowd:
    """The integrator of several people, or of one among them, stepped."""

    def __init__(self, people: Literal[1, "all"] = "all") -> None:
        state = merge_state.init(RIG, PERIOD_S, Settings(people=people), DEFAULT, Start())
        self.state, self.n = State(state), 0

    def see(self, *people: Sequence[Observation | None], order: int = 1) -> tuple[Body, ...]:
        """One instant."""
        now = of_all(self.n, people, order)
        self.state, merged = several.step(self.state, now)
        self.n += 1
        return merged.bodies

    def last(self, instants: int, *people: Sequence[Observation | None]) -> tuple[Body, ...]:
        """The last of some instants."""
        for _ in range(instants):
            bodies = self.see(*people)
        return bodies
