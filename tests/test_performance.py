"""Every instant of a clip: whatever the mode, its state is kept and goes on to the same bodies."""

import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from spoiling import copied, refilmed
from staging import PERIOD_S, RIG, report

from common.bus.instant import Instant
from common.bus.messages import Body, Guide, View, ViewerNumber
from common.config.settings import Settings
from common.method import DEFAULT, Mode
from common.video.clip_facts import Clip, ClipView, Meta
from integrator import merge_state
from integrator.people import recognition
from runtime.offline import performance
from runtime.offline.lockstep import Decoders, track_clip
from runtime.offline.performance import STAGE, LockstepState, Prepared, Watch, performed
from runtime.offline.rig_check import Witness
from runtime.unfinished.state_codec import packed, unpacked
from runtime.unfinished.work import Course, Kept
from viewer.captured_frame import CapturedFrame

VIEWS: tuple[ViewerNumber, ...] = (1, 2)

STOP_AT = 30


class Stopped(Exception):
    """The run was cut short."""


class Stopping:
    """Keeps each state as bytes; the first run is cut short, the second goes on from the last."""

    due = True

    def __init__(self) -> None:
        self.saved: tuple[str, bytes, dict[str, int]] | None = None
        self.kept: dict[str, list[Any]] = {}
        self.saves, self.stops = 0, True

    def messages(self, name: str) -> Kept:
        length = self.saved[2].get(name, 0) if self.saved else 0
        self.kept[name] = self.kept.get(name, [])[:length]
        return self.kept[name]

    def resumed(self, stage: str, kind: type[Any]) -> Any:
        return unpacked(self.saved[1], kind) if self.saved and self.saved[0] == stage else None

    def restart(self) -> None:
        self.saved = None

    def save(self, stage: str, state: object) -> None:
        lengths = {name: len(messages) for name, messages in self.kept.items()}
        self.saved, self.saves = (stage, packed(state), lengths), self.saves + 1
        if self.stops and self.saves % STOP_AT == 0:
            raise Stopped


WAYS: list[tuple[Mode, tuple[ViewerNumber, ...], bool]] = [
    ("default", (1, 2), True),
    ("default", (1, 2), False),
    ("default", (2,), True),
    ("default", (1,), False),
    ("paper", (1, 2), True),
    ("paper", (1,), True),
    ("thesis", (1,), False),
]


@pytest.mark.slow
@pytest.mark.parametrize(("mode", "views", "calibrated"), WAYS)
def test_a_run_that_stops_every_thirty_instants_gives_the_same_bodies(
    mode: Mode, views: tuple[ViewerNumber, ...], calibrated: bool, clip: Path, tmp_path: Path
) -> None:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[:45])
    if not calibrated:
        (folder / "calibration.json").unlink()
    settings, work = Settings(clip=str(folder), mode=mode), Stopping()
    with Decoders() as decoders:
        whole = track_clip(settings, decoders, views)
        while True:
            try:
                parts = track_clip(settings, decoders, views, course=Course(work=work))
                break
            except Stopped:
                continue
    assert work.saves > STOP_AT
    assert list(parts.bodies) == list(whole.bodies)
    for facts in (parts.facts, whole.facts):
        for measured in ("seconds", "frames_a_second"):
            facts.pop(measured)
    assert parts.facts == whole.facts


FRAMES = 4
MOVED_AT = 2
"""From this frame on a camera is reported to be moved."""


class Noted:
    """Keeps every state that it is handed, and is always due."""

    due = True

    def __init__(self, resumed: LockstepState | None = None) -> None:
        self.left, self.states, self.bodies = resumed, list[LockstepState](), list[Body]()

    def messages(self, _: str) -> list[Body]:
        return self.bodies

    def resumed(self, _stage: str, _kind: object) -> Any:
        return self.left

    def restart(self) -> None:
        raise AssertionError("no clock is off")

    def save(self, stage: str, state: object) -> None:
        assert stage == STAGE
        assert isinstance(state, LockstepState)
        self.states.append(state)


def prepared() -> Prepared:
    """A clip of four instants; a viewer's state says whose it is and counts what that saw."""
    views = tuple(ClipView(n, f"cam{n}.avi", (160, 120), (160, 120), 15.0, FRAMES) for n in VIEWS)
    clip = Clip("made up", views, 1, RIG, Meta())
    state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)
    return Prepared(clip, {}, {1: 100, 2: 200}, recognition.State(state), [], 0.0)  # type: ignore[dict-item]


