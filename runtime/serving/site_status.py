"""A site's state: its processes' pulses as one, and a line for display."""

from collections.abc import Iterable, Mapping
from typing import Literal, NamedTuple

from common.bus.control_messages import Pulse

LAME = ("restarting", "given up")
WELL = ("ready", "running", "ended")


class Status(NamedTuple):
    """State of one site."""

    well: bool
    line: str


def site_pulse(name: str, pulses: Mapping[str, Pulse], own_mb: float) -> Pulse:
    """The pulse of a site's supervisor for all its processes.

    Args:
        name: Name of the site.
        pulses: The newest pulse of each process.
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
    """One line about a site's state.

    Args:
        name: Name of the site.
        pulse: Its newest pulse; None where there is none yet.
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
    """The integrator's state; a site that has once worked still works while it is restarted."""
    if hub is None:
        return "starting"
    return "running" if hub.state in LAME else hub.state  # type: ignore[return-value]


def _sums(pulses: Iterable[Pulse]) -> dict[str, int]:
    """Counts over all processes."""
    all_of = list(pulses)
    losses = ("deadline_misses", "dropped", "guide_misses", "hurried", "late")
    fields = (*losses, "malformed", "foreign")
    return {field: sum(getattr(each, field) for each in all_of) for field in fields}
