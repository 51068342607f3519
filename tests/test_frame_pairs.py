"""The views of a clip: learnt side by side, and their frames of one instant together."""

import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest

from common.config.settings import Settings
from common.video.clips import open_clip
from common.video.decoding import ALL, Decoded, Ending, Size, Source, Wanted
from tritrack.offline.frame_pairs import instants, openings

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
