"""How a site is doing: many pulses as one, and one line."""

from typing import Any

from common.bus.control_messages import Pulse
from runtime.serving.site_status import site_pulse, status_of

HUB = Pulse(
    process="integrator",
    state="running",
    frames=450,
    fps=15.0,
    latency_p99_ms=21.4,
    memory_mb=200.0,
    deadline_misses=1,
)
VIEWER = Pulse(process="viewer 2", state="running", deadline_misses=2, memory_mb=150.0, foreign=3)


def test_a_site_is_the_sum_of_its_processes_at_the_integrators_pace() -> None:
    pulse = site_pulse("hall", {"integrator": HUB, "viewer 2": VIEWER}, 60.0)
    assert (pulse.process, pulse.state, pulse.frames, pulse.fps) == ("hall", "running", 450, 15.0)
    assert (pulse.deadline_misses, pulse.foreign, pulse.memory_mb) == (3, 3, 410.0)
    assert status_of("hall", pulse, "") == (
        True,
        "hall: running, 15.0 frames a second, p99 21 ms, 3 missed, 410 MB",
    )


def test_a_site_without_one_of_its_processes_is_not_well() -> None:
    dead = Pulse(process="viewer 2", state="restarting")
    status = status_of("hall", site_pulse("hall", {"integrator": HUB, "viewer 2": dead}, 0.0), "")
    assert not status.well
    assert status.line.startswith("hall: running (viewer 2: restarting), 15.0 frames")


def test_a_site_whose_integrator_is_started_again_still_works() -> None:
    """Else what supervises it would take it for one that never came up."""
    again = Pulse(process="integrator", state="restarting", frames=450)
    assert site_pulse("hall", {"integrator": again}, 0.0).state == "running"


def test_a_site_that_is_down_says_why_and_one_that_was_not_heard_starts() -> None:
    assert status_of("hall", None, "no clip") == (False, "hall: down: no clip")
    assert status_of("hall", None, "") == (False, "hall: starting")
    assert site_pulse("hall", {}, 0.0).state == "starting"
    assert not status_of("hall", site_pulse("hall", {}, 0.0), "").well


def test_counts_are_summed_and_rates_are_the_integrators() -> None:
    """Every count has its own numbers: 1 and 10, 2 and 20 and so on."""
    counts = ("deadline_misses", "dropped", "guide_misses", "hurried", "late", "malformed")
    names = (*counts, "foreign")
    ones: dict[str, Any] = {name: n for n, name in enumerate(names, 1)}
    tens: dict[str, Any] = {name: 10 * n for n, name in enumerate(names, 1)}
    hub = Pulse(
        process="integrator",
        state="ready",
        frames=7,
        fps=14.5,
        latency_p50_ms=3.5,
        latency_p99_ms=9.5,
        memory_mb=100.0,
        **ones,
    )
    viewer = Pulse(
        process="viewer 1",
        state="given up",
        frames=900,
        fps=30.0,
        latency_p50_ms=50.0,
        latency_p99_ms=60.0,
        memory_mb=20.0,
        **tens,
    )
    lame = Pulse(process="metrics", state="restarting")
    pulses = {"viewer 1": viewer, "integrator": hub, "metrics": lame}
    pulse = site_pulse("hall", pulses, 3.0)
    assert [getattr(pulse, name) for name in names] == [11 * n for n in range(1, 8)]
    assert (pulse.state, pulse.frames, pulse.fps) == ("ready", 7, 14.5)
    assert (pulse.latency_p50_ms, pulse.latency_p99_ms, pulse.memory_mb) == (3.5, 9.5, 123.0)
    assert pulse.detail == "viewer 1: given up; metrics: restarting"
    assert status_of("hall", pulse, "").line == (
        "hall: ready (viewer 1: given up; metrics: restarting), 14.5 frames a second, "
        "p99 10 ms, 11 missed, 123 MB"
    )
    nobody = site_pulse("hall", {"viewer 1": viewer}, 3.0)
    assert (nobody.frames, nobody.fps, nobody.latency_p50_ms, nobody.latency_p99_ms) == (0,) * 4
    ended = Pulse(process="integrator", state="ended")
    assert site_pulse("hall", {"integrator": ended}, 0.0).state == "ended"
    assert status_of("hall", ended, "").well
    assert not status_of("hall", Pulse(process="integrator", state="starting"), "").well


def test_what_is_lame_is_told_as_far_as_a_message_has_room() -> None:
    many = {f"part {n}": Pulse(process=f"part {n}", state="given up") for n in range(99)}
    assert len(site_pulse("hall", many, 0.0).detail) == 400
