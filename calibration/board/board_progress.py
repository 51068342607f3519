"""What the board has shown to cameras so far, while it is held before them; and what is missing."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.board.board_coverage import covered
from calibration.board.still_board import MOVED, SHORTEST_S
from common.body.body import Vector

ALONE: Final = 20
"""Poses for each camera that are advised."""
SHARED: Final = 10
"""Of these, the ones that another camera sees at once."""
HOLD_S: Final = 2.0
"""How long each pose is held, seconds, where several pictures a second are looked at."""
PARTS: Final = (3, 3)
"""Rows and columns of the parts of a picture that are named."""
PART_COVERED: Final = 0.4
"""Share of a part in which the board was, from which on it counts as covered."""
ROW_WORDS: Final = ("upper", "middle", "lower")
COLUMN_WORDS: Final = ("left", "centre", "right")
MIRRORED: Final = 3
"""Sights of a board in a mirror that show a mirrored picture."""
FEWEST: Final = 4
"""Corners by which it is seen whether the board moved."""


class SeenBoard(NamedTuple):
    """What one camera has been shown."""

    size_px: tuple[int, int]
    cells: NDArray[np.int64]
    """(rows, CELLS) how often each cell was inside the resting board."""
    poses: int = 0
    """Rests so far."""
    px: Vector | None = None
    """(n, 2) the corners as the present rest began; None: no board."""
    since_s: float = 0.0
    """When that was."""
    is_counted: bool = False
    """Whether the present rest was counted."""
    shared: int = 0
    """Rests that another camera saw too."""
    is_shared: bool = False
    """Whether the present rest is one of those."""
    in_mirror: int = 0
    """Pictures in which the board could be read in a mirror alone."""

    @property
    def is_mirrored(self) -> bool:
        """Whether its picture is a mirror image."""
        return self.in_mirror >= MIRRORED


class BoardProgress(NamedTuple):
    """What all cameras have been shown."""

    cameras: tuple[SeenBoard, ...]


class Sight(NamedTuple):
    """The board in one picture."""

    px: Vector | None
    """(n, 2) its corners, NaN where hidden; None: it is not seen."""
    in_mirror: bool = False
    """Whether it could be read only in the mirror image of the picture."""


def init(sizes_px: Sequence[tuple[int, int]]) -> BoardProgress:
    """Nothing was shown yet, to cameras of these pictures' sizes."""
    cameras = tuple(SeenBoard(size, covered(np.empty((0, 1, 2)), size)) for size in sizes_px)
    return BoardProgress(cameras)


def step(state: BoardProgress, time_s: float, sights: Sequence[Sight]) -> BoardProgress:
    """After one more picture of each camera, taken at about one time."""
    cameras = [
        _looked(seen, time_s, sight) for seen, sight in zip(state.cameras, sights, strict=True)
    ]
    if sum(seen.is_counted for seen in cameras) > 1:
        cameras = [_together(seen) for seen in cameras]
    return BoardProgress(tuple(cameras))


def _together(seen: SeenBoard) -> SeenBoard:
    """A camera as it and another see the board at rest: each pose counts once."""
    if not seen.is_counted or seen.is_shared:
        return seen
    return seen._replace(shared=seen.shared + 1, is_shared=True)


def _looked(seen: SeenBoard, time_s: float, sight: Sight) -> SeenBoard:
    if sight.in_mirror:
        return seen._replace(
            px=None, is_counted=False, is_shared=False, in_mirror=seen.in_mirror + 1
        )
    if sight.px is None:
        return seen._replace(px=None, is_counted=False, is_shared=False)
    if seen.px is None or _has_moved(seen.px, sight.px, seen.size_px[0]):
        return seen._replace(px=sight.px, since_s=time_s, is_counted=False, is_shared=False)
    if seen.is_counted or time_s - seen.since_s < SHORTEST_S:
        return seen
    cells = seen.cells + covered(sight.px[None], seen.size_px)
    return seen._replace(cells=cells, poses=seen.poses + 1, is_counted=True)


def _has_moved(before: Vector, now: Vector, width_px: int) -> bool:
    steps_px = np.linalg.norm(now - before, axis=-1)
    both = np.isfinite(steps_px)
    if np.count_nonzero(both) < FEWEST:
        return True
    return bool(np.sqrt(np.mean(steps_px[both] ** 2)) > MOVED * width_px)


def missing_parts(seen: SeenBoard) -> list[str]:
    """The parts of a camera's picture, in words, in which the board has not been."""
    rows, columns = PARTS
    found = []
    for row, band in enumerate(np.array_split(seen.cells > 0, rows, axis=0)):
        for column, part in enumerate(np.array_split(band, columns, axis=1)):
            if part.mean() < PART_COVERED:
                words = (ROW_WORDS[row], COLUMN_WORDS[column])
                found.append("in the middle" if words == ("middle", "centre") else " ".join(words))
    return found


def is_enough(state: BoardProgress) -> bool:
    """Whether a calibration by what was shown will be good."""
    return not any(_wanted(state, n) for n in range(len(state.cameras)))


def words_of(state: BoardProgress, names: Sequence[str], hold_s: float = HOLD_S) -> list[str]:
    """How far each camera is and what it still needs, a line each; then what to do at the end.

    Args:
        state: What was shown.
        names: Of the cameras.
        hold_s: How long the board must be held still, seconds.
    """
    lines = []
    for n, (name, seen) in enumerate(zip(names, state.cameras, strict=True)):
        share = np.count_nonzero(seen.cells) / seen.cells.size
        poses = f"{seen.poses} pose{'' if seen.poses == 1 else 's'}"
        line = f"{name}: {poses}, {share:.0%} of its picture"
        line += f", {seen.shared} together with another camera" if len(names) > 1 else ""
        wanted = _wanted(state, n, hold_s)
        lines.append(f"{line}. {'; '.join(wanted).capitalize() if wanted else 'Enough'}.")
    if is_enough(state):
        lines.append("Last, lay the board flat on the floor at two or three places that all see.")
    return lines


def _wanted(state: BoardProgress, number: int, hold_s: float = HOLD_S) -> list[str]:
    seen = state.cameras[number]
    if seen.is_mirrored:
        return [
            "Its picture is mirrored, in which no board can be read: switch mirroring off in the "
            "camera's own program or driver"
        ]
    wanted = []
    if seen.poses < ALONE:
        wanted.append(f"{ALONE - seen.poses} more, held still for {hold_s:.0f} s each, tilted")
    missing = missing_parts(seen)
    if missing:
        wanted.append(f"hold it {', '.join(missing)}")
    if len(state.cameras) > 1 and seen.shared < SHARED:
        wanted.append(f"{SHARED - seen.shared} more that another camera sees too")
    return wanted
