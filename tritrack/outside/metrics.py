"""The figures of a run as Prometheus reads them."""

from collections.abc import Iterator, Mapping
from itertools import accumulate
from typing import Final

from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    Metric,
)

from common.bus.control_messages import Pulse
from tritrack.outside.run_figures import BUCKETS_S, Latency, PartFigures, RunFigures

COUNTS: Final = (
    ("frames", "frames", "Frames that a process worked on."),
    ("missed_deadlines", "deadline_misses", "Frames whose work ended more than a frame late."),
    ("dropped_messages", "dropped", "Frames and messages that gave way to newer ones."),
    ("late_messages", "late", "Reports that came after their instant was merged."),
    ("missed_guides", "guide_misses", "Frames that were looked at without a guide of the last."),
)
"""Name of a count, its field in a Pulse, what it counts."""
CAUSES: Final = ("malformed", "foreign")
"""Why a message is rejected; fields of a Pulse."""
AGREEMENT: Final = (
    ("rig_apart_meters", "apart_mm", 0.001, "How far apart both views place the joints."),
    ("rig_soles_meters", "soles_mm", 0.001, "Height of the feet above the floor while standing."),
    ("rig_facing_degrees", "facing_deg", 1.0, "How far the views disagree which way is faced."),
    ("rig_believed_ratio", "believed", 1.0, "By what the joints' confidence is multiplied."),
)
"""Name of a gauge, its field in an Agreement, by what that is multiplied, what it tells."""


def families(figures: RunFigures, room: str, now_s: float) -> Iterator[Metric]:
    """Every metric of a run.

    Args:
        figures: Of the run.
        room: Its name, a label of each.
        now_s: By the clock of the figures.
    """
    yield from _counts(figures.parts, room)
    yield from _states(figures.parts, room, now_s)
    yield _latencies(figures.latencies, room)
    yield from _bodies(figures, room)


def _counts(parts: Mapping[str, PartFigures], room: str) -> Iterator[Metric]:
    pulses = _pulses(parts)
    for name, field, meaning in COUNTS:
        family = CounterMetricFamily(f"tritrack_{name}", meaning, labels=("room", "part"))
        for part, pulse in pulses.items():
            family.add_metric((room, part), getattr(pulse, field))
        yield family
    rejected = CounterMetricFamily(
        "tritrack_rejected_messages",
        "Messages that no process of the run would say.",
        labels=("room", "part", "cause"),
    )
    for part, pulse in pulses.items():
        for cause in CAUSES:
            rejected.add_metric((room, part, cause), getattr(pulse, cause))
    yield rejected


def _states(parts: Mapping[str, PartFigures], room: str, now_s: float) -> Iterator[Metric]:
    labels = ("room", "part")
    up = GaugeMetricFamily("tritrack_up", "1 while a process has its place.", labels=labels)
    restarts = CounterMetricFamily(
        "tritrack_restarts", "New processes in the place of one that died.", labels=labels
    )
    age = GaugeMetricFamily(
        "tritrack_message_age_seconds", "Since a process said anything.", labels=labels
    )
    memory = GaugeMetricFamily(
        "tritrack_resident_memory_bytes", "Memory of a process.", labels=labels
    )
    recent = GaugeMetricFamily(
        "tritrack_recent_latency_seconds",
        "From capture to the end of a process's work, over its last half minute.",
        labels=(*labels, "quantile"),
    )
    for name, part in parts.items():
        up.add_metric((room, name), part.there)
        restarts.add_metric((room, name), part.restarts)
        if part.heard_s is not None:
            age.add_metric((room, name), now_s - part.heard_s)
    for name, pulse in _pulses(parts).items():
        memory.add_metric((room, name), pulse.memory_mb * 1e6)
        recent.add_metric((room, name, "0.5"), pulse.latency_p50_ms / 1000.0)
        recent.add_metric((room, name, "0.99"), pulse.latency_p99_ms / 1000.0)
    yield from (up, restarts, age, memory, recent)


def _latencies(latencies: Mapping[str, Latency], room: str) -> Metric:
    family = HistogramMetricFamily(
        "tritrack_latency_seconds",
        "From capture until a body (integrator) or a posture (recognizer) is heard.",
        labels=("room", "part"),
    )
    ends = [*(str(end_s) for end_s in BUCKETS_S), "+Inf"]
    for part, latency in latencies.items():
        buckets = list(zip(ends, accumulate(latency.counts), strict=True))
        family.add_metric((room, part), buckets, latency.sum_s)
    return family


def _bodies(figures: RunFigures, room: str) -> Iterator[Metric]:
    bodies = CounterMetricFamily(
        "tritrack_bodies", "Bodies by status; tracking: believed.", labels=("room", "status")
    )
    for status, count in figures.bodies.items():
        bodies.add_metric((room, status), count)
    yield bodies
    agreement = figures.body.agreement if figures.body is not None else None
    if agreement is not None:
        for name, field, scale, meaning in AGREEMENT:
            yield _gauge(name, meaning, room, getattr(agreement, field) * scale)
    if figures.cameras is not None:
        meaning = "By how much the times of view 2 are set back."
        yield _gauge("view_offset_seconds", meaning, room, figures.cameras.late_s)


def _gauge(name: str, meaning: str, room: str, value: float) -> Metric:
    family = GaugeMetricFamily(f"tritrack_{name}", meaning, labels=("room",))
    family.add_metric((room,), value)
    return family


def _pulses(parts: Mapping[str, PartFigures]) -> dict[str, Pulse]:
    return {name: part.pulse for name, part in parts.items() if part.pulse is not None}
