"""A person among several, between instants."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.body.observation import Observation
from common.bus.messages import Body
from integrator import merge_state

PELVIS: Final = JOINT_NAMES.index("pelvis")
NEW_SHARE: Final = 0.1
"""Weight of an instant in the running mean of the clothes' colours."""
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
    joints_s: float = 0.0
    """When that was."""
    velocity_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    colours: tuple[float, ...] = ()
    """Mean colours of their clothes, as `Observation.colours`."""

    def expected_m(self, now_s: float) -> Places | None:
        """The joints expected at a time; None where the person was never believed."""
        if self.joints_m is None:
            return None
        ahead_s = min(max(now_s - self.joints_s, 0.0), CARRIED_S)
        return self.joints_m + np.array(self.velocity_m_s) * ahead_s

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
    life = life._replace(colours=_mixed(life.colours, seen))
    if body.status not in {"tracking", "measuring"}:
        return life
    joints_m = np.array(body.joints_m)
    return life._replace(
        joints_m=joints_m, joints_s=now_s, velocity_m_s=_velocity(life, joints_m, now_s)
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


def _mixed(known: tuple[float, ...], seen: tuple[Observation | None, ...]) -> tuple[float, ...]:
    """The running mean of the colours."""
    shown = [one.colours for one in seen if one is not None and one.colours]
    if not shown:
        return known
    now = np.mean(shown, axis=0)
    if not known:
        return tuple(now.tolist())
    return tuple((NEW_SHARE * now + (1.0 - NEW_SHARE) * np.array(known)).tolist())
