"""LSL: 77 named channels, and an inlet on this machine hears them with the time of the frame."""

import math
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from meeting import a_body, saying
from moving import random_joints

from common.bus.messages import Body, Posture
from runtime.bridges.lsl import CHANNELS, lsl_outlet, marker_outlet, marker_step, sample_of
from runtime.bridges.osc import BridgeError
from tritrack import subscribe

MOST_ADDED_S = 0.005


def test_a_sample_has_a_number_for_every_channel() -> None:
    body = a_body(0, random_joints(3)[0])
    labels = [label for label, _ in CHANNELS]
    assert len(sample_of(body)) == len(labels) == len(set(labels)) == 77
    assert sample_of(body)[labels.index("l_wrist_y_m")] == body.joints_m[5][1]
    assert sample_of(body)[labels.index("l_shoulder_z_deg")] == pytest.approx(180.0)
    empty = Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")
    assert all(math.isnan(value) for value in sample_of(empty))


def test_without_the_library_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    with pytest.raises(BridgeError, match=r"pip install 'tritrack\[lsl\]'"):
        lsl_outlet()


class Element:
    """A part of a stream's description."""

    def __init__(self) -> None:
        self.values: list[tuple[str, str]] = []
        self.children: list[tuple[str, Element]] = []

    def append_child(self, name: str) -> "Element":
        self.children.append((name, Element()))
        return self.children[-1][1]

    def append_child_value(self, name: str, value: str) -> None:
        self.values.append((name, value))


def test_a_stream_names_its_channels_and_each_sample_is_stamped_with_its_frames_moment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A body that was taken 2 s ago, at 500 of LSL's clock, was taken at 498."""
    described, infos, pushed = Element(), list[Any](), list[Any]()

    def info(*told: Any) -> Any:
        infos.append(told)
        return SimpleNamespace(desc=lambda: described)

    library = SimpleNamespace(
        StreamInfo=info,
        StreamOutlet=lambda _: SimpleNamespace(push_sample=lambda *of: pushed.append(of)),
        IRREGULAR_RATE=0.0,
        local_clock=lambda: 500.0,
    )
    monkeypatch.setitem(sys.modules, "pylsl", library)
    body = a_body(0, random_joints(3)[0])
    monkeypatch.setattr("runtime.bridges.lsl.time.monotonic", lambda: body.clock_s + 2.0)
    lsl_outlet("attic")(body)
    assert infos == [("attic", "MoCap", 77, 0.0, "float32", "attic-body")]
    ((name, channels),) = described.children
    assert (name, len(channels.children)) == ("channels", 77)
    assert channels.children[1][0] == "channel"
    assert channels.children[1][1].values == [("label", "pelvis_y_m"), ("unit", "metres")]
    assert channels.children[45][1].values[1] == ("unit", "probability")
    assert channels.children[76][1].values[1] == ("unit", "degrees")
    assert pushed == [(sample_of(body), 498.0)]


def test_a_marker_is_set_where_a_posture_begins_and_where_it_ends() -> None:
    doing, told = "", []
    for frame, now in enumerate(("", "walk", "walk", "squat", "")):
        posture = Posture(frame=frame, captured_s=0.0, clock_s=0.0, name="", doing=now)
        doing, markers = marker_step(doing, posture)
        told.append(markers)
    assert told == [[], ["begin walk"], [], ["end walk", "begin squat"], ["end squat"]]


def test_markers_have_a_stream_of_their_own_and_their_frames_moment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A frame that was taken 2 s ago, at 500 of LSL's clock, was taken at 498."""
    infos, pushed = list[Any](), list[Any]()
    library = SimpleNamespace(
        StreamInfo=lambda *told: infos.append(told),
        StreamOutlet=lambda _: SimpleNamespace(push_sample=lambda *of: pushed.append(of)),
        IRREGULAR_RATE=0.0,
        local_clock=lambda: 500.0,
    )
    monkeypatch.setitem(sys.modules, "pylsl", library)
    monkeypatch.setattr("runtime.bridges.lsl.time.monotonic", lambda: 12.0)
    marker_outlet("attic")("begin walk", 10.0)
    assert infos == [("attic", "Markers", 1, 0.0, "string", "attic-markers")]
    assert pushed == [(["begin walk"], 498.0)]


@pytest.mark.slow
@pytest.mark.live
def test_an_inlet_hears_every_body_with_the_time_of_its_frame() -> None:
    pylsl = pytest.importorskip("pylsl", reason="pip install 'tritrack[lsl]'")
    name = f"tritrack-test-{time.monotonic_ns()}"
    push = lsl_outlet(name)
    streams = pylsl.resolve_byprop("name", name, 1, 10.0)
    if not streams:
        pytest.skip("streams cannot be found on this machine: its network has no multicast")
    inlet = pylsl.StreamInlet(streams[0])
    inlet.open_stream(10.0)
    bodies = [a_body(frame, row) for frame, row in enumerate(random_joints(3))]
    late_s = []
    for body in bodies:
        push(body)
        sample, stamp_s = inlet.pull_sample(5.0)
        late_s.append(pylsl.local_clock() - stamp_s - (time.monotonic() - body.clock_s))
        assert sample == pytest.approx(sample_of(body), abs=1e-4)
    assert max(map(abs, late_s)) < 1e-3


@pytest.mark.slow
@pytest.mark.live
def test_a_bridge_adds_little_to_what_a_subscriber_hears() -> None:
    """Bodies are told apart by when they were taken, which LSL's stamps keep."""
    pylsl = pytest.importorskip("pylsl", reason="pip install 'tritrack[lsl]'")
    heard: dict[float, float] = {}
    arrived: dict[float, float] = {}
    begin, first = threading.Event(), threading.Event()
    with saying(60, begin) as endpoint:
        command = [sys.executable, "-m", "tritrack", "bridge", "lsl", "--endpoint", endpoint]
        bridge = subprocess.Popen(command, cwd=Path(__file__).parents[1])

        def listen() -> None:
            for body in subscribe(endpoint, wait_s=60.0):
                heard[body.clock_s] = time.monotonic()
                first.set()

        plain = threading.Thread(target=listen)
        plain.start()
        streams = pylsl.resolve_byprop("name", "tritrack", 1, 60.0)
        if streams:
            inlet = pylsl.StreamInlet(streams[0])
            inlet.open_stream(10.0)
        while streams and len(arrived) < 50:
            _, stamp_s = inlet.pull_sample(10.0)
            now_s = time.monotonic()
            assert stamp_s is not None, "a body is missing"
            arrived[stamp_s - pylsl.local_clock() + now_s] = now_s
            if first.is_set():
                begin.set()
        begin.set()
        plain.join()
        bridge.wait(60)
    if not streams:
        pytest.skip("streams cannot be found on this machine: its network has no multicast")
    taken_s = np.array(sorted(heard))
    added_s = [
        at_s - heard[taken_s[np.abs(taken_s - clock_s).argmin()]]
        for clock_s, at_s in arrived.items()
    ]
    print(f"lsl: {1e3 * statistics.median(added_s):.2f} ms added")
    assert statistics.median(added_s) < MOST_ADDED_S
