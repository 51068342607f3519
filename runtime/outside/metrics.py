"""The figures of a run in Prometheus's form."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate
from typing import Final

from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    Metric,
)

from runtime.outside.run_figures import BUCKETS_S, PartFigures, RunFigures, there

COUNTS: Final = (
    ("frames", "frames", "Frames that a process worked on."),
    ("missed_deadlines", "deadline_misses", "Frames whose work ended more than a frame late."),
    ("dropped_messages", "dropped", "Frames and messages that gave way to newer ones."),
    ("late_messages", "late", "Reports that came after their instant was merged."),
    ("missed_guides", "guide_misses", "Frames that were looked at without a guide of the last."),
    ("hurried_frames", "hurried", "Frames so late that a viewer told their outline alone."),
    ("in_turn_frames", "in_turn", "Late frames in which people were looked at in turn."),
)
"""Name of a counter, its field in a Pulse, its description."""
CAUSES: Final = ("malformed", "foreign")
"""Reasons for rejecting a message; fields of a Pulse."""
AGREEMENT: Final = (
    ("rig_apart_meters", "apart_mm", 0.001, "How far apart both views place the joints."),
    ("rig_soles_meters", "soles_mm", 0.001, "Height of the feet above the floor while standing."),
    ("rig_facing_degrees", "facing_deg", 1.0, "How far the views disagree which way is faced."),
    ("rig_motion_meters", "motion_mm", 0.001, "How far the views disagree how joints move."),
    ("rig_believed_ratio", "believed", 1.0, "By what the joints' confidence is multiplied."),
)
"""Name of a gauge, its field in an Agreement, its factor, its description."""


def families(rooms: Mapping[str, RunFigures], now_s: float) -> Iterator[Metric]:
    """Every metric of one run, or of several.

    Args:
        rooms: The figures of each run by its room's name, which labels every sample.
        now_s: By the clock of the figures.
    """
    parts = [(room, name, part) for room, own in rooms.items() for name, part in own.parts.items()]
    yield from _counts(parts)
    yield from _states(parts, now_s)
    yield _latencies(rooms)
    yield from _bodies(rooms)
    yield from _people({room: own for room, own in rooms.items() if own.people})
    yield _names(rooms)


def _names(rooms: Mapping[str, RunFigures]) -> Metric:
    """1 for each camera of a run's rig, labelled with its name and its viewer."""
    family = GaugeMetricFamily(
        "tritrack_camera_info", "Name of each viewer's camera.", labels=("room", "part", "camera")
    )
    for room, figures in rooms.items():
        rig = () if figures.cameras is None else figures.cameras.rig.cameras
        for number, camera in enumerate(rig, 1):
            family.add_metric((room, f"viewer {number}", camera.name), 1)
    return family


Parts = Sequence[tuple[str, str, PartFigures]]
"""Each process with the names of its room and its own."""


def _counts(parts: Parts) -> Iterator[Metric]:
    pulses = [(room, name, part.pulse) for room, name, part in parts if part.pulse is not None]
    for name, field, meaning in COUNTS:
        family = CounterMetricFamily(f"tritrack_{name}", meaning, labels=("room", "part"))
        for *labels, pulse in pulses:
            family.add_metric(labels, getattr(pulse, field))
        yield family
    rejected = CounterMetricFamily(
        "tritrack_rejected_messages",
        "Messages that no process of the run would say.",
        labels=("room", "part", "cause"),
    )
    for *labels, pulse in pulses:
        for cause in CAUSES:
            rejected.add_metric((*labels, cause), getattr(pulse, cause))
    yield rejected


def _states(parts: Parts, now_s: float) -> Iterator[Metric]:
    names = ("room", "part")
    up = GaugeMetricFamily("tritrack_up", "1 while a process has its place.", labels=names)
    restarts = CounterMetricFamily(
        "tritrack_restarts", "New processes in the place of one that died.", labels=names
    )
    age = GaugeMetricFamily(
        "tritrack_message_age_seconds", "Since a process said anything.", labels=names
    )
    memory = GaugeMetricFamily(
        "tritrack_resident_memory_bytes", "Memory of a process.", labels=names
    )
    recent = GaugeMetricFamily(
        "tritrack_recent_latency_seconds",
        "From capture to the end of a process's work, over its last half minute.",
        labels=(*names, "quantile"),
    )
    for *labels, part in parts:
        up.add_metric(labels, part.there)
        restarts.add_metric(labels, part.restarts)
        if part.heard_s is not None:
            age.add_metric(labels, now_s - part.heard_s)
        if part.pulse is not None:
            memory.add_metric(labels, part.pulse.memory_mb * 1e6)
            recent.add_metric((*labels, "0.5"), part.pulse.latency_p50_ms / 1000.0)
            recent.add_metric((*labels, "0.99"), part.pulse.latency_p99_ms / 1000.0)
    yield from (up, restarts, age, memory, recent)


def _latencies(rooms: Mapping[str, RunFigures]) -> Metric:
    family = HistogramMetricFamily(
        "tritrack_latency_seconds",
        "From capture until a body (integrator) or a posture (recognizer) is heard.",
        labels=("room", "part"),
    )
    ends = [*(str(end_s) for end_s in BUCKETS_S), "+Inf"]
    for room, figures in rooms.items():
        for part, latency in figures.latencies.items():
            buckets = list(zip(ends, accumulate(latency.counts), strict=True))
            family.add_metric((room, part), buckets, latency.sum_s)
    return family


def _people(rooms: Mapping[str, RunFigures]) -> Iterator[Metric]:
    """Of runs that follow several people; nothing where there is none."""
    if not rooms:
        return
    bodies = CounterMetricFamily(
        "tritrack_person_bodies",
        "Bodies of each person by status, of the last 8 people.",
        labels=("room", "person", "status"),
    )
    people = GaugeMetricFamily(
        "tritrack_people", "People with a believed body now.", labels=("room",)
    )
    for room, figures in rooms.items():
        people.add_metric((room,), there(figures))
        for number, person in figures.people.items():
            for status, count in person.bodies.items():
                bodies.add_metric((room, str(number), status), count)
    yield from (bodies, people)


def _bodies(rooms: Mapping[str, RunFigures]) -> Iterator[Metric]:
    bodies = CounterMetricFamily(
        "tritrack_bodies",
        "Bodies by status; measuring and tracking: believed.",
        labels=("room", "status"),
    )
    offset = GaugeMetricFamily(
        "tritrack_view_offset_seconds",
        "By how much the times of view 2 are set back.",
        labels=("room",),
    )
    for room, figures in rooms.items():
        for status, count in figures.bodies.items():
            bodies.add_metric((room, status), count)
        if figures.cameras is not None:
            offset.add_metric((room,), figures.cameras.late_s)
    yield from (bodies, offset)
    agreements = {
        room: figures.body.agreement
        for room, figures in rooms.items()
        if figures.body is not None and figures.body.agreement is not None
    }
    for name, field, scale, meaning in AGREEMENT:
        family = GaugeMetricFamily(f"tritrack_{name}", meaning, labels=("room",))
        for room, agreement in agreements.items():
            family.add_metric((room,), getattr(agreement, field) * scale)
        yield family
