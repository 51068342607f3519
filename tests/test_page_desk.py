"""What a run does for the person at its page: parts of it saved as run folders of their own."""

import io
import json
import re
import socket
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from local_bus import LocalBus
from rich.console import Console

from common.bus.control_messages import Answer, Command, Wish
from common.bus.messages import Body, Posture, Status
from common.bus.process import ProcessContext
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from runtime.live.free_ports import free_port, free_settings
from runtime.live.launch import nothing_heard
from runtime.live.page_desk import LAST_S, SAVED, PageDesk
from runtime.live.recorded import MessageLog
from runtime.live.session import live
from runtime.store.journal import Head, Journal
from runtime.store.past_run import open_run

RATE_HZ = 15
NO_PAGE = Settings(page=PageSettings(port=0))


class Sitting:
    """A desk without a page's process, and a run of so many seconds that was heard."""

    def __init__(self, out: Path, settings: Settings = NO_PAGE) -> None:
        self.bus, self.heard, self.stop = LocalBus(), nothing_heard(), threading.Event()
        self.answers = self.bus.subscribe(Answer)
        self.desk = PageDesk(settings, out, "a run", ProcessContext(True))
        self.desk.facts = lambda _: {"clip": "a clip", "warnings": []}
        self.desk.listen(self.bus)
        self.frames = 0

    def run(self, seconds: float, status: Status = "empty") -> None:
        for _ in range(round(seconds * RATE_HZ)):
            at_s = self.frames / RATE_HZ
            body = Body(
                frame=self.frames, captured_s=at_s, clock_s=at_s, status=status, views="none"
            )
            self.heard.bodies.add([body])
            self.frames += 1

    def ask(self, what: Wish) -> Answer | None:
        self.bus.publish(Command(what=what))
        self.desk.serve(self.heard, self.stop)
        answers = self.answers.drain()
        return answers[-1] if answers else None


@pytest.fixture
def sitting(tmp_path: Path) -> Sitting:
    return Sitting(tmp_path)


def test_who_is_lost_from_sight_leaves_the_seconds_before_as_a_run_folder(tmp_path: Path) -> None:
    """Once in fifteen seconds; who walks out of the room is not lost."""
    sitting = Sitting(tmp_path, Settings(page=PageSettings(port=0, save_lost=True)))

    def then(seconds: float, status: Status) -> None:
        for _ in range(round(seconds)):
            sitting.run(1.0, status)
            sitting.desk.serve(sitting.heard, sitting.stop)

    then(20, "tracking")
    then(5, "empty")
    then(5, "tracking")
    assert not (tmp_path / SAVED).exists()
    then(2, "lost")
    past = open_run(saved(tmp_path))
    assert past.poses["time_s"][-1] == pytest.approx(30.0 + 14 / RATE_HZ)
    assert np.ptp(past.poses["time_s"]) == pytest.approx(LAST_S + 14 / RATE_HZ)
    then(4, "tracking")
    then(1, "lost")
    assert saved(tmp_path), "too soon for another"
    then(20, "predicted")
    then(1, "lost")
    assert len(list((tmp_path / SAVED).iterdir())) == 2
    answers = [answer.text for answer in sitting.answers.drain()]
    assert len(answers) == 2


def test_nothing_is_written_of_who_is_lost_unless_the_settings_ask_for_it(
    sitting: Sitting, tmp_path: Path
) -> None:
    sitting.run(5.0, "tracking")
    sitting.run(1.0, "lost")
    sitting.desk.serve(sitting.heard, sitting.stop)
    assert not (tmp_path / SAVED).exists()


def saved(out: Path) -> Path:
    (folder,) = (out / SAVED).iterdir()
    return folder


def test_the_last_seconds_become_a_run_folder_that_every_command_reads(
    sitting: Sitting, tmp_path: Path
) -> None:
    sitting.run(40.0)
    answer = sitting.ask("save")
    assert answer is not None
    assert answer.well
    assert "15.0 s written" in answer.text
    past = open_run(saved(tmp_path))
    assert np.ptp(past.poses["time_s"]) == pytest.approx(LAST_S, abs=1e-6)
    assert past.poses["frame"][-1] == 40 * RATE_HZ - 1
    assert past.summary["clip"] == "a clip"


