"""A person among several, between instants."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.body.observation import Observation
from common.bus.messages import Body
from integrator import merge_state

PELVIS: Final = JOINT_NAMES.index("pelvis")
NEW_SHARE: Final = 0.01
"""Least weight of an instant in the mean of the clothes' colours: a crossing of half a second, in
which a view may show another, leaves most of it."""
CALM: Final = 0.5
"""Weight of an instant in the running mean of the velocity."""
FASTEST_M_S: Final = 3.0
"""Upper bound of a person's speed: running across a room."""
CARRIED_S: Final = 0.5
"""Time out of sight for which a velocity is taken to last, seconds."""
NO_TRACK: Final = -1

Places = NDArray[np.float64]
"""(15, 3) world, JOINT_NAMES, metres."""


class Life(NamedTuple):
    """A person, with a life of their own: body, pose, filters, evidence about the rig."""

    number: int
    """Never another person's."""
    state: merge_state.State
    """The integrator's, of a run that follows this person alone."""
    born_s: float
    seen_s: float
    """Capture time of the last instant in which a view showed them."""
    tracks: tuple[int, ...]
    """For each view, the viewer's own number of the person, as last seen; NO_TRACK: never."""
    views_s: tuple[float, ...]
    """For each view, when it last showed them."""
    joints_m: Places | None = None
    """As last believed."""
    joints_s: float = -math.inf
    """When that was; -inf: never."""
    velocity_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    body: Body | None = None
    """As last believed."""
    colours: tuple[tuple[float, ...], ...] = ()
    """For each view, the mean colours of their clothes, as `Observation.colours`; empty: unknown.
    A camera's own colours differ less than those of two."""
    coloured: tuple[int, ...] = ()
    """For each view, the number of instants in it."""

    @property
    def was_believed(self) -> bool:
        """Whether they were ever believed."""
        return self.joints_s > -math.inf

    def expected_m(self, now_s: float) -> Places | None:
        """The joints expected at a time; None where the person was never believed."""
        if self.joints_m is None:
            return None
        ahead_s = min(max(now_s - self.joints_s, 0.0), CARRIED_S)
        return self.joints_m + np.array(self.velocity_m_s) * ahead_s

    def colours_in(self, view: int) -> tuple[float, ...]:
        """Colours of their clothes in a view, or else in any; empty: unknown."""
        own = self.colours[view] if self.colours else ()
        return own or next((each for each in self.colours if each), ())

    def has_colours_in(self, view: int) -> bool:
        """Whether that view itself has shown their clothes."""
        return bool(self.colours and self.colours[view])

    def unseen_s(self, now_s: float) -> float:
        """How long no view has shown them."""
        return now_s - self.seen_s


def after(life: Life, body: Body, seen: tuple[Observation | None, ...], now_s: float) -> Life:
    """The person after an instant.

    Args:
        life: Before it, with the integrator's state of the instant.
        body: As merged.
        seen: By view, the observations that count for this person.
        now_s: Capture time.
    """
    if not any(seen):
        return life
    tracks = tuple(
        old if one is None else one.track for old, one in zip(life.tracks, seen, strict=True)
    )
    views_s = tuple(
        old if one is None else now_s for old, one in zip(life.views_s, seen, strict=True)
    )
    life = life._replace(seen_s=now_s, tracks=tracks, views_s=views_s)
    life = _coloured(life, seen)
    if body.status not in {"tracking", "measuring"}:
        return life
    joints_m = np.array(body.joints_m)
    return life._replace(
        joints_m=joints_m, joints_s=now_s, velocity_m_s=_velocity(life, joints_m, now_s), body=body
    )


def _velocity(life: Life, joints_m: Places, now_s: float) -> tuple[float, float, float]:
    """The running mean of the pelvis's velocity along the floor."""
    dt_s = now_s - life.joints_s
    if life.joints_m is None or not 0.0 < dt_s <= CARRIED_S:
        return 0.0, 0.0, 0.0
    now = (joints_m[PELVIS] - life.joints_m[PELVIS]) / dt_s * (1.0, 0.0, 1.0)
    mean = CALM * now + (1.0 - CALM) * np.array(life.velocity_m_s)
    x, y, z = (mean / max(1.0, float(np.linalg.norm(mean)) / FASTEST_M_S)).tolist()
    return x, y, z


def _coloured(life: Life, seen: tuple[Observation | None, ...]) -> Life:
    """The person with the running means of the colours."""
    colours = list(life.colours or ((),) * len(seen))
    counts = list(life.coloured or (0,) * len(seen))
    for view, one in enumerate(seen):
        if one is None or not one.colours:
            continue
        share = max(1.0 / (counts[view] + 1), NEW_SHARE)
        before = np.array(colours[view] or one.colours)
        colours[view] = tuple((before + share * (np.array(one.colours) - before)).tolist())
        counts[view] += 1
    return life._replace(colours=tuple(colours), coloured=tuple(counts))
