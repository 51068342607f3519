"""The viewer's loop and its start, with frames, guides and a clock made by hand."""

import threading
import time
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from local_bus import LocalBus

from common.body.observation import Landmarks
from common.bus import clock
from common.bus.clock import Exchange
from common.bus.control_messages import Answer, ClockAnswer, ClockQuestion, Command, Ended, Pulse
from common.bus.inbox import Alive
from common.bus.messages import Guide, Picture, View
from common.bus.process import ProcessContext
from common.config.settings import Settings
from common.method import METHODS
from common.video.clip_facts import ClipView
from common.video.pictures import DecoderDied, Ending
from viewer import __main__ as viewer_process
from viewer import track
from viewer.__main__ import (
    Prepared,
    StartError,
    _before,
    _beside_the_other,
    _empty_frames,
    _news,
    _prepared,
    met,
    run,
)
from viewer.background.background import learn
from viewer.captured_frame import CapturedFrame
from viewer.guides import Guides
from viewer.load_shedding import LoadShedder

VIEW = ClipView(2, "cam2.avi", (64, 48), (64, 48), 15.0, 40)
EMPTY = learn([np.full((48, 64, 3), 100, np.uint8)])


def guide(frames: tuple[int, int]) -> Guide:
    return Guide(frame=0, captured_s=0.0, clock_s=0.0, frames=frames)


class Taken:
    """An inbox that gives what is due, and keeps how long each was waited for."""

    def __init__(self, *given: Guide | None) -> None:
        self.given, self.waits = list(given), []  # type: ignore[var-annotated]
        self.malformed, self.foreign = 3, 4

    def take(self, wait_s: float) -> Guide | None:
        self.waits.append(wait_s)
        if self.given:
            return self.given.pop(0)
        time.sleep(wait_s)
        return None


def test_a_frame_waits_for_the_guide_that_has_heard_of_the_one_before() -> None:
    """Of this viewer: what the guide has heard of the other does not count."""
    inbox = Taken(guide((9, 3)), guide((9, 4)), guide((9, 5)))
    guides = Guides(inbox, 2)  # type: ignore[arg-type]
    assert guides.heard == -1
    assert guides.of_frame(4, 5.0) == guide((9, 4))
    assert (guides.misses, guides.heard) == (0, 4)
    assert all(4.0 < wait <= 5.0 for wait in inbox.waits)
    assert guides.of_frame(4, 5.0) == guide((9, 4))
    assert len(inbox.waits) == 2
    assert (guides.malformed, guides.foreign) == (3, 4)


def test_a_guide_that_does_not_come_in_time_is_missed_and_the_newest_serves() -> None:
    inbox = Taken(guide((2, 7)))
    guides = Guides(inbox, 1)  # type: ignore[arg-type]
    began_s = time.monotonic()
    assert guides.of_frame(3, 0.05) == guide((2, 7))
    assert 0.05 <= time.monotonic() - began_s < 1.0
    assert guides.misses == 1
    assert min(inbox.waits) == 0.0
    assert guides.of_frame(-1, 0.05) == guide((2, 7))
    assert guides.misses == 1


def frame(index: int) -> CapturedFrame:
    picture = np.full((48, 64, 3), 100 + index, np.uint8)
    return CapturedFrame(index, index / 15, 1000.0 + index / 15, picture)


class Frames:
    """A live view that gives these frames, then is over or fails; None: nothing came in time."""

    def __init__(self, given: Sequence[CapturedFrame | Exception | None]) -> None:
        self.given = list(given)
        self.offset_s, self.odd, self.dropped = 1000.0 - time.monotonic() + 3.0, ("slow",), 5
        self.ending = Ending()
        self.timeouts: list[float] = []

    @property
    def over(self) -> bool:
        return not self.given

    def take(self, timeout_s: float) -> CapturedFrame | None:
        self.timeouts.append(timeout_s)
        one = self.given.pop(0)
        if isinstance(one, Exception):
            raise one
        return one


def setup(**changed: Any) -> track.Setup:
    settings = msgspec.structs.replace(Settings(), **changed)
    return track.Setup(2, None, settings, METHODS["default"], alone=False)


