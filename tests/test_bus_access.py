"""Who may say what on a bus with keys, over real sessions on the loopback."""

import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import pytest
from keyring import foreign, tls_as, with_keys
from meeting import free_endpoint
from test_message_codec import BODY, REPORT, SAID

pytest.importorskip("cryptography", reason="keys are an extra: install tritrack[keys]")

from common.bus.bus import Bus, open_client, open_hub
from common.bus.bus_access import RIGHTS, access_of
from common.bus.bus_keys import PARTS, Part
from common.bus.control_messages import ClockAnswer, ClockQuestion, Ended, Pulse
from common.bus.inbox import Alive, Inbox
from common.bus.message_codec import TOPICS, encode, key_of
from common.bus.messages import Guide, Message, Picture, View
from common.config.part_settings import BusSettings

ROOM = "hall"
SOON_S = 5.0
LATE_S = 0.5
"""By then what was said is heard, or never: it takes milliseconds."""
VIEWER_1 = {"viewer/1/report", "viewer/1/picture", "viewer/1/ended", "pulse/viewer 1", "answer"}
HEARD: dict[str, set[str]] = {
    "viewer1": VIEWER_1,
    **{f"viewer{n}": {key.replace("1", str(n)) for key in VIEWER_1} for n in range(2, 9)},
    "recognizer": {"posture", "pulse/recognizer"},
    "animator": {"command", "pulse/animator"},
    "supervisor": {"answer"},
    "metrics": {"pulse/metrics"},
    "client": set(),
}
LIKE_THE_SECOND = {f"viewer{n}" for n in range(3, 8)}
PROCESSES = (
    *(f"viewer {n}" for n in range(1, 9)),
    "integrator",
    "recognizer",
    "animator",
    "metrics",
)
EVERYTHING: list[Message] = [
    *(message for message in SAID if type(message) in TOPICS),
    *(msgspec.structs.replace(REPORT, viewer=viewer) for viewer in range(1, 9)),
    *(
        Picture(frame=7, captured_s=0.5, clock_s=0.5, viewer=viewer, jpeg=b"\xff\xd8")
        for viewer in range(2, 9)
    ),
    *(Ended(viewer=viewer, frames=69) for viewer in range(2, 9)),
    *(Pulse(process=name, state="running") for name in PROCESSES),
]


class Hall(NamedTuple):
    settings: BusSettings
    hub: Bus


@pytest.fixture
def hall(keys: Path) -> Iterator[Hall]:
    settings = with_keys(keys)
    with open_hub(settings, ROOM) as hub:
        yield Hall(settings, hub)


def enter(hall: Hall, doors: ExitStack, part: Part) -> Bus:
    return doors.enter_context(open_client(hall.settings, ROOM, SOON_S, part))


@pytest.mark.parametrize("part", [part for part in HEARD if part not in LIKE_THE_SECOND])
def test_a_part_is_heard_on_its_own_keys_and_on_no_other(hall: Hall, part: Part) -> None:
    """By the integrator, which is the hub, and by others whom it hands on to."""
    with ExitStack() as doors:
        listener = enter(hall, doors, "animator" if part != "animator" else "supervisor")
        inboxes: list[list[Inbox[Any]]] = [
            [bus.subscribe(kind) for kind in TOPICS] for bus in (hall.hub, listener)
        ]
        speaker = enter(hall, doors, part)
        time.sleep(LATE_S)
        for message in EVERYTHING:
            speaker.publish(message)
        time.sleep(LATE_S)
        for each in inboxes:
            heard = {key_of(message, "") for inbox in each for message in inbox.drain()}
            assert heard == {f"tritrack//{key}" for key in HEARD[part]}


def test_everybody_hears_what_the_integrator_says(hall: Hall) -> None:
    with ExitStack() as doors:
        ears = [enter(hall, doors, part).subscribe(type(BODY)) for part in RIGHTS]
        time.sleep(LATE_S)
        hall.hub.publish(BODY)
        assert [each.take(SOON_S) for each in ears] == [BODY] * len(ears)


