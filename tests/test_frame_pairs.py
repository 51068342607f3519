"""The views of a clip: learnt side by side, and their frames of one instant together."""

import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest

from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from common.video.clips import open_clip
from common.video.pictures import ALL, Decoded, Ending, Size, Source, Wanted
from runtime.offline.frame_pairs import instants, openings, share_of
from viewer.captured_frame import CapturedFrame

SLOW_S = 0.3


class Slow:
    """A film that comes picture by picture, for minutes."""

    ending = Ending()

    def frames(self, _source: Source, size: Size, _wanted: Wanted = ALL) -> Iterator[Decoded]:
        for index in range(1000):
            time.sleep(SLOW_S)
            yield Decoded(index, 0.0, np.zeros((size[1], size[0], 3), np.uint8))


class Stopped(Slow):
    """Ctrl-C comes while it is read."""

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        yield next(super().frames(source, size, wanted))
        raise KeyboardInterrupt


def test_who_stops_it_does_not_wait_for_the_other_view(clip: Path) -> None:
    settings = Settings(clip=str(clip))
    began_s = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        openings(open_clip(settings), settings.silhouette, {1: Stopped(), 2: Slow()})
    assert time.monotonic() - began_s < 8 * SLOW_S


class Quick:
    """A film of a few pictures."""

    ending = Ending()

    def __init__(self, frames: int) -> None:
        self._frames = frames

    def frames(self, _source: Source, size: Size, _wanted: Wanted = ALL) -> Iterator[Decoded]:
        for index in range(self._frames):
            yield Decoded(index, 0.0, np.zeros((size[1], size[0], 3), np.uint8))


def test_a_camera_twice_as_fast_is_paired_at_the_very_moments_of_the_slower(clip: Path) -> None:
    opened = open_clip(Settings(clip=str(clip)))
    slow, fast = (
        msgspec.structs.replace(view, fps=fps, capture_s=tuple(n / fps for n in range(9)))
        for view, fps in zip(opened.views, (15.0, 30.0), strict=True)
    )
    opened = msgspec.structs.replace(opened, views=(slow, fast), every=1)
    found = [
        (now[1].index, now[2].index)
        for now in instants(opened, {1: Quick(3), 2: Quick(6)}, {})
        if len(now) == 2
    ]
    assert found == [(0, 0), (1, 2), (2, 4)]


def frame(index: int) -> CapturedFrame:
    return CapturedFrame(index, 0.0, 0.0, np.zeros((0, 0, 3), np.uint8))


def test_the_share_of_a_clip_is_that_of_the_view_that_is_farthest(clip: Path) -> None:
    """By hand: frame 4 is the fifth of 10, frame 2 the third of 20; a camera has no end."""
    opened = open_clip(Settings(clip=str(clip)))
    first, second = (
        msgspec.structs.replace(view, frames=frames)
        for view, frames in zip(opened.views, (10, 20), strict=True)
    )
    opened = msgspec.structs.replace(opened, views=(first, second))
    assert share_of(opened, {1: frame(4), 2: frame(2)}) == 0.5
    assert share_of(opened, {1: frame(4), 2: frame(14)}) == 0.75
    assert share_of(opened, {2: frame(2)}) == 0.15
    assert share_of(opened, {1: frame(11)}) == 1.0
    camera = msgspec.structs.replace(second, frames=0)
    opened = msgspec.structs.replace(opened, views=(first, camera))
    assert share_of(opened, {1: frame(1), 2: frame(100)}) == 0.2
    assert share_of(opened, {2: frame(100)}) == 0.0


class Asked(Quick):
    """Notes what it is asked for, and begins there."""

    def __init__(self, frames: int) -> None:
        super().__init__(frames)
        self.wanted: list[tuple[Source, Size, Wanted]] = []

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        self.wanted.append((source, size, wanted))
        for one in super().frames(source, size):
            if one.index >= wanted.start and one.index % wanted.every == 0:
                yield one


def test_each_view_goes_on_from_its_own_frame(clip: Path) -> None:
    """Every second frame is looked at; view 1 goes on from 4, view 2 from its first."""
    opened = open_clip(Settings(clip=str(clip), every=2))
    readers: dict[ViewerNumber, Asked] = {1: Asked(7), 2: Asked(6)}
    found = [
        {n: one.index for n, one in now.items()} for now in instants(opened, readers, {}, {1: 4})
    ]
    assert found == [{2: 0}, {2: 2}, {1: 4, 2: 4}, {1: 6}]
    assert [reader.wanted[0][2] for reader in readers.values()] == [Wanted(2, 4), Wanted(2, 0)]
    assert [reader.wanted[0][:2] for reader in readers.values()] == [
        (view.source, view.size) for view in opened.views
    ]


class Person:
    """A source outside that tells how it was asked."""

    large = (640, 480)

    def __init__(self) -> None:
        self.asked: list[int] = []
        self.odd: list[str] = []

    def people(self, decoded: Decoded, _patience_s: float) -> tuple[()]:
        self.asked.append(decoded.index)
        return ()


def test_landmarks_are_asked_of_the_source_of_their_view(clip: Path) -> None:
    opened, source = open_clip(Settings(clip=str(clip))), Person()
    readers: dict[ViewerNumber, Asked] = {1: Asked(2), 2: Asked(3)}
    assert len([*instants(opened, readers, {2: source})]) == 3  # type: ignore[dict-item]
    assert source.asked == [0, 1, 2]
    assert readers[2].wanted[0][2].large == (640, 480)
    assert readers[1].wanted[0][2].large is None
