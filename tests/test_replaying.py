"""Replay: recorded reports give the same bodies byte for byte, offline and live."""

import io
import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from crowd_of_two import BLUE, LEFT_M, RED, RIGHT_M, Crowd, of_all, shown
from local_bus import LocalBus
from rich.console import Console
from staging import PERIOD_S, RIG, report

from common.bus.control_messages import Cameras
from common.bus.instant import Instant
from common.bus.message_codec import encode
from common.bus.messages import Body, Message, Posture, View, ViewerNumber
from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from runtime.live.free_ports import free_settings
from runtime.live.session import live
from runtime.offline.batch import Asked, track_all
from runtime.store.other_run import OtherRun, run_of
from runtime.store.past_run import open_run
from runtime.store.recording import Head, Recording, read_recording
from runtime.store.runs import write_run
from tritrack.replaying import _rigs, instants, integrated, replay_on_bus, replay_run, say

pytest.importorskip("mcap", reason="pip install 'tritrack[mcap]'")

QUIET = Console(quiet=True)


@pytest.fixture(scope="module")
def run(recorded_run: Path) -> Path:
    return recorded_run


@pytest.mark.slow
def test_recorded_reports_give_the_same_bodies_byte_for_byte(run: Path, tmp_path: Path) -> None:
    facts = replay_run(run, tmp_path / "again")
    before, again = open_run(run).poses, open_run(tmp_path / "again").poses
    assert facts["same"] == facts["bodies"] == len(before["frame"]) > 0
    assert np.array_equal(before["joints_m"], again["joints_m"], equal_nan=True)


@pytest.mark.slow
def test_what_is_replayed_takes_the_place_of_another_run_only_by_force(
    run: Path, tmp_path: Path
) -> None:
    write_run(tmp_path, [], Settings(), run_of("single", ["dance.avi"]).facts)
    before = (tmp_path / "poses.npz").read_bytes()
    with pytest.raises(OtherRun, match=r"run \(tritrack single of .*dance.avi\): .*--force"):
        replay_run(run, tmp_path)
    with pytest.raises(OtherRun, match="another run"):
        replay_run(run, run)
    assert (tmp_path / "poses.npz").read_bytes() == before
    for force in (True, False):
        replay_run(run, tmp_path, force)
    assert (tmp_path / "poses.npz").read_bytes() != before


@pytest.mark.parametrize("views", [pytest.param((1,), marks=pytest.mark.slow), (2,)])
def test_a_run_of_one_view_comes_back_too(
    clip: Path, tmp_path: Path, views: tuple[ViewerNumber, ...]
) -> None:
    track_all([clip], tmp_path, Asked(views=views, record=True), QUIET)
    facts = replay_run(tmp_path / clip.name, None)
    assert facts["same"] == facts["bodies"] > 0


def test_a_body_whose_reports_were_lost_is_left_out(run: Path) -> None:
    recording = read_recording(run)
    recording.reports[0].pop(3)
    recording.reports[1].pop(3)
    made_of = list(instants(recording))
    assert len(made_of) == len(recording.bodies) - 1
    assert all(bodies[0].captured_s == pair.newest.captured_s for bodies, pair in made_of)


def test_a_body_of_one_view_is_made_of_that_view_again_whatever_came_too_late(run: Path) -> None:
    recording = read_recording(run)
    for n, alone in ((3, (3, -1)), (5, (-1, 5))):
        assert recording.bodies[n].made_of == (n, n)
        recording.bodies[n] = msgspec.structs.replace(recording.bodies[n], made_of=alone)
    made_of = [pair for _, pair in instants(recording)]
    assert made_of[3].views[1] is None
    assert made_of[5].views[0] is None
    assert len(made_of) == len(recording.bodies)


def test_everyone_of_a_run_of_several_comes_back_byte_for_byte() -> None:
    """An empty room, a person, and a second one."""
    crowd, bodies, made_of = Crowd(), list[Body](), list[Instant]()
    first, second = shown(LEFT_M, (0, 0), RED), shown(RIGHT_M, (1, 1), BLUE)
    for people in ([], [first], *[[first, second]] * 8):
        made_of.append(of_all(crowd.n, people))
        bodies += crowd.see(*people)
    reports = tuple([view for pair in made_of if (view := pair.views[n])] for n in (0, 1))
    head = Head(
        name="two people",
        settings=Settings(people="all"),
        period_s=PERIOD_S,
        alone=False,
        rig=RIG,
        body=None,
    )
    again = integrated(Recording(head, reports, bodies, [], []))
    assert {body.person for body in again.bodies} == {0, 1, 2}
    assert [encode(body) for body in again.bodies] == [encode(body) for body in bodies]
    assert again.same == len(bodies)