def prepared(kept: Path | None = None, **changed: Any) -> Prepared:
    return Prepared(VIEW, track.init(setup(**changed), EMPTY), ("odd view",), kept)


class Room:
    """A bus whose messages are kept, and steps that are told which guide they had."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.bus, self.guides, self.hurried = LocalBus(), [], []  # type: ignore[var-annotated]
        self.reports, self.ended = self.bus.subscribe(View), self.bus.subscribe(Ended)
        self.pulses, self.pictures = self.bus.subscribe(Pulse), self.bus.subscribe(Picture)
        self.answers = self.bus.subscribe(Answer)
        patch.setattr(track, "step", self.step)
        patch.setattr(viewer_process, "WAIT_SHARE", 0.0)

    def step(self, state: Any, shown: CapturedFrame, given: Guide | None) -> Any:
        self.guides.append(None if given is None else given.frames)
        self.hurried.append(shown.hurried)
        self.bus.publish(guide((0, shown.index)))
        report = View(
            frame=shown.index, captured_s=shown.captured_s, clock_s=shown.clock_s, viewer=2,
            width=8, height=1,
        )  # fmt: skip
        return state, report


def test_every_frame_is_reported_with_the_guide_of_the_one_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A frame that does not come in time is waited for again; three are counted at the end."""
    room = Room(monkeypatch)
    live = Frames([frame(0), None, frame(1), frame(3)])
    run(prepared(), live, room.bus, threading.Event())  # type: ignore[arg-type]
    assert [report.frame for report in room.reports.drain()] == [0, 1, 3]
    assert room.guides == [None, (0, 0), (0, 1)]
    assert live.timeouts == pytest.approx([1 / 15] * 4)
    assert [(end.viewer, end.frames, end.why) for end in room.ended.drain()] == [(2, 3, "")]
    assert room.pictures.drain() == []
    assert room.hurried == [True] * 3
    pulses = room.pulses.drain()
    assert [pulse.state for pulse in pulses][-1] == "ended"
    assert {pulse.process for pulse in pulses} == {"viewer 2"}
    last = pulses[-1]
    late = "3 of 3 frames came too late"
    assert last.detail.startswith("odd view\n")
    assert late in last.detail
    assert last.detail.endswith("\nslow")
    assert (last.frames, last.dropped, last.hurried, last.deadline_misses) == (3, 5, 3, 3)


def test_a_frame_in_time_is_in_no_hurry_and_its_picture_is_shown_where_that_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    room = Room(monkeypatch)
    live = Frames([frame(4), frame(5)])
    live.offset_s -= 3.0
    run(prepared(pictures=True), live, room.bus, threading.Event())  # type: ignore[arg-type]
    assert room.hurried == [False] * 2
    (picture,) = room.pictures.drain()  # the newest
    assert (picture.frame, picture.viewer) == (5, 2)
    assert (picture.captured_s, picture.clock_s) == (5 / 15, 1000.0 + 5 / 15)
    assert picture.jpeg[:2] == b"\xff\xd8"
    assert room.pulses.drain()[-1].detail == "odd view\nslow"


def test_a_viewer_that_is_stopped_looks_at_nothing_more(monkeypatch: pytest.MonkeyPatch) -> None:
    room, stop = Room(monkeypatch), threading.Event()
    stop.set()
    run(prepared(), Frames([frame(0)]), room.bus, stop)  # type: ignore[arg-type]
    assert room.reports.drain() == []
    assert [end.frames for end in room.ended.drain()] == [0]


