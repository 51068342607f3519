"""Streams of many performances: joined from single ones, and the evaluation of their events."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLE_NAMES
from recognizer import events
from recognizer.features import Rows, features, with_pose
from recognizer.performance_judge import Event
from recognizer.postures import DensityModel

PAUSE_FRAMES: Final = (15, 60)
"""Range of the standing time between two joined performances."""
BRIDGE_FRAMES: Final = 8
"""Number of frames from the last pose of a performance to the stance of the next."""
SWAY_DEG: Final = 1.0
"""Standard deviation of a standing person's angles, which includes the tracker's error."""
SWAY_LEGS: Final = 0.002
"""Standard deviation of the root's sway in a stance, leg lengths."""
LEFT: Final = 0.3
"""Distance of feature vectors, one limb by 17 degrees, within which a performance is over."""
ANGLES: Final = len(ANGLE_NAMES)
PLACE: Final = [ANGLES, ANGLES + 2]
"""Columns of the root's place on the floor."""


class Act(NamedTuple):
    """One performance within a stream."""

    name: str
    first: int
    last: int


class Stream(NamedTuple):
    """A tracked stream, and the performances in it."""

    name: str
    rows: Rows
    acts: tuple[Act, ...]


class Found(NamedTuple):
    """Evaluation of a stream's events."""

    stream: str
    frames: int
    performances: int
    delays: tuple[int, ...]
    """Frames from the end of each found performance to its event."""
    missed: tuple[Act, ...]
    false: tuple[Event, ...]
    """Number of events of nothing, of another posture, or repeated."""


def spotted(model: DensityModel, rows: Rows) -> list[tuple[Event, int]]:
    """The events of a stream, each with the frame of its first report."""
    state, told = events.init(model), dict[int, tuple[Event, int]]()

    def take(event: Event | None, frame: int) -> None:
        if event is not None:
            told[event.first] = (event, told.get(event.first, (event, frame))[1])

    for frame, row in enumerate(rows):
        state, doing = events.step(state, row)
        take(doing.event, frame)
    take(events.finish(state), len(rows) - 1)
    return list(told.values())


def found(model: DensityModel, stream: Stream) -> Found:
    """Match a stream's events with its performances: one event each, the rest is false."""
    delays: dict[Act, int] = {}
    false = []
    for event, told in spotted(model, stream.rows):
        act = max(stream.acts, key=lambda one: _overlap(event, one), default=None)
        if act is None or act in delays or act.name != event.name or _overlap(event, act) <= 0:
            false.append(event)
        else:
            delays[act] = told - act.last
    missed = tuple(act for act in stream.acts if act not in delays)
    count = len(stream.acts)
    return Found(stream.name, len(stream.rows), count, tuple(delays.values()), missed, tuple(false))


def _overlap(event: Event, act: Act) -> int:
    return min(event.last, act.last) - max(event.first, act.first)


def joined(name: str, performances: Sequence[tuple[str, Rows]], seed: int) -> Stream:
    """Single performances of one person as a stream: in random order, with standing between.

    Args:
        name: Name of the stream.
        performances: Posture and rows (n, 20) of each; they begin in standing.
        seed: Seed of order, pauses and sway.
    """
    rng = np.random.default_rng(seed)
    turns = rng.permutation(len(performances)).tolist()
    given = [(performances[i][0], with_pose(performances[i][1])) for i in turns]
    pieces, acts = [_pause(given[0][1][0], given[0][1][0], rng)], []
    for i, (posture, shown) in enumerate(given):
        rows, at = shown.copy(), sum(map(len, pieces))
        rows[:, PLACE] += (pieces[-1][-1] - rows[0])[PLACE]
        after = (given[i + 1][1] if i + 1 < len(given) else rows)[0].copy()
        after[PLACE] = rows[-1, PLACE]
        rows = np.concatenate([rows, _pause(rows[-1], after, rng)])
        gone = np.linalg.norm(features(rows) - features(after[np.newaxis]), axis=1)
        acts.append(Act(posture, at, at + int(np.flatnonzero(gone > LEFT)[-1])))
        pieces.append(rows)
    return Stream(name, np.concatenate(pieces), tuple(acts))


def _pause(
    before: NDArray[np.float64], after: NDArray[np.float64], rng: np.random.Generator
) -> Rows:
    """Transition of a person to the stance in which the next performance begins."""
    length = int(rng.integers(*PAUSE_FRAMES))
    way = np.clip((np.arange(length) + 1) / BRIDGE_FRAMES, 0.0, 1.0)[:, np.newaxis]
    change = after - before
    change[:ANGLES] = (change[:ANGLES] + 180.0) % 360.0 - 180.0
    size = np.repeat([SWAY_DEG, SWAY_LEGS], [ANGLES, len(before) - ANGLES])
    return before + way * change + rng.normal(0.0, size, (length, len(before)))