def test_all_that_was_said_is_said_again_in_its_order(run: Path) -> None:
    recording, bus = read_recording(run), LocalBus()
    few = recording._replace(reports=tuple(each[:9] for each in recording.reports))
    few = few._replace(bodies=recording.bodies[:9])
    reports, bodies, postures = (bus.subscribe(kind) for kind in (View, Body, Posture))
    assert say(few, bus, speed=50.0) == 28
    heard = bodies.drain()
    assert [msgspec.structs.replace(b, clock_s=0.0) for b in heard] == [
        msgspec.structs.replace(b, clock_s=0.0) for b in few.bodies
    ]
    assert [getattr(r, "viewer", 0) for r in reports.drain()] == [1, 2] * 9
    assert postures.drain() == []


def test_the_rig_of_a_recording_is_said_before_the_bodies_that_it_tells(run: Path) -> None:
    """One that was known before the run, which the page waits for, and one that is found later."""
    recording, bus = read_recording(run), InOrder()
    assert recording.head.rig is not None
    before, after = recording.bodies[:4], recording.bodies[4:8]
    after = [msgspec.structs.replace(body, calibration=1) for body in after]
    later = Cameras(rig=recording.head.rig, scale_source="person", calibration=1)
    say(
        recording._replace(reports=([], []), bodies=[*before, *after], cameras=[later]),
        bus,
        speed=50.0,
    )
    told = [type(said).__name__ for said in bus.said if isinstance(said, Cameras | Body)]
    assert told == ["Cameras", *["Body"] * 4, "Cameras", *["Body"] * 4]
    rigs = [said for said in bus.said if isinstance(said, Cameras)]
    assert [rig.scale_source for rig in rigs] == ["calibrated", "person"]


class InOrder(LocalBus):
    """All that is said on it."""

    def __init__(self) -> None:
        super().__init__()
        self.said: list[Message] = []

    def publish(self, message: Message) -> None:
        """Keep it too."""
        self.said.append(message)
        super().publish(message)


@pytest.mark.slow
def test_a_live_run_comes_back_byte_for_byte(clip: Path, tmp_path: Path) -> None:
    """Also what two processes reported, paired by the integrator as they came."""
    slow = tmp_path / clip.name
    shutil.copytree(clip, slow)
    shutil.copy(clip.parent / "calibration.json", slow)
    meta = json.loads((slow / "meta.json").read_text())
    (slow / "meta.json").write_text(json.dumps({**meta, "fps": 5}))
    settings = free_settings(Settings(clip=str(slow), page=PageSettings(port=0)))
    live(settings, tmp_path / "lived", QUIET, record=True)
    facts = replay_run(tmp_path / "lived", None)
    assert facts["same"] == facts["bodies"] == len(open_run(tmp_path / "lived").poses["frame"])


def said_at(viewer: ViewerNumber, frame: int, at_s: float) -> View:
    return report(viewer, frame=frame, captured_s=at_s, clock_s=at_s)


def body_at(at_s: float, made_of: tuple[int, int], calibration: int = 0) -> Body:
    return Body(
        frame=max(made_of),
        captured_s=at_s,
        clock_s=at_s,
        status="empty",
        views="none",
        made_of=made_of,
        calibration=calibration,
    )


def made_up(
    first: list[View], second: list[View], bodies: list[Body], cameras: list[Cameras]
) -> Recording:
    """Ten instants a second."""
    head = Head(
        name="made up",
        settings=Settings(room="attic"),
        period_s=0.1,
        alone=False,
        rig=None,
        body=None,
    )
    return Recording(head, (first, second), bodies, [], cameras)