@pytest.fixture
def guided(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int | None]]:
    """Every look of a viewer, without pictures: its state, and the frame of the guide it had."""
    given: list[tuple[int, int | None]] = []

    def look(state: int, frame: CapturedFrame, guide: Guide | None) -> tuple[int, View]:
        given.append((state, None if guide is None else guide.frames[0]))
        seen = report(state // 100, frame=frame.index, captured_s=frame.captured_s)
        return state + 1, seen

    def merged(state: Any, pair: Instant, _: object) -> tuple[Any, Body, Guide]:
        assert [one and one.viewer for one in pair.views] == [1, 2]
        n, moment = pair.newest.frame, dict[str, Any](captured_s=0.0, clock_s=0.0)
        moved = (1,) if n == MOVED_AT else ()
        body = Body(frame=n, status="empty", views="none", moved=moved, **moment)
        return state, body, Guide(frame=n, frames=(n, n), **moment)

    def frames(_clip: object, _reels: object, _sources: object, starts: dict[int, int]) -> Any:
        for n in range(starts.get(2, 0), FRAMES):
            yield dict.fromkeys(VIEWS, CapturedFrame(n, n / 15, n / 15, np.zeros((0, 0, 3), "u1")))

    monkeypatch.setattr("viewer.track.step", look)
    monkeypatch.setattr("integrator.merge.step", merged)
    monkeypatch.setattr(performance, "instants", frames)
    return given


def test_each_view_goes_on_from_its_own_state_by_the_guide_of_the_instant_before(
    guided: list[tuple[int, int | None]],
) -> None:
    told: list[float] = []
    shown: list[int] = []
    course = Course(told.append)
    watch = Watch(lambda *of: shown.append(of[2][0].frame))
    done = performed(prepared(), {}, Witness(), watch, course)
    assert sorted(guided[:4]) == [(100, None), (101, 0), (200, None), (201, 0)]
    assert [body.frame for body in done.bodies] == shown == [0, 1, 2, 3]
    assert told == [0.25, 0.5, 0.75, 1.0]
    assert done.seconds.keys() == {"viewers", "integrator", "following"}
    assert min(done.seconds.values()) > 0.0
    assert done.seconds["following"] >= done.seconds["viewers"] + done.seconds["integrator"]


def test_all_that_is_remembered_is_in_every_state_that_is_saved(
    guided: list[tuple[int, int | None]],
) -> None:
    """Also what is remembered elsewhere: a camera that was moved stays so for who goes on."""
    work, witness = Noted(), Witness()
    performed(prepared(), {}, witness, None, Course(work=work))
    assert [state.starts for state in work.states] == [{1: n, 2: n} for n in (1, 2, 3, 4)]
    assert [state.witness.moved for state in work.states] == [False, False, True, True]
    assert [len(state.witness.rows[0][2]) for state in work.states] == [2] * FRAMES, "one list"
    assert [state.calibration.now_s for state in work.states] == [n / 15 for n in range(FRAMES)]
    spent_s = [state.spent["following"] for state in work.states]
    assert sorted(set(spent_s)) == spent_s

    again, later = Noted(work.states[2]), Witness()
    guided.clear()
    done = performed(prepared(), {}, later, None, Course(work=again))
    assert sorted(guided) == [(103, 2), (203, 2)]
    assert [body.frame for body in done.bodies] == [3]
    assert later.seen.moved
    assert done.seconds["following"] > spent_s[2]
    assert len(done.noticed.useless) == 2


def test_views_side_by_side_take_short_turns_and_only_meanwhile() -> None:
    """A fifth of a millisecond; also where what is done fails, turns are as long as before."""
    before_s = sys.getswitchinterval()
    meanwhile_s = list[float]()
    with suppress(ValueError), performance._side_by_side(2) as pool:
        meanwhile_s.append(sys.getswitchinterval())
        meet = threading.Barrier(2)
        assert len([*pool.map(lambda _: meet.wait(20.0), range(2))]) == 2
        raise ValueError
    assert meanwhile_s == [pytest.approx(0.0002)]
    assert sys.getswitchinterval() == before_s