def test_a_saved_part_tells_of_its_own_bodies_and_postures_alone(
    sitting: Sitting, tmp_path: Path
) -> None:
    """And the run's, which are many, are not read for it."""
    sitting.desk.facts = lambda own: {"posture": own.posture, "moves": len(own.moves)}
    for at_s, name in ((0.0, "squat"), (40.0, "kick_left_side")):
        said = Posture(frame=0, captured_s=at_s, clock_s=0.0, name=name)
        moved = Body(
            frame=0, captured_s=at_s, clock_s=0.0, status="empty", views="none", moved=(1,)
        )
        sitting.heard.postures.add([said])
        sitting.heard.bodies.add([moved])
    sitting.ask("save")
    told = open_run(saved(tmp_path)).summary
    assert (told["posture"], told["moves"]) == ("kick_left_side", 1)
    assert told["frames"] == 1


def test_a_recording_goes_from_its_first_word_to_its_last(sitting: Sitting, tmp_path: Path) -> None:
    sitting.run(5.0)
    assert sitting.ask("record") is not None
    sitting.run(3.0)
    answer = sitting.ask("end_record")
    assert answer is not None
    assert answer.well
    assert np.ptp(open_run(saved(tmp_path)).poses["time_s"]) == pytest.approx(3.0)
    assert sitting.ask("end_record") is None, "nothing is recorded any more"


def test_a_recording_that_memory_did_not_hold_is_read_from_the_journal(
    sitting: Sitting, tmp_path: Path
) -> None:
    sitting.heard = sitting.heard._replace(bodies=MessageLog(Body, most=30))
    written = Journal(tmp_path, Head(settings=NO_PAGE, facts={}))
    sitting.run(1.0)
    sitting.ask("record")
    sitting.run(10.0)
    for frame in range(sitting.frames):
        at_s = frame / RATE_HZ
        written.keep(
            [Body(frame=frame, captured_s=at_s, clock_s=at_s, status="empty", views="none")]
        )
    answer = sitting.ask("end_record")
    assert answer is not None
    assert answer.well
    assert "10.0 s written" in answer.text
    frames = open_run(saved(tmp_path)).poses["frame"].tolist()
    assert frames == [*range(RATE_HZ - 1, 11 * RATE_HZ)]
    written.remove()


def test_a_recording_that_nobody_ended_is_written_when_the_run_is_over(
    sitting: Sitting, tmp_path: Path
) -> None:
    sitting.run(1.0)
    sitting.ask("record")
    sitting.run(2.0)
    sitting.desk.leave(sitting.heard)
    assert [answer.what for answer in sitting.answers.drain()] == ["end_record"]
    assert len(open_run(saved(tmp_path)).poses["frame"]) == 2 * RATE_HZ + 1
    assert sitting.ask("save") is None, "its bus is closed"


def test_who_asks_for_a_recording_that_goes_on_does_not_begin_it_anew(
    sitting: Sitting, tmp_path: Path
) -> None:
    """A second browser does, or one that was loaded again."""
    sitting.run(1.0)
    sitting.ask("record")
    sitting.run(3.0)
    again = sitting.ask("record")
    assert again is not None
    assert again.well
    sitting.run(2.0)
    sitting.ask("end_record")
    assert np.ptp(open_run(saved(tmp_path)).poses["time_s"]) == pytest.approx(5.0)


def test_a_recording_that_cannot_be_written_is_not_lost(sitting: Sitting, tmp_path: Path) -> None:
    sitting.run(1.0)
    sitting.ask("record")
    sitting.run(3.0)
    (tmp_path / SAVED).write_text("in the way")
    refused = sitting.ask("end_record")
    assert refused is not None
    assert not refused.well
    (tmp_path / SAVED).unlink()
    written = sitting.ask("end_record")
    assert written is not None
    assert written.well
    assert np.ptp(open_run(saved(tmp_path)).poses["time_s"]) == pytest.approx(3.0)


def test_what_cannot_be_saved_is_said(sitting: Sitting, tmp_path: Path) -> None:
    nothing = sitting.ask("save")
    assert nothing is not None
    assert not nothing.well
    sitting.run(1.0)
    (tmp_path / SAVED).write_text("in the way")
    refused = sitting.ask("save")
    assert refused is not None
    assert not refused.well
    assert "cannot write" in refused.text


def test_the_run_is_ended_at_the_page(sitting: Sitting) -> None:
    sitting.ask("stop")
    assert sitting.stop.is_set()
    assert sitting.desk.stopped


def test_without_a_page_there_is_nothing_to_wait_for(sitting: Sitting) -> None:
    assert sitting.desk.parts == []
    assert sitting.desk.address == ""
    sitting.desk.end({}, sitting.stop, lambda: pytest.fail("nobody is there"))
    sitting.desk.close()