def delivered(settings: BusSettings) -> tuple[int, int]:
    """How many of 10,000 forged reports and bodies two listeners hear; and of 10 true ones."""
    with ExitStack() as doors:
        hub = doors.enter_context(open_hub(settings, ROOM))
        viewer, page, forger = (
            doors.enter_context(open_client(settings, ROOM, SOON_S, part))
            for part in ("viewer1", "animator", "client")
        )
        inboxes: list[Inbox[Any]] = [
            bus.subscribe(kind) for bus in (hub, page) for kind in (View, type(BODY))
        ]
        time.sleep(LATE_S)
        forged, true = 0, 0
        for n in range(5000):
            forger.publish(msgspec.structs.replace(REPORT, viewer=1, frame=n))
            forger.publish(msgspec.structs.replace(BODY, frame=n))
            if n % 500 == 0:
                viewer.publish(msgspec.structs.replace(REPORT, viewer=1, frame=-1))
        time.sleep(LATE_S)
        for inbox in inboxes:
            heard = [message.frame for message in inbox.drain()]
            true += heard.count(-1)
            forged += len(heard) - heard.count(-1) + inbox.dropped
            assert (inbox.malformed, inbox.foreign) == (0, 0)
        return forged, true


@pytest.mark.slow
def test_of_ten_thousand_forged_messages_none_is_delivered(keys: Path) -> None:
    """Issue 15: 0 of 10,000 under access control; the same forger on a plain bus is heard."""
    assert delivered(with_keys(keys)) == (0, 20)
    forged, _ = delivered(BusSettings(free_endpoint()))
    assert forged > 1000


@pytest.mark.parametrize("mode", ["client", "peer", "router"])
@pytest.mark.parametrize("name", ["client", "viewer1"])
def test_neither_another_mode_nor_a_wildcard_widens_what_a_part_may_say(
    hall: Hall, keys: Path, mode: str, name: str
) -> None:
    """By a program of somebody who knows Zenoh and holds the files of one part."""
    place = {"connect": hall.settings.endpoint}
    with ExitStack() as doors:
        page = enter(hall, doors, "animator")
        inboxes = [bus.subscribe(kind) for bus in (hall.hub, page) for kind in (View, type(BODY))]
        false = doors.enter_context(foreign(mode, place, tls_as(keys, name)))
        time.sleep(LATE_S)
        own, report = (msgspec.structs.replace(REPORT, viewer=viewer) for viewer in (1, 2))
        for key in ("viewer/2/report", "viewer/*/report", "viewer/**", "**", "*/2/report"):
            false.put(f"tritrack/{ROOM}/{key}", encode(report))
        for key in ("body/pose", "body/*", "**", "*/pose"):
            false.put(f"tritrack/{ROOM}/{key}", encode(BODY))
        for key in ("tritrack/**", "**", "tritrack/*/body/pose"):
            false.put(key, encode(BODY))
        false.put(f"tritrack/{ROOM}/viewer/1/report", encode(own))
        time.sleep(LATE_S)
        allowed = [own] if name == "viewer1" else []
        assert [inbox.drain() for inbox in inboxes] == [allowed, [], allowed, []]
        assert sum(inbox.malformed for inbox in inboxes) == 0


def test_only_a_viewer_may_ask_the_clock_and_so_begin_the_run(hall: Hall) -> None:
    question = ClockQuestion(viewer=1, ready=True)
    hall.hub.answer(ClockQuestion, lambda _: ClockAnswer(now_s=1.0))
    with ExitStack() as doors:
        assert enter(hall, doors, "client").ask(question, ClockAnswer, LATE_S) is None
        assert enter(hall, doors, "viewer2").ask(question, ClockAnswer, SOON_S) is not None


