"""The figures of a run, derived from its processes' messages."""

from bisect import bisect_left
from collections.abc import Mapping
from typing import Final, NamedTuple

from common.bus.control_messages import Cameras, Pulse
from common.bus.inbox import Alive
from common.bus.messages import Body, Posture

BUCKETS_S: Final = (
    *(0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05),
    *(0.0667, 0.1, 0.15, 0.25, 0.5, 1.0, 2.5),
)
"""Upper bounds of the latency classes, seconds; 66.7 ms is a frame at the paper's rate (P1)."""

MOST: Final = 8
"""Number of people who have figures, so that a long run's do not grow: each new person has another
number."""
BELIEVED: Final = ("measuring", "tracking")
THERE_S: Final = 0.5
"""Time since their last believed body for which a person counts as there, seconds."""

Told = Body | Posture | Pulse | Cameras | Alive
"""The messages that the figures are derived from."""


class PartFigures(NamedTuple):
    """The figures of one process."""

    pulse: Pulse | None = None
    """Its newest pulse."""
    heard_s: float | None = None
    """Time of its last message."""
    there: bool = False
    """Whether it is on the bus; False before, and after it died or its link was cut."""
    restarts: int = 0
    """Number of restarts."""


class Latency(NamedTuple):
    """Times from capture to the message's receipt, counted in classes."""

    counts: tuple[int, ...] = (0,) * (len(BUCKETS_S) + 1)
    """For each of BUCKETS_S; longer ones last."""
    sum_s: float = 0.0


class PersonFigures(NamedTuple):
    """The figures of one of several people."""

    bodies: Mapping[str, int] = {}
    """Number of their bodies of each status."""
    believed_s: float | None = None
    """Capture time of their last believed body."""


class RunFigures(NamedTuple):
    """The figures of a run."""

    parts: Mapping[str, PartFigures] = {}
    bodies: Mapping[str, int] = {}
    """Number of bodies of each status."""
    people: Mapping[int, PersonFigures] = {}
    """By number, of several people: of those whose body came last, the last one last."""
    body: Body | None = None
    """The newest body."""
    body_s: float | None = None
    """Time of its receipt."""
    latencies: Mapping[str, Latency] = {}
    """Of bodies by "integrator", of postures by "recognizer"."""
    cameras: Cameras | None = None


def step(figures: RunFigures, told: Told, now_s: float) -> RunFigures:
    """The figures after one more message.

    Args:
        figures: So far.
        told: A message, or an arrival or departure.
        now_s: Time of receipt by the room's clock: the integrator host's monotonic clock.
    """
    match told:
        case Body():
            bodies = {**figures.bodies, told.status: figures.bodies.get(told.status, 0) + 1}
            heard = _spoke(figures, "integrator", told.clock_s, now_s)
            people = _with_person(figures.people, told)
            return heard._replace(bodies=bodies, people=people, body=told, body_s=now_s)
        case Posture():
            return _spoke(figures, "recognizer", told.clock_s, now_s)
        case Pulse():
            return _with_part(figures, told.process, _beaten(figures, told, now_s))
        case Cameras():
            return figures._replace(cameras=told)
        case Alive():
            part = figures.parts.get(told.name, PartFigures())
            return _with_part(figures, told.name, part._replace(there=told.alive))


def there(figures: RunFigures) -> int:
    """Number of people with a believed body now, of several."""
    if figures.body is None:
        return 0
    since_s = figures.body.captured_s - THERE_S
    last_s = [each.believed_s for each in figures.people.values()]
    return sum(at_s is not None and at_s >= since_s for at_s in last_s)


def _with_person(people: Mapping[int, PersonFigures], body: Body) -> Mapping[int, PersonFigures]:
    """With one more body; that of a run which follows one person, or of no person, has number 0."""
    if not body.person:
        return people
    own = people.get(body.person, PersonFigures())
    bodies = {**own.bodies, body.status: own.bodies.get(body.status, 0) + 1}
    believed_s = body.captured_s if body.status in BELIEVED else own.believed_s
    others = {number: each for number, each in people.items() if number != body.person}
    kept = dict([*others.items()][-MOST + 1 :])
    return {**kept, body.person: PersonFigures(bodies, believed_s)}


def _beaten(figures: RunFigures, pulse: Pulse, now_s: float) -> PartFigures:
    """A process whose counts begin again was restarted."""
    part = figures.parts.get(pulse.process, PartFigures())
    last = part.pulse
    anew = last is not None and (
        pulse.frames < last.frames or (last.state == "running" and pulse.state in BEGINNING)
    )
    return part._replace(pulse=pulse, heard_s=now_s, restarts=part.restarts + anew)


BEGINNING: Final = ("starting", "ready")


def _spoke(figures: RunFigures, name: str, clock_s: float, now_s: float) -> RunFigures:
    """Count a process's message about a frame of that time."""
    took_s = max(now_s - clock_s, 0.0)
    before = figures.latencies.get(name, Latency())
    place = bisect_left(BUCKETS_S, took_s)
    counts = (*before.counts[:place], before.counts[place] + 1, *before.counts[place + 1 :])
    latencies = {**figures.latencies, name: Latency(counts, before.sum_s + took_s)}
    part = figures.parts.get(name, PartFigures())._replace(heard_s=now_s)
    return _with_part(figures._replace(latencies=latencies), name, part)


def _with_part(figures: RunFigures, name: str, part: PartFigures) -> RunFigures:
    return figures._replace(parts={**figures.parts, name: part})
