"""How a site is doing: its processes' pulses as one, and a line for who looks."""

from collections.abc import Iterable, Mapping
from typing import Literal, NamedTuple

from common.bus.control_messages import Pulse

LAME = ("restarting", "given up")
WELL = ("ready", "running", "ended")


class Status(NamedTuple):
    """Of one site."""

    well: bool
    line: str


def site_pulse(name: str, pulses: Mapping[str, Pulse], own_mb: float) -> Pulse:
    """What a site's supervisor says of all its processes together.

    Args:
        name: Of the site.
        pulses: The newest of each process.
        own_mb: Memory of the supervisor itself.
    """
    hub = pulses.get("integrator")
    lame = [f"{each.process}: {each.state}" for each in pulses.values() if each.state in LAME]
    return Pulse(
        process=name,
        state=_state(hub),
        detail="; ".join(lame)[:400],
        frames=hub.frames if hub else 0,
        fps=hub.fps if hub else 0.0,
        latency_p50_ms=hub.latency_p50_ms if hub else 0.0,
        latency_p99_ms=hub.latency_p99_ms if hub else 0.0,
        memory_mb=own_mb + sum(each.memory_mb for each in pulses.values()),
        **_sums(pulses.values()),
    )


def status_of(name: str, pulse: Pulse | None, failure: str) -> Status:
    """One line of how a site is.

    Args:
        name: Of the site.
        pulse: Its newest; None where it was not heard yet.
        failure: Why it does not run; "" where it does.
    """
    if failure:
        return Status(False, f"{name}: down: {failure}")
    if pulse is None:
        return Status(False, f"{name}: starting")
    counts = (
        f"{pulse.fps:.1f} frames a second, p99 {pulse.latency_p99_ms:.0f} ms, "
        f"{pulse.deadline_misses} missed, {pulse.memory_mb:.0f} MB"
    )
    lame = f" ({pulse.detail})" if pulse.detail else ""
    return Status(pulse.state in WELL and not lame, f"{name}: {pulse.state}{lame}, {counts}")


def _state(hub: Pulse | None) -> Literal["starting", "ready", "running", "ended"]:
    """The integrator's; a site that has once worked works while that is started again."""
    if hub is None:
        return "starting"
    return "running" if hub.state in LAME else hub.state  # type: ignore[return-value]


def _sums(pulses: Iterable[Pulse]) -> dict[str, int]:
    """Counts over all processes."""
    all_of = list(pulses)
    losses = ("deadline_misses", "dropped", "guide_misses", "hurried", "late")
    fields = (*losses, "malformed", "foreign")
    return {field: sum(getattr(each, field) for each in all_of) for field in fields}