def test_nobody_else_answers_in_the_integrators_place(hall: Hall) -> None:
    with ExitStack() as doors:
        false = enter(hall, doors, "client")
        false.answer(ClockQuestion, lambda _: ClockAnswer(now_s=666.0))
        false.keep(Guide)
        time.sleep(LATE_S)
        viewer = enter(hall, doors, "viewer1")
        assert viewer.ask(ClockQuestion(viewer=1, ready=True), ClockAnswer, LATE_S) is None
        assert viewer.latest(Guide, LATE_S) is None


def test_everybody_may_ask_for_what_the_integrator_keeps(hall: Hall) -> None:
    guide = Guide(frame=7, captured_s=0.5, clock_s=0.5, frames=(7, 7))
    hall.hub.keep(Guide)
    hall.hub.publish(guide)
    with ExitStack() as doors:
        assert enter(hall, doors, "client").latest(Guide, SOON_S) == guide


def test_a_part_announces_itself_under_its_own_name_alone(hall: Hall) -> None:
    watcher = hall.hub.watch_alive()
    with ExitStack() as doors:
        for part in ("client", "viewer1"):
            speaker = enter(hall, doors, part)
            for name in PROCESSES:
                speaker.announce(name)
        time.sleep(LATE_S)
        assert watcher.drain() == [Alive("viewer 1", alive=True)]


def test_what_the_hub_is_told_names_each_part_with_its_own_keys_alone() -> None:
    told = access_of("hall")
    assert (told["enabled"], told["default_permission"]) == (True, "deny")
    rules = {rule["id"]: rule for rule in told["rules"]}
    assert len(rules) == len(told["rules"])
    assert {rule["permission"] for rule in rules.values()} == {"allow"}
    said = {
        part: {key.removeprefix("tritrack/hall/") for key in rules[f"{part} says"]["key_exprs"]}
        for part in HEARD
        if HEARD[part]
    }
    names = {f"viewer{n}": f"viewer {n}" for n in range(1, 9)}
    for part, keys in said.items():
        alive = set() if part == "supervisor" else {f"alive/{names.get(part, part)}"}
        assert keys == HEARD[part] | alive
        assert rules[f"{part} says"]["flows"] == ["ingress"]
        assert rules[f"{part} says"]["messages"] == ["put", "liveliness_token"]
    asking = {name for name in rules if name.endswith(" asks")}
    assert asking == {"recognizer asks", *(f"viewer{n} asks" for n in range(1, 9))}
    for name in asking:
        assert rules[name]["key_exprs"] == ["tritrack/hall/clock"]
        assert (rules[name]["flows"], rules[name]["messages"]) == (["ingress"], ["query"])


def test_all_parts_hear_everything_and_may_ask_for_the_newest_guide_and_cameras() -> None:
    told = access_of("hall")
    is_told, hears, asks = told["rules"][:3]
    assert is_told["key_exprs"] == hears["key_exprs"] == ["tritrack/hall/**"]
    assert asks["key_exprs"] == ["tritrack/hall/body/guide", "tritrack/hall/cameras"]
    assert [rule["flows"] for rule in (is_told, hears, asks)] == [
        ["egress"],
        ["ingress"],
        ["ingress"],
    ]
    assert asks["messages"] == ["query"]
    assert hears["messages"] == [
        "declare_subscriber",
        "declare_liveliness_subscriber",
        "liveliness_query",
    ]
    assert {"put", "reply", "delete", "query", *hears["messages"]} < {*is_told["messages"]}
    subjects = {one["id"]: one["cert_common_names"] for one in told["subjects"]}
    assert {*subjects["all"]} == {*PARTS} - {"integrator"}
    whose = {policy["subjects"][0]: policy["rules"] for policy in told["policies"]}
    assert whose.pop("all") == [rule["id"] for rule in (is_told, hears, asks)]
    assert {part: subjects[part] for part in whose} == {part: [part] for part in whose}
    assert "client" not in whose
    for part, own in whose.items():
        assert own
        assert all(rule.startswith(f"{part} ") for rule in own)
    assert sum(map(len, whose.values())) == len(told["rules"]) - 3
