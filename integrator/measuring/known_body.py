"""A person's body as far as it is known: not at all, a prior, or measured."""

from typing import Any, NamedTuple, Self

import msgspec

from common.body.body import Bdp, Vector
from common.body.observation import Measure, Observation


class Phase(msgspec.Struct, frozen=True):
    """One of several stages, which a saved state tells apart by their names."""

    def _replace(self, **changes: Any) -> Self:
        """The same with other values, as of a named tuple."""
        return msgspec.structs.replace(self, **changes)


class Sample(NamedTuple):
    """A pose, and the observations that it was found from."""

    pose: Vector
    seen: tuple[Observation, Observation]


class Unknown(Phase, frozen=True, tag=True):
    """No person was seen yet."""

    @property
    def bdp(self) -> None:
        """No lengths."""


class Unmeasured(Phase, frozen=True, tag=True):
    """A prior body, and the progress of its measurement."""

    bdp: Bdp
    """Universal BDPs, metres."""
    bodies: tuple[Bdp, ...] = ()
    """Universal BDPs of the frames accepted so far."""
    places_m: tuple[tuple[float, float, float], ...] = ()
    """Places of the navel in them."""
    refused: int = 0
    """Frames since the last accepted one."""
    measures: tuple[tuple[Measure, Measure], ...] = ()
    """Measures of the accepted frames, in pixels of both views."""
    samples: tuple[Sample, ...] = ()
    """The instants to whose silhouettes the prior was fitted; empty where it was not."""
    unsampled: int = 0
    """Frames since the last of them."""
    statures_m: tuple[float, ...] = ()
    """The person's stature by the landmarks of the last instants."""

    @property
    def under_way(self) -> bool:
        """A person holds the opening posture, and its measurement is incomplete."""
        return bool(self.bodies)


class Measured(Phase, frozen=True, tag=True):
    """A body measured in the opening posture."""

    bdp: Bdp
    """Universal BDPs, metres."""
    measured_at_m: tuple[float, float, float]
    """Place of the navel in the opening posture."""
    measures: tuple[tuple[Measure, Measure], ...] = ()
    """As in `Unmeasured`; empty for a body that was known before the run."""
    samples: tuple[Sample, ...] = ()
    """As in `Unmeasured`, since it was measured."""
    unsampled: int = 0
    statures_m: tuple[float, ...] = ()
    """As in `Unmeasured`, since it was measured."""

    @property
    def under_way(self) -> bool:
        """Its measurement is over."""
        return False


Known = Unmeasured | Measured
"""A body with lengths."""
Opening = Unknown | Known
"""A body at any stage of its measurement."""
