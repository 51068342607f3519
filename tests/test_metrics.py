"""The metrics, read by Prometheus's own parser."""

from collections.abc import Iterable

import msgspec
import pytest

pytest.importorskip("prometheus_client", reason="pip install 'tritrack[metrics]'")

from metrics_reader import Samples, read
from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import Metric
from prometheus_client.registry import Collector
from show_page import RIG

from common.bus.control_messages import Cameras, Pulse
from common.bus.inbox import Alive
from common.bus.messages import Agreement, Body, Posture
from common.rig.camera import Rig
from runtime.outside.metrics import families
from runtime.outside.run_figures import RunFigures, Told, step

PULSE = Pulse(
    process="viewer 1",
    state="running",
    frames=30,
    deadline_misses=2,
    dropped=3,
    guide_misses=1,
    foreign=5,
    late=4,
    latency_p50_ms=12.5,
    latency_p99_ms=40.0,
    memory_mb=150.0,
)
BODY = Body(
    frame=1,
    captured_s=0.0,
    clock_s=9.98,
    status="tracking",
    views="both",
    agreement=Agreement(apart_mm=31.0, soles_mm=12.0, facing_deg=4.0, motion_mm=9.0, believed=0.9),
)
SAID: tuple[Told, ...] = (
    Alive("viewer 1", True),
    PULSE,
    BODY,
    Posture(frame=1, captured_s=0.0, clock_s=9.7, name=""),
    Cameras(rig=RIG, scale_source="person", late_s=0.066),
)


def told(said: Iterable[Told]) -> Samples:
    figures = RunFigures()
    for one in said:
        figures = step(figures, one, 10.0)

    class Figures(Collector):  # type: ignore[misc,unused-ignore]
        def collect(self) -> Iterable[Metric]:
            return families({"hall": figures}, 12.5)

    registry = CollectorRegistry()
    registry.register(Figures())
    return read(generate_latest(registry).decode())


def test_a_pulse_is_counters_and_gauges_in_base_units() -> None:
    found = told(SAID)
    viewer = {"part": "viewer 1"}
    assert found.value("tritrack_frames_total", **viewer) == 30
    assert found.value("tritrack_missed_deadlines_total", **viewer) == 2
    assert found.value("tritrack_dropped_messages_total", **viewer) == 3
    assert found.value("tritrack_late_messages_total", **viewer) == 4
    assert found.value("tritrack_missed_guides_total", **viewer) == 1
    assert found.value("tritrack_rejected_messages_total", **viewer, cause="foreign") == 5
    assert found.value("tritrack_rejected_messages_total", **viewer, cause="malformed") == 0
    assert found.value("tritrack_resident_memory_bytes", **viewer) == 150e6
    assert found.value("tritrack_recent_latency_seconds", **viewer, quantile="0.99") == 0.04
    assert found.value("tritrack_up", **viewer) == 1
    assert found.value("tritrack_restarts_total", **viewer) == 0
    assert found.value("tritrack_message_age_seconds", **viewer) == 2.5


def test_latencies_are_histograms() -> None:
    found = told(SAID)
    buckets = found.by("le", "tritrack_latency_seconds_bucket", part="integrator")
    assert buckets["0.015"] == 0
    assert buckets["0.03"] == buckets["+Inf"] == 1
    assert found.value("tritrack_latency_seconds_sum", part="recognizer") == pytest.approx(0.3)
    assert found.value("tritrack_latency_seconds_count", part="recognizer") == 1


def test_the_rig_is_told_in_metres_degrees_and_seconds() -> None:
    found = told(SAID)
    assert found.value("tritrack_bodies_total", status="tracking") == 1
    assert found.value("tritrack_rig_apart_meters") == pytest.approx(0.031)
    assert found.value("tritrack_rig_soles_meters") == pytest.approx(0.012)
    assert found.value("tritrack_rig_facing_degrees") == 4.0
    assert found.value("tritrack_rig_believed_ratio") == 0.9
    assert found.value("tritrack_view_offset_seconds") == 0.066


def test_each_viewers_camera_is_named() -> None:
    found = told([Cameras(rig=named_rig("door", "window"), scale_source="person")])
    assert [labels for name, labels, _ in found.samples if name == "tritrack_camera_info"] == [
        {"room": "hall", "part": "viewer 1", "camera": "door"},
        {"room": "hall", "part": "viewer 2", "camera": "window"},
    ]


def named_rig(*names: str) -> Rig:
    cameras = tuple(
        msgspec.structs.replace(one, name=name)
        for one, name in zip(RIG.cameras, names, strict=True)
    )
    return msgspec.structs.replace(RIG, cameras=cameras)


def test_every_sample_names_its_room_and_ends_in_its_unit() -> None:
    found = told(SAID)
    assert {labels["room"] for _, labels, _ in found.samples} == {"hall"}
    ends = ("_total", "_seconds", "_bytes", "_meters", "_degrees", "_ratio", "_up", "_info")
    assert [name for name in found.families if not f"{name}".endswith(ends)] == [
        "tritrack_frames",
        "tritrack_missed_deadlines",
        "tritrack_dropped_messages",
        "tritrack_late_messages",
        "tritrack_missed_guides",
        "tritrack_hurried_frames",
        "tritrack_in_turn_frames",
        "tritrack_rejected_messages",
        "tritrack_restarts",
        "tritrack_bodies",
    ], "the parser takes _total off counters"


def test_a_run_of_which_nothing_was_heard_has_no_samples() -> None:
    assert told([]).samples == []


def test_each_of_several_people_has_bodies_of_their_own_and_who_is_there_is_counted() -> None:
    """A run that follows one person has neither; who was not believed for half a second is gone."""
    bodies = [
        msgspec.structs.replace(BODY, person=person, captured_s=captured_s, status=status)
        for person, captured_s, status in (
            (1, 0.0, "tracking"),
            (2, 0.0, "measuring"),
            (1, 0.4, "tracking"),
            (2, 0.4, "lost"),
            (1, 0.6, "tracking"),
        )
    ]
    found = told(bodies)
    assert found.value("tritrack_person_bodies_total", person="1", status="tracking") == 3
    assert found.value("tritrack_person_bodies_total", person="2", status="lost") == 1
    assert found.value("tritrack_bodies_total", status="tracking") == 3, "of all people"
    assert found.value("tritrack_people") == 1
    assert told(bodies[:4]).value("tritrack_people") == 2
    assert not {"tritrack_people", "tritrack_person_bodies"} & set(told(SAID).families)