def test_a_viewer_that_counts_anew_is_told_apart_by_the_moment() -> None:
    """Half a period off at most, the last of those that are near; view 2's times are set back by
    what the rig of that body tells."""
    first = [said_at(1, 3, 0.3), said_at(1, 3, 5.3), said_at(1, 4, 5.451)]
    second = [said_at(2, 7, 5.8), said_at(2, 7, 5.3)]
    late = Cameras(rig=RIG, scale_source="person", calibration=2, late_s=0.5)
    bodies = [
        body_at(0.3, (3, -1)),
        body_at(5.34, (3, -1)),
        body_at(5.3, (3, 7), calibration=2),
        body_at(5.3, (3, 7)),
        body_at(5.4, (4, -1)),
        body_at(9.0, (-1, -1)),
        body_at(5.3, (3, 8)),
    ]
    found = [*instants(made_up(first, second, bodies, [late]))]
    assert [people for people, _ in found] == [[body] for body in bodies[:4]]
    assert [instant.views[0] for _, instant in found] == [first[0], first[1], first[1], first[1]]
    set_back, as_it_was = found[2][1].views[1], found[3][1].views[1]
    assert set_back is not None
    assert set_back.captured_s == pytest.approx(5.3)
    assert set_back.clock_s == 5.8
    assert as_it_was == second[1]


def test_messages_are_said_at_their_pace_with_the_clock_of_now(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Twice as fast: what was said 0.3 s after the first is said after 0.15 s."""
    waits: list[float] = []
    monkeypatch.setattr("tritrack.replaying.time.monotonic", lambda: 100.0)
    monkeypatch.setattr("tritrack.replaying.wait_until", lambda at_s, _: waits.append(at_s))
    recording = made_up(
        [said_at(1, 0, 7.0), said_at(1, 1, 7.3)], [said_at(2, 0, 7.1)], [body_at(7.1, (0, 0))], []
    )
    bus = InOrder()
    assert say(recording, bus, 2.0) == 4
    assert waits == pytest.approx([100.0, 100.05, 100.05, 100.15])
    assert [type(one).__name__ for one in bus.said] == ["View", "View", "Body", "View"]
    assert [getattr(one, "clock_s", None) for one in bus.said] == [100.0] * 4
    assert [getattr(one, "captured_s", None) for one in bus.said] == [7.0, 7.1, 7.1, 7.3]
    assert say(made_up([], [], [], []), bus, 2.0) == 0


def test_a_run_is_said_as_its_integrator_to_those_who_come_in_a_second(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    recording = made_up([said_at(1, 0, 7.0)], [], [body_at(7.0, (0, -1))], [])
    bus, opened, slept = InOrder(), list[Any](), list[float]()
    watched = bus.watch_alive()

    @contextmanager
    def hub(*given: Any) -> Iterator[InOrder]:
        opened.append(given)
        yield bus

    monkeypatch.setattr("tritrack.replaying.read_recording", lambda _: recording)
    monkeypatch.setattr("tritrack.replaying.open_hub", hub)
    monkeypatch.setattr("tritrack.replaying.time.sleep", slept.append)
    console = Console(file=io.StringIO(), width=200)
    settings = BusSettings(endpoint="tcp/127.0.0.1:7447")
    told = replay_on_bus(tmp_path, settings, 2.0, console)
    assert told == {"clip": "made up", "said": 2}
    assert opened == [(settings, "attic")]
    assert slept == [1.0, 1.0]
    assert [alive.name for alive in watched.drain()] == ["integrator"]
    assert isinstance(console.file, io.StringIO)
    assert console.file.getvalue() == "made up: room attic at tcp/127.0.0.1:7447\n"
    rig = Cameras(rig=RIG, scale_source="person")
    bus.publish(rig)
    assert bus.latest(Cameras, 0.0) == rig, "who comes later asks for it"


def test_the_rig_that_was_known_before_is_said_first_unless_the_run_said_it() -> None:
    empty = made_up([], [], [], [])
    head = msgspec.structs.replace(empty.head, rig=RIG, scale_source="person")
    own = Cameras(rig=RIG, scale_source="calibrated", calibration=0)
    later = Cameras(rig=RIG, scale_source="person", calibration=1)
    known = empty._replace(head=head, cameras=[later])
    assert _rigs(known) == [Cameras(rig=RIG, scale_source="person"), later]
    assert _rigs(known._replace(cameras=[own, later])) == [own, later]
    assert _rigs(empty._replace(cameras=[later])) == [later]