@pytest.mark.slow
def test_the_token_of_a_page_beyond_this_machine_is_told_to_the_person_alone(
    clip: Path, tmp_path: Path
) -> None:
    """It is printed once; who reads the run folder, or hears the bus, does not learn it."""
    said, out = io.StringIO(), tmp_path / "out"
    settings = free_settings(Settings(clip=str(clip), page=PageSettings(port=0)))
    page = PageSettings(port=free_port(), host="0.0.0.0", wait=False)
    settings = msgspec.structs.replace(settings, page=page)
    live(settings, out, Console(file=said, width=60))
    (token,) = set(re.findall(rf":{page.port}/\?token=([\w-]+)", said.getvalue()))
    assert len(token) >= 43
    told = {path.name: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    assert f":{page.port}".encode() in told["log.txt"]
    assert [name for name, content in told.items() if token.encode() in content] == []
    assert token not in repr(json.loads(told["summary.json"]))


class Page:
    """The page's process: it is there for some looks, and hears what it is told."""

    def __init__(self, part: Any) -> None:
        self.part, self.calls, self.looks = part, list[Any](), 0
        self.running = SimpleNamespace(process=self)

    def join(self, within_s: float) -> None:
        self.calls.append(within_s)

    def is_alive(self) -> bool:
        self.looks -= 1
        return self.looks >= 0

    def end(self) -> None:
        self.calls.append("end")


def test_a_page_is_told_the_end_and_waited_for_while_it_is_looked_at(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Its process is begun with the desk; where it has closed already nobody waits."""
    monkeypatch.setattr("runtime.live.page_desk.Watched", Page)
    settings, context = Settings(page=PageSettings(port=9)), ProcessContext(True)
    launcher: Any = object()
    desk = PageDesk(settings, tmp_path, "a run", context, launcher)
    page: Any = desk.watched
    assert desk.parts == [page.part]
    own, beside, title, ending, _ = page.part.arguments
    assert (own, beside, title, page.part.launcher) == (settings, context, "a run", launcher)
    waited: list[float] = []
    stop = SimpleNamespace(wait=waited.append)
    said: list[int] = []
    page.looks = 3
    desk.end({"clip": "walk"}, stop, lambda: said.append(1))  # type: ignore[arg-type]
    assert ending.recv() == {"clip": "walk", "out": str(tmp_path)}
    assert (page.calls, waited, said) == ([2.0], [0.1, 0.1], [1])
    page.looks = 0
    desk.end({}, stop, lambda: pytest.fail("it has closed"))  # type: ignore[arg-type]
    assert ending.recv() == {"out": str(tmp_path)}
    page.looks, stopped = 9, SimpleNamespace(wait=lambda _: True)
    desk.end({}, stopped, lambda: None)  # type: ignore[arg-type]
    assert page.looks == 7, "Ctrl-C ends the wait"
    ending.close()
    page.calls.clear()
    desk.end({}, stop, lambda: pytest.fail("it has gone"))  # type: ignore[arg-type]
    assert page.calls == []
    desk.close()
    assert page.calls == ["end"]


def test_a_page_has_an_address_once_it_answers(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("runtime.live.page_desk.Watched", Page)
    port = free_port()
    desk = PageDesk(Settings(page=PageSettings(port=port)), tmp_path, "a run", ProcessContext(True))
    assert desk.address == ""
    with socket.socket() as door:
        door.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        door.bind(("127.0.0.1", port))
        door.listen()
        assert desk.address.startswith(f"http://127.0.0.1:{port}")


def test_who_may_be_lost_is_one_that_was_followed_just_before(tmp_path: Path) -> None:
    """Fifteen seconds after the one before, and no sooner; each body is looked at once."""
    sitting = Sitting(tmp_path, Settings(page=PageSettings(port=0, save_lost=True)))

    def body_at(at_s: float, status: Status) -> None:
        body = Body(frame=int(at_s), captured_s=at_s, clock_s=at_s, status=status, views="none")
        sitting.heard.bodies.add([body])
        sitting.desk.serve(sitting.heard, sitting.stop)
        sitting.desk.serve(sitting.heard, sitting.stop)

    told = list[int]()
    for at_s, status in (
        *((1.0, "measuring"), (2.0, "lost"), (3.0, "predicted"), (4.0, "lost"), (5.0, "lost")),
        *((18.9, "tracking"), (19.0, "lost"), (19.05, "tracking"), (19.1, "lost")),
    ):
        body_at(at_s, status)  # type: ignore[arg-type]
        told.append(len(sitting.answers.drain()))
    assert told == [0, 0, 0, 1, 0, 0, 0, 0, 1]
