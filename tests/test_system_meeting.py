"""How the processes of a run meet: guides in time, one start for all, news for who comes late."""

import socket
import threading
import time
from collections.abc import Callable
from multiprocessing import Pipe

import numpy as np
import pytest
from local_bus import LocalBus
from staging import report
from waiting import until

from animator import __main__ as animator
from common.bus.bus import open_client, open_hub
from common.bus.control_messages import Cameras, ClockAnswer, ClockQuestion, Ended, Pulse
from common.bus.inbox import BOUND
from common.bus.messages import Body, Guide, Message
from common.bus.process import ProcessContext
from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from common.method import DEFAULT
from common.rig.camera import paper_rig
from common.video.clip_facts import ClipView
from common.video.pictures import DecoderDied
from integrator import __main__ as integrator
from integrator import merge_state
from integrator.hearing import run_start
from runtime.live.free_ports import free_settings
from runtime.live.launch import Subscriber, nothing_heard
from viewer import __main__ as viewer
from viewer import track
from viewer.background.background import learn
from viewer.guides import Guides

RIG = paper_rig((160, 120), (200.0, 200.0), (4.5, 4.5))


def guide(first: int, second: int) -> Guide:
    return Guide(frame=first, captured_s=0.0, clock_s=0.0, frames=(first, second))


class Clock:
    """Time that passes only when somebody waits."""

    def __init__(self, patch: pytest.MonkeyPatch, *modules: str) -> None:
        self.now_s = 1000.0
        for module in modules:
            patch.setattr(f"{module}.time.monotonic", lambda: self.now_s)

    def wait(self, seconds: float = 0.0) -> None:
        self.now_s += seconds


class SlowInbox:
    """Guides that come at given moments of a clock."""

    def __init__(self, clock: Clock, coming: list[tuple[float, Guide]]) -> None:
        self._clock, self._coming = clock, coming

    def take(self, timeout_s: float) -> Guide | None:
        until_s = self._clock.now_s + timeout_s
        if self._coming and self._coming[0][0] <= until_s:
            moment_s, message = self._coming.pop(0)
            self._clock.now_s = max(self._clock.now_s, moment_s)
            return message
        self._clock.now_s = until_s
        return None


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch, "viewer.__main__")


def guides_of(clock: Clock, number: int, *coming: tuple[float, Guide]) -> Guides:
    later = [(1000.0 + after_s, message) for after_s, message in coming]
    return Guides(SlowInbox(clock, later), number)  # type: ignore[arg-type]


def test_report_t_uses_the_guide_that_has_heard_of_t_minus_1(clock: Clock) -> None:
    """Design, section 2: older guides are passed over while the right one is on its way."""
    guides = guides_of(clock, 2, (0.0, guide(3, 3)), (0.01, guide(4, 3)), (0.02, guide(4, 4)))
    assert guides.of_frame(4, wait_s=0.033) == guide(4, 4)
    assert guides.misses == 0
    assert clock.now_s == pytest.approx(1000.02)


def test_it_waits_no_longer_than_it_may_and_counts_a_miss(clock: Clock) -> None:
    guides = guides_of(clock, 1, (0.0, guide(3, 3)), (0.05, guide(4, 4)))
    assert guides.of_frame(4, wait_s=0.033) == guide(3, 3)
    assert guides.misses == 1
    assert clock.now_s == pytest.approx(1000.033)
    assert guides.of_frame(4, wait_s=0.033) == guide(4, 4)
    assert guides.misses == 1


def test_the_first_frame_needs_no_guide(clock: Clock) -> None:
    guides = guides_of(clock, 1)
    assert guides.of_frame(-1, wait_s=0.033) is None
    assert (guides.misses, clock.now_s) == (0, 1000.0)


def test_a_guide_that_is_ahead_is_as_good(clock: Clock) -> None:
    """After frames that this viewer dropped, the room may know of a later one."""
    guides = guides_of(clock, 1, (0.0, guide(9, 9)))
    assert guides.of_frame(7, wait_s=0.033) == guide(9, 9)
    assert guides.of_frame(8, wait_s=0.033) == guide(9, 9)
    assert guides.misses == 0


