"""Frames of a live view at their moments, from a decoder and a clock made by hand."""

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from common.body.observation import Landmarks
from common.rig.upright import Upright
from common.video.clip_facts import ClipView
from common.video.pictures import CameraLost, Decoded, Ending, Wanted
from viewer import capture
from viewer.capture import Live, RoomClock, recorded
from viewer.captured_frame import CapturedFrame

PICTURE = np.zeros((6, 8, 3), np.uint8)


class Frames:
    """A decoder that gives these, then ends, or waits until it is stopped."""

    def __init__(self, *given: tuple[int, float]) -> None:
        self.given, self.asked, self.closed = given, [], 0  # type: ignore[var-annotated]
        self.ending = Ending()

    def frames(self, source: object, size: object, wanted: Wanted) -> Iterator[Decoded]:
        self.asked.append((source, size, wanted))
        for index, grabbed_s in self.given:
            yield Decoded(index, grabbed_s, PICTURE)

    def stop(self) -> None:
        """Nothing to be stopped."""

    def close(self) -> None:
        self.closed += 1


class Outside:
    """A source that sees one person, and keeps how long it may take."""

    def __init__(self, large: tuple[int, int] | None = None) -> None:
        self.large, self.odd, self.waits = large, ("slow",), []  # type: ignore[var-annotated]

    def people(self, decoded: Decoded, wait_s: float) -> tuple[Landmarks, ...]:
        self.waits.append(wait_s)
        return (Landmarks(((float(decoded.index), 0.0),) * 15, (0.5,) * 15),)


def taken(live: Live, frames: int) -> list[CapturedFrame]:
    found: list[CapturedFrame] = []
    while len(found) < frames:
        one = live.take(5.0)
        assert one is not None
        found.append(one)
    return found


UPRIGHT = Upright(1, 6, 8, 6, 8)


def view(**changed: Any) -> ClipView:
    fields = {"number": 1, "source": "cam1.avi", "source_size": (8, 6), "size": (8, 6)}
    return ClipView(**{**fields, "fps": 10.0, "frames": 4, **changed})


def test_a_recorded_view_asks_for_every_third_frame_from_a_start() -> None:
    decoder: Any = Frames((6, 0.0), (9, 0.0))
    source: Any = Outside((16, 12))
    found = list(recorded(view(late_s=0.05), 3, decoder, source, start=6))
    assert decoder.asked == [("cam1.avi", (8, 6), Wanted(3, 6, (16, 12), 0))]
    assert [one.index for one in found] == [6, 9]
    times = np.array([[one.captured_s, one.clock_s, one.next_s or 0.0] for one in found])
    assert times == pytest.approx(np.array([[0.55, 0.55, 0.85], [0.85, 0.85, 1.15]]))
    assert [one.landmarks[0].joints_px[0][0] for one in found] == [6.0, 9.0]
    assert source.waits == [30.0, 30.0]
    plain: Any = Frames((0, 0.0))
    assert [one.landmarks for one in recorded(view(), 1, plain)] == [()]


def test_of_the_faster_view_only_the_picked_frames_are_looked_at() -> None:
    decoder: Any = Frames(*[(n, 0.0) for n in range(6)])
    found = list(recorded(view(picked=(0, 2, 5)), 2, decoder))
    assert [one.index for one in found] == [0, 2, 5]
    assert decoder.asked[0][2].every == 1


def test_a_live_file_gives_each_frame_when_the_rooms_clock_has_its_moment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What was due before the viewer began is counted and not given out."""
    decoder = Frames(*[(n, 0.0) for n in range(4)])
    monkeypatch.setattr(capture, "Decoder", lambda: decoder)
    source: Any = Outside()
    start_s = time.monotonic() - 0.15
    with Live(view(upright=UPRIGHT), 1, RoomClock(start_s + 500.0, 500.0), source) as live:
        first, second = taken(live, 2)
        assert time.monotonic() >= start_s + 0.3
        assert live.take(5.0) is None
        assert live.over
        assert (live.dropped, live.odd, live.offset_s) == (2, ("slow",), 500.0)
    assert (first.index, second.index) == (2, 3)
    assert first.captured_s == pytest.approx(0.2)
    assert first.clock_s == pytest.approx(start_s + 500.2)
    assert first.next_s == pytest.approx(0.3)
    assert first.upright is UPRIGHT
    assert first.landmarks[0].joints_px[0][0] == 2.0
    assert source.waits == [pytest.approx(0.1)] * 2
    assert decoder.closed >= 1


@pytest.mark.parametrize(
    ("since_s", "every", "first"), [(3.0, 2, 30), (0.04, 1, 0), (-5.0, 1, 0), (3.04, 3, 30)]
)
def test_a_cameras_frames_go_on_from_where_time_has_them(
    monkeypatch: pytest.MonkeyPatch, since_s: float, every: int, first: int
) -> None:
    """Whole counts of those that are looked at, ten a second; a camera's own times are set back."""
    now_s = time.monotonic()
    decoder = Frames((0, now_s), (every, now_s + 0.01))
    monkeypatch.setattr(capture, "Decoder", lambda: decoder)
    room = RoomClock(now_s + 700.0 - since_s, 700.0)
    camera = view(source=0, late_s=0.25, frames=0, upright=UPRIGHT)
    with Live(camera, every, room, clock=begun_before(now_s)) as live:
        one, other = taken(live, 2)
        with pytest.raises(CameraLost):
            live.take(5.0)
        assert not live.over
        assert live.odd == ()
    assert (one.index, other.index) == (first, first + every)
    assert one.clock_s == pytest.approx(now_s + 700.0)
    assert one.captured_s == pytest.approx(now_s + 699.75)
    assert one.upright is UPRIGHT
    assert (one.next_s, one.landmarks) == (None, ())


def begun_before(now_s: float) -> Any:
    """A clock that stands a second before the first frame when it begins, then after the last."""
    told = iter([now_s - 1.0])
    return lambda: next(told, now_s + 10.0)


def test_the_rooms_clock_may_be_set_while_a_view_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(capture, "Decoder", Frames)
    with Live(view(), 1, RoomClock(20.0, 3.0)) as live:
        live.set_offset(4.5)
        assert live.offset_s == 4.5
