"""The bus, live over real sessions on the loopback and local in one process."""

import json
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple, cast

import msgspec
import pytest
import zenoh
from local_bus import LocalBus
from meeting import free_endpoint

from common.body.observation import Box, Observation
from common.bus import bus as bus_module
from common.bus.bus import Bus, BusError, Stopped, open_client, open_hub, unanswered
from common.bus.bus_access import access_of
from common.bus.control_messages import ClockAnswer, ClockQuestion, Pulse
from common.bus.inbox import BOUND, Alive, Inbox
from common.bus.mailbox import Mailbox
from common.bus.message_codec import MAX_BYTES, encode
from common.bus.messages import Guide, Picture, Posture, View
from common.config.part_settings import BusSettings, SettingsError

ROOM = "hall"
BLOCK = zenoh.CongestionControl.BLOCK
SOON_S = 5.0
"""Patience with the network: a test that passes takes milliseconds of it."""


class Place(NamedTuple):
    settings: BusSettings
    hub: Bus


def a_guide(frame: int) -> Guide:
    return Guide(frame=frame, captured_s=frame / 15, clock_s=0.0, frames=(frame, frame))


def a_report(viewer: int, frame: int, upper_body_px: float = 0.0) -> View:
    box = Box(left=1, right=5, top=0, bottom=1)
    person = Observation(
        width=8,
        height=2,
        silhouette=b"\x3e\x3e",
        box=box,
        area_px=10,
        upper_body_px=upper_body_px,
    )
    return View(
        frame=frame,
        captured_s=frame / 15,
        clock_s=0.0,
        viewer=viewer,
        width=8,
        height=2,
        people=(person,),
    )


@pytest.fixture
def endpoint() -> str:
    return free_endpoint()


@pytest.fixture
def place(endpoint: str) -> Iterator[Place]:
    settings = BusSettings(endpoint)
    with open_hub(settings, ROOM) as hub:
        yield Place(settings, hub)


def client(place: Place, doors: ExitStack) -> Bus:
    return doors.enter_context(open_client(place.settings, ROOM, SOON_S))


def foreigner(place: Place) -> zenoh.Session:
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{place.settings.endpoint}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def once_heard(inbox: Inbox[Pulse], speaker: Bus) -> None:
    """Return when the speaker's messages reach the inbox: declarations travel too."""
    deadline = time.monotonic() + SOON_S
    while time.monotonic() < deadline:
        speaker.publish(Pulse(process="probe", state="ready"))
        if inbox.take(0.05) is not None:
            time.sleep(0.05)
            inbox.drain()
            return
    pytest.fail("nothing arrived")


def test_two_viewers_an_integrator_and_a_recognizer_hear_each_other(place: Place) -> None:
    """D2: clients speak to each other through the hub, which peers would not relay."""
    with ExitStack() as doors:
        first, second, recognizer = (client(place, doors) for _ in range(3))
        reports = place.hub.subscribe(View)
        pulses = [bus.subscribe(Pulse) for bus in (place.hub, recognizer)]
        guides = [bus.subscribe(Guide) for bus in (first, second)]
        postures = second.subscribe(Posture)
        for speaker in (first, second):
            for inbox in pulses:
                once_heard(inbox, speaker)
        for frame in range(3):
            first.publish(a_report(1, frame))
            second.publish(a_report(2, frame))
        heard = [reports.take(SOON_S) for _ in range(6)]
        assert sorted((r.viewer, r.frame) for r in heard if r) == [
            (viewer, frame) for viewer in (1, 2) for frame in range(3)
        ]
        place.hub.publish(a_guide(7))
        assert [inbox.take(SOON_S) for inbox in guides] == [a_guide(7)] * 2
        said = Posture(frame=3, captured_s=0.2, clock_s=9.0, name="squat")
        recognizer.publish(said)
        assert postures.take(SOON_S) == said


def test_who_comes_late_gets_the_newest_guide(place: Place) -> None:
    place.hub.keep(Guide)
    with ExitStack() as doors:
        early = client(place, doors)
        assert early.latest(Guide, SOON_S) is None
        for frame in (1, 2, 3):
            place.hub.publish(a_guide(frame))
        assert client(place, doors).latest(Guide, SOON_S) == a_guide(3)