def test_a_decoder_that_breaks_is_told_with_the_end_and_raised(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    room = Room(monkeypatch)
    live = Frames([frame(0), DecoderDied("cam2.avi", 1, "exit code 9")])
    with pytest.raises(DecoderDied):
        run(prepared(), live, room.bus, threading.Event())  # type: ignore[arg-type]
    (end,) = room.ended.drain()
    assert (end.frames, end.viewer) == (1, 2)
    assert "exit code 9" in end.why
    assert room.pulses.drain()[-1].state == "running"


def test_a_video_that_ends_early_is_warned_of_at_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    room = Room(monkeypatch)
    live = Frames([frame(0)])
    monkeypatch.setattr(viewer_process, "shortfall", lambda view, _: f"{view.source} was cut off")
    run(prepared(), live, room.bus, threading.Event())  # type: ignore[arg-type]
    assert "cam2.avi was cut off" in room.pulses.drain()[-1].detail


def test_what_the_integrator_missed_is_said_again_before_the_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    room = Room(monkeypatch)
    alive = SimpleNamespace(
        drain=lambda: [Alive("integrator", alive=len(room.guides) > 2)] if room.guides else []
    )
    monkeypatch.setattr(room.bus, "watch_alive", lambda: alive)
    monkeypatch.setattr(Guides, "heard", property(lambda _: 0))
    run(prepared(), Frames([frame(n) for n in range(3)]), room.bus, threading.Event())  # type: ignore[arg-type]
    assert [report.frame for report in room.reports.drain()] == [0, 1, 1, 2]


def test_a_background_that_is_learnt_is_told_and_looked_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Half a second of the settings is eight frames; the word comes before the first."""
    room = Room(monkeypatch)
    states = []
    step = room.step

    def watched(state: Any, shown: CapturedFrame, given: Guide | None) -> Any:
        if shown.index == 0:
            room.bus.publish(Command(what="background"))
        states.append(state)
        return step(state, shown, given)

    monkeypatch.setattr(track, "step", watched)
    steady = [msgspec.structs.replace(frame(n), picture=frame(40).picture) for n in range(10)]
    run(prepared(), Frames(steady), room.bus, threading.Event())  # type: ignore[arg-type]
    assert [answer.text for answer in room.answers.drain()] == ["camera 2: it has a new background"]
    levels = [float(state.silhouette.background.centre.mean()) for state in states]
    assert levels == pytest.approx([100.0] * 8 + [140.0] * 2)


def test_the_background_of_a_camera_alone_is_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A video's viewer learns it anew."""
    kept = []
    monkeypatch.setattr(viewer_process, "keep", lambda *given: kept.append(given))
    new = learn([np.full((48, 64, 3), 140, np.uint8)])
    camera = msgspec.structs.replace(VIEW, source=0)
    for view, folder in ((VIEW, tmp_path), (camera, None), (camera, tmp_path)):
        known = prepared(folder)._replace(view=view)
        assert _before(new, known.state, known).silhouette.background is new
    assert kept == [(tmp_path, camera, new)]


@pytest.mark.parametrize(("every", "frames"), [(1, 8), (3, 3), (8, 1)])
def test_a_background_takes_half_a_second_of_the_frames_that_are_looked_at(
    every: int, frames: int
) -> None:
    assert _empty_frames(track.init(setup(every=every), EMPTY), VIEW) == frames


def test_the_news_are_each_told_under_their_name() -> None:
    guides, shedder = Guides(Taken(), 2), LoadShedder(1 / 15, 1)  # type: ignore[arg-type]
    guides.misses, shedder.frames, shedder.in_turn = 7, 8, 9
    live = SimpleNamespace(odd=("slow", "gone"), dropped=6)
    assert _news(live, guides, shedder, ("a", "b")) == {  # type: ignore[arg-type]
        "detail": "a\nb\nslow\ngone",
        "dropped": 6,
        "guide_misses": 7,
        "hurried": 8,
        "in_turn": 9,
        "malformed": 3,
        "foreign": 4,
    }


def answering(
    patch: pytest.MonkeyPatch, start_after: int, silent: Sequence[int] = ()
) -> list[ClockQuestion]:
    """A room's clock 40 s ahead, which knows the start after so many questions."""
    asked: list[ClockQuestion] = []

    def exchanged(_bus: object, question: ClockQuestion) -> tuple[Exchange, ClockAnswer] | None:
        asked.append(question)
        if len(asked) in silent:
            return None
        sent_s = float(len(asked))
        start_s = 77.5 if len(asked) > start_after else None
        return Exchange(sent_s, sent_s + 40.001, sent_s + 0.002), ClockAnswer(
            now_s=sent_s + 40.001, start_s=start_s
        )

    patch.setattr(clock, "exchanged", exchanged)
    return asked


def test_a_run_begins_when_its_start_is_known_and_the_clock_was_asked_five_times(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A viewer says that it is ready with the fifth question; one that is not answered is none."""
    asked = answering(monkeypatch, start_after=0, silent=(2,))
    room = met(LocalBus(), 2, threading.Event())
    assert room is not None
    assert room.start_s == 77.5
    assert room.offset_s == pytest.approx(40.0)
    assert [question.ready for question in asked] == [False] * 5 + [True]
    assert {question.viewer for question in asked} == {2}
    asked = answering(monkeypatch, start_after=7)
    assert met(LocalBus(), 1, threading.Event()) is not None
    assert len(asked) == 8


def test_a_viewer_that_is_stopped_or_waits_too_long_does_not_begin(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    answering(monkeypatch, start_after=10**9)
    stop = threading.Event()
    stop.set()
    assert met(LocalBus(), 1, stop) is None
    monkeypatch.setattr(viewer_process, "BEGIN_S", 0.05)
    with pytest.raises(StartError, match=r"^viewer 1 is ready, but .* within 0\.05 s: start the"):
        met(LocalBus(), 1, threading.Event())


def test_a_view_has_the_rate_of_both_where_both_videos_are_here(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    here = tmp_path / "cam1.avi"
    here.write_bytes(b"")
    both = [msgspec.structs.replace(VIEW, number=n, fps=12.0) for n in (1, 2)]
    monkeypatch.setattr(viewer_process, "open_clip", lambda *_: SimpleNamespace(views=both))
    named: list[Any] = []
    monkeypatch.setattr(viewer_process, "sources_of", lambda _: named)
    decoder: Any = None
    first, gone = str(here), str(tmp_path / "none.avi")
    for sources, found in (
        ([first, first], both[1]),
        ([first], VIEW),
        ([first, gone], VIEW),
        ([0, first], VIEW),
    ):
        named[:] = [SimpleNamespace(source=source) for source in sources]
        assert _beside_the_other(VIEW, Settings(), decoder) is found


@pytest.mark.parametrize(("odd", "cameras"), [("", 0), ("no empty room", 2)])
def test_a_viewer_is_prepared_with_its_camera_its_warnings_and_whether_it_is_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, odd: str, cameras: int
) -> None:
    somebody = Landmarks(((1.0, 2.0),) * 15, (0.5,) * 15)
    opening = SimpleNamespace(background=EMPTY, odd=odd, somebody=somebody)
    rig = SimpleNamespace(cameras=("first",)) if cameras else None
    clip = SimpleNamespace(views=[VIEW], warnings=("old clip",), rig=rig)
    monkeypatch.setattr(viewer_process, "open_clip", lambda *_: clip)
    monkeypatch.setattr(viewer_process, "opening_of_run", lambda *_: opening)
    named = [SimpleNamespace(source=0)] * max(1, cameras)
    monkeypatch.setattr(viewer_process, "sources_of", lambda _: named)
    made: list[Any] = []
    init = track.init

    def begun(setup: track.Setup, background: Any, somebody: Landmarks) -> track.State:
        made.append((setup, background, somebody))
        return init(setup._replace(camera=None), background, somebody=somebody)

    monkeypatch.setattr(track, "init", begun)
    settings = msgspec.structs.replace(Settings(), mode="paper")
    found = _prepared(settings, 2, ProcessContext(kept=tmp_path))
    (setup, background, first) = made[0]
    assert (setup.viewer, setup.camera) == (2, "first" if cameras else None)
    assert setup.method is METHODS["paper"]
    assert setup.alone == (cameras == 0)
    assert (background, first) == (EMPTY, somebody)
    assert found.view is VIEW
    assert found.warnings == (("old clip", odd) if odd else ("old clip",))
    assert found.kept == tmp_path