def question(number: int, ready: bool = True) -> ClockQuestion:
    return ClockQuestion(viewer=number, ready=ready)


def test_the_start_is_fixed_once_when_every_viewer_is_ready(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = Clock(monkeypatch, "integrator.hearing.run_start")
    starter = run_start.Starter(frozenset((1, 2)))
    assert starter.answer(question(1)) == ClockAnswer(now_s=1000.0, start_s=None)
    now.wait(1.0)
    assert starter.answer(question(2, ready=False)).start_s is None
    now.wait(1.0)
    fixed_s = starter.answer(question(2)).start_s
    assert fixed_s == 1002.0 + run_start.LEAD_S
    now.wait(5.0)
    for number in (1, 2):
        assert starter.answer(question(number)) == ClockAnswer(now_s=1007.0, start_s=fixed_s)


def test_who_only_asks_for_the_time_begins_no_run(monkeypatch: pytest.MonkeyPatch) -> None:
    Clock(monkeypatch, "integrator.hearing.run_start")
    starter = run_start.Starter(frozenset((1,)))
    for only_time in (ClockQuestion(), ClockQuestion(ready=True)):
        assert starter.answer(only_time) == ClockAnswer(now_s=1000.0, start_s=None)
    assert starter.answer(question(1)).start_s is not None


def test_a_clip_waits_for_who_looks_at_its_page_but_not_for_ever(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = Clock(monkeypatch, "integrator.hearing.run_start")
    starters = [run_start.Starter(frozenset((1,)), wait_s=30.0) for _ in range(2)]
    assert [each.answer(question(1)).start_s for each in starters] == [None, None]
    now.wait(3.0)
    starters[0].looked_at()
    started = [each.answer(question(1)).start_s for each in starters]
    assert started == [1003.0 + run_start.LEAD_S, None]
    now.wait(27.0)
    assert starters[1].answer(question(1)).start_s == 1030.0 + run_start.LEAD_S


def test_a_run_that_began_before_keeps_its_start_and_waits_for_nobody() -> None:
    """All of its processes were started again: a recorded clip goes on where it would be."""
    starter = run_start.Starter(frozenset((1, 2)), wait_s=30.0, start_s=990.0)
    assert starter.answer(question(1)).start_s == 990.0
    starter.begun(report(2, captured_s=3.0, clock_s=1003.0))
    assert starter.start_s == 990.0


def test_a_run_with_one_viewer_waits_for_no_other() -> None:
    assert run_start.Starter(frozenset((2,))).answer(question(2)).start_s is not None


class Talkative(LocalBus):
    """A room in which viewer 1 says everything at once, as soon as the integrator is ready."""

    def publish(self, message: Message) -> None:
        super().publish(message)
        if isinstance(message, Pulse) and message.state == "ready":
            for frame in range(BOUND + 6):
                super().publish(report(1, frame=frame, captured_s=frame / 15))
            super().publish(Ended(viewer=1, frames=BOUND + 6))


def test_what_was_lost_is_told_to_the_end() -> None:
    """Six reports too many for the inbox: the last pulse still counts them."""
    bus = Talkative()
    pulses, bodies = bus.subscribe(Pulse), bus.subscribe(Body)
    state = merge_state.init(RIG, 1 / 15, Settings(), DEFAULT)
    integrator.run(state, (1,), bus, threading.Event())
    last = pulses.drain()[-1]
    assert (last.state, last.frames, last.dropped) == ("ended", BOUND, 6)
    assert bodies.drain()[-1].frame == BOUND + 5


class BrokenFilm:
    """Frames of a view whose decoder breaks on the first."""

    over, offset_s, dropped, came, odd = False, 0.0, 0, 0, ()

    def take(self, _timeout_s: float) -> None:
        raise DecoderDied("cam1.avi", 0, "killed by SIGABRT")


def test_nobody_waits_for_a_viewer_whose_video_broke() -> None:
    bus = LocalBus()
    ended = bus.subscribe(Ended)
    view = ClipView(1, "cam1.avi", (160, 120), (160, 120), fps=15.0, frames=10)
    setup = track.Setup(1, None, Settings(), DEFAULT)
    state = track.init(setup, learn([np.zeros((120, 160, 3), np.uint8)]))
    prepared = viewer.Prepared(view, state)
    with pytest.raises(DecoderDied):
        viewer.run(prepared, BrokenFilm(), bus, threading.Event())  # type: ignore[arg-type]
    (said,) = ended.drain()
    assert (said.viewer, said.frames) == (1, 0)
    assert "cam1.avi broke the decoder" in said.why


def test_the_supervisor_learns_the_cameras_that_were_told_before_it_listened() -> None:
    bus, heard = LocalBus(), nothing_heard()
    bus.keep(Cameras)
    bus.publish(Cameras(rig=RIG, scale_source="calibrated"))
    Subscriber(bus, heard).catch_up()
    assert [told.scale_source for told in heard.cameras] == ["calibrated"]


def test_viewers_agree_on_a_start_by_a_clock_that_is_not_theirs() -> None:
    """The room's clock is 50 s ahead; a viewer learns that and the start from the answers."""
    bus = LocalBus()
    bus.answer(
        ClockQuestion, lambda _: ClockAnswer(now_s=time.monotonic() + 50.0, start_s=1_000_000.0)
    )
    met = viewer.met(bus, 1, threading.Event())
    assert met is not None
    assert met.start_s == 1_000_000.0
    assert met.offset_s == pytest.approx(50.0, abs=0.01)


def test_a_start_that_never_comes_names_the_other_viewer(monkeypatch: pytest.MonkeyPatch) -> None:
    bus = LocalBus()
    bus.answer(ClockQuestion, lambda _: ClockAnswer(now_s=0.0, start_s=None))
    monkeypatch.setattr(viewer, "BEGIN_S", 0.1)
    with pytest.raises(viewer.StartError, match=r"viewer 1 is ready, .*start the other viewer"):
        viewer.met(bus, 1, threading.Event())


def test_a_viewer_that_is_stopped_while_it_waits_just_ends() -> None:
    stop = threading.Event()
    stop.set()
    assert viewer.met(LocalBus(), 1, stop) is None


@pytest.fixture
def settings() -> BusSettings:
    return free_settings(Settings(page=PageSettings(port=0))).bus


def soon(look: Callable[[], object]) -> object:
    """What `look` finds within five seconds."""
    until_s = time.monotonic() + 5.0
    while time.monotonic() < until_s:
        found = look()
        if found is not None:
            return found
        time.sleep(0.02)
    return None


@pytest.mark.parametrize(
    "message",
    [guide(7, 8), Cameras(rig=RIG, scale_source="assumed")],
    ids=["Guide", "Cameras"],
)
def test_who_comes_late_gets_the_newest(settings: BusSettings, message: Message) -> None:
    """A recognizer or an animator started in the middle (design, section 2), over real sessions."""
    with open_hub(settings, "room") as hub:
        hub.keep(type(message))
        hub.publish(message)
        with open_client(settings, "room", 5.0) as late:
            assert soon(lambda: late.latest(type(message), 1.0)) == message


def is_open(port: int) -> bool:
    with socket.socket() as door:
        return door.connect_ex(("127.0.0.1", port)) == 0


def test_a_page_waits_for_its_run_as_long_as_that_compiles(monkeypatch: pytest.MonkeyPatch) -> None:
    """A first run begins after minutes: its supervisor ends the page, no span of time does."""
    for name, value in (("READY_S", 0.0), ("warm_up", lambda: None)):
        monkeypatch.setattr(animator, name, value)
    settings, stop = free_settings(Settings()), threading.Event()
    context, (ending, ours) = ProcessContext(supervised=True, stop=stop), Pipe(duplex=False)
    page = threading.Thread(target=animator.main, args=(settings, context, "a run", ending))
    page.start()
    try:
        assert until(lambda: is_open(settings.page.port))
        time.sleep(1.0)
        assert page.is_alive()
        with open_hub(settings.bus, settings.room) as hub:
            pulse = hub.subscribe(Pulse).take(10.0)
            assert pulse is not None
            assert (pulse.process, pulse.state) == ("animator", "ready")
            ours.send({})
            page.join(10.0)
    finally:
        stop.set()
        page.join(10.0)
    assert not page.is_alive()