def test_a_room_does_not_hear_another(place: Place) -> None:
    with open_client(place.settings, "cellar", SOON_S) as cellar, ExitStack() as doors:
        own, others = cellar.subscribe(Pulse), client(place, doors).subscribe(Pulse)
        once_heard(own, cellar)
        assert others.take(0.1) is None


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xc1 no message",
        b"\x91" * 5000,
        encode(a_report(1, 4))[:-3],
        encode(a_report(1, 4, 2.0)).replace(
            b"\xadupper_body_px\xcb\x40" + bytes(7), b"\xadupper_body_px\xcb\x7f\xf8" + bytes(6)
        ),
        encode(msgspec.structs.replace(a_report(1, 4), protocol=99)),
        encode(a_report(2, 4)),
        bytes(MAX_BYTES + 1),
    ],
    ids=["empty", "garbage", "nested", "cut off", "NaN", "foreign", "another's key", "too long"],
)
def test_a_malformed_message_is_counted_logged_once_and_the_next_good_one_arrives(
    place: Place, payload: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    assert payload != encode(a_report(1, 4))
    inbox = place.hub.subscribe(View)
    with foreigner(place) as stranger:
        for said in (payload, payload, encode(a_report(1, 5))):
            # A megabyte that waits for room for a millisecond only is dropped on a busy machine.
            stranger.put(f"tritrack/{ROOM}/viewer/1/report", said, congestion_control=BLOCK)
        assert inbox.take(SOON_S) == a_report(1, 5)
    assert (inbox.malformed, len(caplog.records)) == (2, 1)
    assert f"tritrack/{ROOM}/viewer/*/report" in caplog.text


def test_a_reader_that_sleeps_keeps_the_latest_and_counts_the_rest(place: Place) -> None:
    """Every report counts, so the queue is bounded and what it loses is not lost in silence."""
    spoken = BOUND + 20
    with ExitStack() as doors:
        speaker = client(place, doors)
        pulses, inbox = place.hub.subscribe(Pulse), place.hub.subscribe(View)
        once_heard(pulses, speaker)
        for frame in range(spoken):
            speaker.publish(a_report(1, frame))
            time.sleep(0.005)  # all at once would overflow the speaker's own queue first
        speaker.publish(Pulse(process="probe", state="ended"))
        assert pulses.take(SOON_S) is not None
        deadline = time.monotonic() + SOON_S
        while inbox.dropped < spoken - BOUND and time.monotonic() < deadline:
            time.sleep(0.01)
        assert inbox.dropped == spoken - BOUND
        assert [report.frame for report in inbox.drain()] == list(range(spoken - BOUND, spoken))


def test_what_is_lost_on_the_way_is_counted_by_who_should_have_heard_it(place: Place) -> None:
    """Messages are numbered; a speaker who is started again begins with the first."""
    key, inbox = f"tritrack/{ROOM}/viewer/1/report", place.hub.subscribe(View)
    with ExitStack() as doors:
        session = doors.enter_context(foreigner(place))
        heard = session.declare_subscriber(key)
        session.put(key, encode(a_report(1, 0)))
        assert inbox.take(SOON_S) is not None  # so the hub knows of the subscriber too
        heard.recv()
        for frame in range(3):
            place.hub.publish(a_report(1, frame))
        numbers: list[int] = []
        end = time.monotonic() + SOON_S
        while len(numbers) < 3 and time.monotonic() < end:
            sample = heard.try_recv()
            if sample is None:
                time.sleep(0.01)
            else:
                assert sample.attachment is not None
                numbers.append(int.from_bytes(sample.attachment.to_bytes(), "big"))
        assert numbers == [1, 2, 3]
        for number in (4, 7, 8, 1, 2, 5, 2**64 - 1):
            told, word = encode(a_report(1, number % 9)), number.to_bytes(8, "big")
            session.put(key, told, attachment=word, congestion_control=BLOCK)
        last = encode(a_report(1, 9))
        session.put(key, last, attachment=b"none of ours", congestion_control=BLOCK)
        heard_there = [inbox.take(SOON_S) for _ in range(11)]
    frames = [message.frame for message in heard_there if message]
    assert frames == [0, 1, 2, 4, 7, 8, 1, 2, 5, 6, 9]
    assert (inbox.dropped, inbox.malformed) == (4, 0)


def test_of_guides_a_slow_reader_gets_the_newest_alone(place: Place) -> None:
    with ExitStack() as doors:
        reader = client(place, doors)
        inbox, pulses = reader.subscribe(Guide), reader.subscribe(Pulse)
        once_heard(pulses, place.hub)
        for frame in range(200):
            place.hub.publish(a_guide(frame))
        deadline = time.monotonic() + SOON_S
        heard = [inbox.take(SOON_S)]
        while heard[-1] != a_guide(199) and time.monotonic() < deadline:
            time.sleep(0.02)
            heard.extend(inbox.drain())
        assert heard[-1] == a_guide(199)
        assert inbox.drain() == []


def test_the_newest_of_one_viewer_does_not_hide_the_others() -> None:
    bus = LocalBus(ROOM)
    inbox = bus.subscribe(Picture)
    for frame in range(3):
        for viewer in (1, 2):
            moment = {"frame": frame, "captured_s": 0.0, "clock_s": 0.0}
            bus.publish(msgspec.convert({"viewer": viewer, "jpeg": b"", **moment}, Picture))
    assert [(picture.viewer, picture.frame) for picture in inbox.drain()] == [(1, 2), (2, 2)]
    assert inbox.dropped == 0


def test_the_clock_answers_and_survives_a_bad_question(
    place: Place, caplog: pytest.LogCaptureFixture
) -> None:
    def reply(question: ClockQuestion) -> ClockAnswer:
        if not question.ready:
            raise KeyError("a mistake of the process's own")
        return ClockAnswer(now_s=12.5, start_s=float(question.viewer or 0))

    with ExitStack() as doors:
        viewer = client(place, doors)
        assert viewer.ask(ClockQuestion(viewer=1, ready=True), ClockAnswer, 0.2) is None
        place.hub.answer(ClockQuestion, reply)
        with foreigner(place) as stranger:
            replies = stranger.get(f"tritrack/{ROOM}/clock", payload=b"?", timeout=SOON_S)
            assert list(replies) == []
        assert viewer.ask(ClockQuestion(viewer=1, ready=False), ClockAnswer, SOON_S) is None
        answer = viewer.ask(ClockQuestion(viewer=2, ready=True), ClockAnswer, SOON_S)
        assert answer == ClockAnswer(now_s=12.5, start_s=2.0)
    assert "a mistake of the process's own" in caplog.text


PART = """
import sys, time
from common.bus.bus import open_client
from common.config.part_settings import BusSettings
from common.config.part_settings import SettingsError
with open_client(BusSettings(sys.argv[1]), sys.argv[2], 5.0) as bus:
    bus.announce("viewer-1")
    time.sleep(60)
"""


def test_a_killed_process_is_seen_to_go(place: Place) -> None:
    alive = place.hub.watch_alive()
    part = subprocess.Popen([sys.executable, "-c", PART, place.settings.endpoint, ROOM])
    try:
        assert alive.take(SOON_S) == Alive("viewer-1", alive=True)
    finally:
        part.kill()
        part.wait()
    assert alive.take(SOON_S) == Alive("viewer-1", alive=False)


@pytest.mark.slow
def test_a_process_that_hangs_counts_as_gone(place: Place) -> None:
    """Zenoh's own lease of 10 s would be 150 frames."""
    alive = place.hub.watch_alive()
    part = subprocess.Popen([sys.executable, "-c", PART, place.settings.endpoint, ROOM])
    try:
        assert alive.take(SOON_S) == Alive("viewer-1", alive=True)
        part.send_signal(signal.SIGSTOP)
        assert alive.take(SOON_S) == Alive("viewer-1", alive=False)
    finally:
        part.kill()
        part.wait()


def test_who_watches_late_hears_who_lives_already(place: Place) -> None:
    with ExitStack() as doors:
        client(place, doors).announce("animator")
        watcher = client(place, doors)
        assert watcher.watch_alive().take(SOON_S) == Alive("animator", alive=True)


def test_a_client_without_a_hub_says_so_in_bounded_time(endpoint: str) -> None:
    began_s = time.monotonic()
    with (
        pytest.raises(BusError, match=rf"{endpoint}.*start the integrator") as caught,
        open_client(BusSettings(endpoint), ROOM, 0.3),
    ):
        pass
    assert time.monotonic() - began_s < 0.3 + SOON_S
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_port_that_accepts_and_stays_silent_is_no_hub() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        endpoint = f"tcp/127.0.0.1:{silent.getsockname()[1]}"
        began_s = time.monotonic()
        with pytest.raises(BusError), open_client(BusSettings(endpoint), ROOM, 0.1):
            pass
    assert time.monotonic() - began_s < SOON_S


def test_a_client_waits_for_a_hub_that_comes_later(endpoint: str) -> None:
    part = subprocess.Popen([sys.executable, "-c", PART, endpoint, ROOM])
    try:
        time.sleep(0.5)
        with open_hub(BusSettings(endpoint), ROOM) as hub:
            assert hub.watch_alive().take(SOON_S) == Alive("viewer-1", alive=True)
    finally:
        part.kill()
        part.wait()


def test_a_client_finds_a_hub_that_was_started_again(endpoint: str) -> None:
    settings = BusSettings(endpoint)
    with ExitStack() as doors:
        with open_hub(settings, ROOM):
            viewer = doors.enter_context(open_client(settings, ROOM, SOON_S))
            viewer.announce("viewer-1")
            viewer.publish(a_report(1, 1))
        with open_hub(settings, ROOM) as hub:
            assert hub.watch_alive().take(SOON_S) == Alive("viewer-1", alive=True)
            once_heard(hub.subscribe(Pulse), viewer)


def test_a_second_hub_is_told_that_the_port_is_taken(place: Place) -> None:
    with (
        pytest.raises(BusError, match=rf"{place.settings.endpoint}.*another \[bus\] endpoint"),
        open_hub(place.settings, ROOM),
    ):
        pass


@pytest.mark.parametrize("endpoint", ["7447", "", "udp/127.0.0.1:7447:x"])
def test_an_endpoint_that_is_none_is_refused(endpoint: str) -> None:
    with pytest.raises(SettingsError, match=r"must look like tcp/127\.0\.0\.1:7447"):
        BusSettings(endpoint)


def test_a_closed_bus_wakes_who_waits(endpoint: str) -> None:
    with open_hub(BusSettings(endpoint), ROOM) as hub:
        inbox, watcher = hub.subscribe(View), hub.watch_alive()
    assert inbox.take(60.0) is None
    assert watcher.take(60.0) is None


def test_the_local_bus_hands_on_what_was_encoded_and_refuses_what_is_not_finite() -> None:
    bus = LocalBus(ROOM)
    inbox = bus.subscribe(View)
    said = a_report(1, 3)
    bus.publish(said)
    bus.publish(a_report(1, 4, float("nan")))
    heard = inbox.drain()
    assert heard == [said]
    assert heard[0] is not said
    assert inbox.malformed == 1


def test_the_local_bus_keeps_answers_and_announces_as_the_live_one() -> None:
    bus = LocalBus(ROOM)
    bus.publish(a_guide(1))
    assert bus.latest(Guide, 0.0) is None
    bus.keep(Guide)
    bus.publish(a_guide(2))
    assert bus.latest(Guide, 0.0) == a_guide(2)
    question = ClockQuestion(viewer=1, ready=True)
    assert bus.ask(question, ClockAnswer, 0.0) is None
    bus.answer(ClockQuestion, lambda asked: ClockAnswer(now_s=float(asked.viewer or 0)))
    assert bus.ask(question, ClockAnswer, 0.0) == ClockAnswer(now_s=1.0)
    bus.announce("viewer-1")
    watcher = bus.watch_alive()
    bus.announce("viewer-2")
    assert watcher.drain() == [Alive("viewer-1", alive=True), Alive("viewer-2", alive=True)]


def test_an_answer_that_fails_is_none_and_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    def reply(question: ClockQuestion) -> ClockAnswer:
        raise KeyError(f"viewer {question.viewer} is not known")

    bus = LocalBus(ROOM)
    bus.answer(ClockQuestion, reply)
    assert bus.ask(ClockQuestion(viewer=2, ready=True), ClockAnswer, 0.0) is None
    assert "viewer 2 is not known" in caplog.text


def test_the_local_bus_is_a_bus() -> None:
    bus: Bus = LocalBus()
    assert bus.subscribe(Pulse).take(0.0) is None


def test_a_mailbox_that_is_closed_still_gives_what_waits() -> None:
    mailbox: Mailbox[int] = Mailbox(bound=2)
    for item in (1, 2, 3):
        mailbox.put(item)
    mailbox.close()
    mailbox.put(4)
    assert not mailbox.over
    assert [mailbox.take(0.0), mailbox.take(0.0), mailbox.take(0.0)] == [2, 3, None]
    assert (mailbox.dropped, mailbox.over) == (1, True)


def test_what_another_run_says_is_dropped_counted_and_named(
    endpoint: str, caplog: pytest.LogCaptureFixture
) -> None:
    """A stray process of a run before speaks on the same endpoint, in a room of the same name; the
    clock's question of one that is not ours stays without an answer."""
    ours = BusSettings(endpoint, "monday")
    strangers = (BusSettings(endpoint, "sunday"), BusSettings(endpoint))
    with ExitStack() as doors:
        hub = doors.enter_context(open_hub(ours, ROOM))
        hub.answer(ClockQuestion, lambda _: ClockAnswer(now_s=1.0))
        hub.keep(Guide)
        hub.publish(a_guide(5))
        inbox = hub.subscribe(View)
        own = doors.enter_context(open_client(ours, ROOM, SOON_S))
        own.publish(a_report(1, 0))
        for settings in strangers:
            other = doors.enter_context(open_client(settings, ROOM, SOON_S))
            other.publish(a_report(1, 7))
            question = ClockQuestion(viewer=1, ready=True)
            assert other.ask(question, ClockAnswer, 0.5) is None
            assert other.latest(Guide, 0.5) is None
        until_s = time.monotonic() + SOON_S
        while inbox.foreign < len(strangers) and time.monotonic() < until_s:
            time.sleep(0.01)
        assert (inbox.foreign, inbox.malformed) == (len(strangers), 0)
        assert [report.frame for report in inbox.drain()] == [0]
        assert own.ask(ClockQuestion(viewer=1, ready=True), ClockAnswer, SOON_S) is not None
        assert own.latest(Guide, SOON_S) == a_guide(5)
    assert "another session" in caplog.text
    assert "sunday" in caplog.text


def test_a_listener_without_a_word_hears_a_run_that_has_one(endpoint: str) -> None:
    """As who subscribes from a program of their own does."""
    with ExitStack() as doors:
        hub = doors.enter_context(open_hub(BusSettings(endpoint, "monday"), ROOM))
        listener = doors.enter_context(open_client(BusSettings(endpoint), ROOM, SOON_S))
        inbox = listener.subscribe(View)
        until_s = time.monotonic() + SOON_S
        heard = None
        while heard is None and time.monotonic() < until_s:
            hub.publish(a_report(1, 3))
            heard = inbox.take(0.1)
        assert heard == a_report(1, 3)


def test_a_session_that_does_not_close_in_time_is_no_failure(
    endpoint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Stuck:
        def close(self) -> None:
            raise zenoh.ZError("close operation timed out!")

    monkeypatch.setattr(zenoh, "open", lambda _: Stuck())
    with open_hub(BusSettings(endpoint), ROOM):
        pass


def told_to_zenoh(
    settings: BusSettings, part: str, monkeypatch: pytest.MonkeyPatch
) -> dict[str, Any]:
    """What a session is opened with."""
    own: dict[str, Any] = {}

    class Config:
        def insert_json5(self, name: str, text: str) -> None:
            own[name] = json.loads(text)

    ask: Any = bus_module._config
    with monkeypatch.context() as patched:
        patched.setattr(zenoh, "Config", Config)
        ask(settings, part, ROOM)
    return own


def test_a_session_meets_the_others_at_the_endpoint_and_nowhere_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    place = BusSettings("tcp/127.0.0.1:7999")
    hub, client = (told_to_zenoh(place, part, monkeypatch) for part in ("integrator", "viewer1"))
    ours = {
        "connect/retry": {
            "period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2,
        },
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "scouting/delay": 0,
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": 4000,
        "transport/link/tx/queue/size/interactive_high": 16,
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 10_000,
        "transport/link/rx/max_message_size": 1_065_536,
        "transport/unicast/open_timeout": 3000,
    }  # fmt: skip
    where = {"listen/endpoints": ["tcp/127.0.0.1:7999"], "connect/endpoints": []}
    assert hub == {**ours, **where, "mode": "router"}
    turned = {"listen/endpoints": [], "connect/endpoints": ["tcp/127.0.0.1:7999"]}
    assert client == {**ours, **turned, "mode": "client"}


def test_with_keys_each_part_shows_its_own_and_the_hub_alone_has_rules(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("ca.pem", "integrator.pem", "integrator.key", "viewer2.pem", "viewer2.key"):
        (tmp_path / name).touch()
    place = BusSettings("tls/127.0.0.1:7999", keys=str(tmp_path))
    hub, client = (told_to_zenoh(place, part, monkeypatch) for part in ("integrator", "viewer2"))
    assert hub["transport/link/tls"]["listen_certificate"] == str(tmp_path / "integrator.pem")
    assert client["transport/link/tls"]["connect_private_key"] == str(tmp_path / "viewer2.key")
    assert hub["access_control"] == access_of(ROOM)
    assert "access_control" not in client


def unreachable(monkeypatch: pytest.MonkeyPatch, tries: int = 10**9) -> list[float]:
    """No hub before so many tries; the moments of all tries, by a clock that waiting moves on."""
    now_s, tried_s = [50.0], list[float]()

    def opened(_: object) -> str:
        tried_s.append(round(now_s[0], 3))
        if len(tried_s) < tries:
            raise zenoh.ZError("Unable to connect at /somewhere")
        return "a session"

    def waits(_: object, timeout: float) -> bool:
        now_s[0] += timeout
        return False

    monkeypatch.setattr(zenoh, "open", opened)
    monkeypatch.setattr(time, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(threading.Event, "wait", waits)
    return tried_s


def test_the_hub_is_tried_each_tenth_of_a_second_until_time_is_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried_s, place, reach = unreachable(monkeypatch), BusSettings(), cast(Any, bus_module._reach)
    assert reach(place, "client", ROOM, 50.35, threading.Event()) is None
    assert tried_s == [50.0, 50.1, 50.2, 50.3]


def test_a_hub_that_comes_is_met_and_who_is_stopped_does_not_wait(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried_s, place, reach = unreachable(monkeypatch, 3), BusSettings(), cast(Any, bus_module._reach)
    assert reach(place, "client", ROOM, 60.0, threading.Event()) == "a session"
    assert tried_s == [50.0, 50.1, 50.2]
    stop = threading.Event()
    stop.set()
    with pytest.raises(Stopped):
        reach(place, "client", ROOM, 60.0, stop)
    assert len(tried_s) == 3


def test_a_hub_that_does_not_answer_is_named_with_how_long_and_the_keys_if_there_are_any() -> None:
    place = "tcp/127.0.0.1:7447"
    cure = "start the integrator first, or set [bus] endpoint to where it listens"
    assert str(unanswered(BusSettings(), 2.5)) == f"nobody answers at {place} after 2.5 s: {cure}"
    keyed = BusSettings("tls/127.0.0.1:7447", keys="here")
    assert str(unanswered(keyed, 60.0)) == (
        f"nobody answers at tls/127.0.0.1:7447 after 60 s: {cure}, or look at the keys: "
        "tritrack doctor --keys here"
    )


def test_a_session_is_closed_after_what_was_declared_of_it_also_where_that_fails(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    done: list[str] = []

    class Session:
        def close(self) -> None:
            done.append("session")

    class Failing:
        def __init__(self, _session: object, room: str, run: str) -> None:
            assert (room, run) == (ROOM, "word")

        def close(self) -> None:
            done.append("bus")
            raise RuntimeError

    monkeypatch.setattr(zenoh, "open", lambda _: Session())
    monkeypatch.setattr(bus_module, "LiveBus", Failing)
    for door in (
        open_hub(BusSettings(session="word"), ROOM),
        open_client(BusSettings(session="word"), ROOM, 1.0),
    ):
        with pytest.raises(RuntimeError), door:
            pass
    assert done == ["bus", "session"] * 2
