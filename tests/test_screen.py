"""What a person sees of a live run: the table of its processes, and each piece of news once."""

import io

import msgspec
import pytest
from rich.console import Console

from common.bus.control_messages import Pulse
from common.bus.messages import Body, Posture
from common.config.settings import Settings
from common.video.clip_facts import Clip, ClipView, Meta
from runtime.live.launch import nothing_heard
from runtime.live.screen import Screen, warnings_of

VIEW = ClipView(1, "cam1.avi", (160, 120), (160, 120), 30.0, 60)
CLIP = Clip("walk", (VIEW,), 4, None, Meta(), ("it is short",))


def pulse(name: str, detail: str = "", frames: int = 0) -> Pulse:
    return Pulse(process=name, state="running", detail=detail, frames=frames)


class Seen:
    """A console, and a page that answers when it is told to."""

    def __init__(self) -> None:
        self.console = Console(file=io.StringIO(), width=100)
        self.address, self.heard = "", nothing_heard()
        self.screen = Screen(CLIP, Settings(mode="paper"), self.console, lambda: self.address)

    def news(self) -> list[str]:
        """What came since."""
        file = self.console.file
        assert isinstance(file, io.StringIO)
        told = [line.rstrip() for line in file.getvalue().splitlines()]
        file.seek(0)
        file.truncate()
        return [line for line in told if line]


@pytest.fixture
def seen() -> Seen:
    return Seen()


def test_each_piece_of_news_is_told_once_and_the_last_table_stays(seen: Seen) -> None:
    assert seen.news() == ["warning: it is short"]
    with seen.screen.shown(["viewer 1", "recognizer"]) as show:
        seen.heard.pulses["viewer 1"] = pulse("viewer 1", "it is dark\nit is short")
        seen.heard.pulses["recognizer"] = pulse("recognizer", "squat")
        show(seen.heard)
        assert seen.news() == ["warning: it is dark", "squat"]
        seen.heard.notes.append("put aside")
        seen.heard.pulses["viewer 1"] = pulse("viewer 1", "it is dark", frames=41)
        show(seen.heard)
        assert seen.news() == ["warning: put aside"]
        seen.heard.pulses["recognizer"] = pulse("recognizer", "kick")
        show(seen.heard)
        assert seen.news() == ["kick"]
        seen.heard.pulses["recognizer"] = pulse("recognizer")
        show(seen.heard)
        assert seen.news() == []
    lines = seen.news()
    assert lines[0] == "walk: paper mode, 7.5 frames a second"
    (row,) = [line for line in lines if line.startswith(" viewer 1")]
    assert row.split()[:4] == ["viewer", "1", "running", "41"]
    assert any("recognizer" in line for line in lines)


def told_of(person: int, at_s: float, doing: str) -> tuple[Body, Posture]:
    moment = {"frame": 0, "captured_s": at_s, "clock_s": at_s, "person": person}
    body = Body(**moment, status="tracking", views="both")  # type: ignore[arg-type]
    return body, Posture(**moment, name="", doing=doing)  # type: ignore[arg-type]


def test_each_of_several_people_has_a_row_with_their_posture(seen: Seen) -> None:
    """Those of the newest instant: the third person has left."""
    seen.news()
    told = [
        *(told_of(3, 0.1, "squat"), told_of(1, 0.1, "squat")),
        *(told_of(1, 0.2, "walk_toward"), told_of(2, 0.2, "")),
    ]
    with seen.screen.shown(["viewer 1"]) as show:
        seen.heard.bodies.add([body for body, _ in told])
        seen.heard.postures.add([posture for _, posture in told])
        show(seen.heard)
    lines = seen.news()
    at = next(n for n, line in enumerate(lines) if line.split()[:1] == ["person"])
    rows = [line.split() for line in lines[at + 2 :]]
    assert rows == [["1", "tracking", "walk", "toward"], ["2", "tracking"]]


def test_each_person_has_the_advice_of_the_cameras_once(seen: Seen) -> None:
    seen.news()
    bodies = [told_of(person, 0.1, "")[0] for person in (1, 2)]
    advice = ("step back", "", "step back")
    with seen.screen.shown(["viewer 1"]) as show:
        seen.heard.bodies.add([bodies[0], msgspec.structs.replace(bodies[1], advice=advice)])
        show(seen.heard)
    lines = seen.news()
    at = next(n for n, line in enumerate(lines) if line.split()[:1] == ["person"])
    first, second = (" ".join(line.split()) for line in lines[at + 2 :])
    assert first == "1 tracking"
    assert second == "2 tracking camera 1 and 3: step back"


def test_a_run_that_follows_one_person_has_no_table_of_people(seen: Seen) -> None:
    with seen.screen.shown(["viewer 1"]) as show:
        body, posture = told_of(0, 0.1, "squat")
        seen.heard.bodies.add([body])
        seen.heard.postures.add([posture])
        show(seen.heard)
    assert "person" not in " ".join(seen.news())


def test_the_page_is_told_once_it_answers(seen: Seen) -> None:
    seen.news()
    seen.screen.tell_page()
    assert seen.news() == []
    seen.address = "http://127.0.0.1:8000/[x]"
    seen.screen.tell_page()
    seen.screen.tell_page()
    assert seen.news() == ["the page: http://127.0.0.1:8000/[x]"]
    with seen.screen.shown([]) as show:
        show(seen.heard)
        assert seen.news() == []


def test_what_viewers_and_the_integrator_find_odd_is_a_warning_and_nothing_else() -> None:
    """In the order of their names; a recognizer's word is a posture."""
    pulses = {
        name: pulse(name, detail)
        for name, detail in (
            ("viewer 2", "b\nc"),
            ("recognizer", "squat"),
            ("viewer 1", "a"),
            ("integrator", "z"),
            ("animator", "no"),
        )
    }
    assert warnings_of(pulses) == ["z", "a", "b", "c"]
