"""Bundle adjustment of all cameras and all places of the board."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from calibration.board.lens_start import Lens, Place, chained, undone
from common.body.body import Vector

SIGMA_PX: Final = 0.05
"""Prior standard deviation of a resting corner in the picture, pixels."""
FINEST_PX: Final = 0.01
"""Smallest standard deviation of a sight's corners, pixels."""
BELIEVED: Final = 3.0
"""Weight of SIGMA_PX in a sight's standard deviation, as a number of corners."""
SOFT: Final = 3.0
"""Residual beyond which the cost grows linearly, sigmas."""
OFF_MIDDLE: Final = 0.03
"""Standard deviation of a lens's centre about the middle of the picture, widths."""
SQUARE: Final = 0.002
"""Standard deviation of fy / fx about 1."""
BENT: Final = 0.5
"""Standard deviations of k1 and k2."""
LENS: Final = 6
"""Numbers of a lens: fx, fy, cx, cy, k1, k2."""
PLACE: Final = 6
"""Numbers of a place: a turn and a shift."""


class Sight(NamedTuple):
    """The corners that one camera shows at one rest of the board."""

    camera: int
    rest: int
    places: Vector
    """(n, 3) places of these corners on the board, metres, in its axes."""
    px: Vector
    """(n, 2) pixels."""
    sigma_px: float = SIGMA_PX


class Start(NamedTuple):
    """Start of a fit; fields as in `Fit`."""

    lenses: Vector
    cameras: tuple[Place, ...]
    boards: tuple[Place, ...]


class Fit(NamedTuple):
    """The fitted cameras and boards."""

    lenses: Vector
    """(cameras, 6)"""
    cameras: tuple[Place, ...]
    """From the first camera's axes to each camera's."""
    boards: tuple[Place, ...]
    """From the board's axes to the first camera's, at each rest."""
    focal_error_px: Vector
    """(cameras,) standard deviation of the focal length."""
    misses_px: tuple[Vector, ...]
    """(n, 2) residuals of each sight, pixels."""


class _Layout(NamedTuple):
    """Layout of the vector of unknowns."""

    cameras: int
    rests: int

    def lens(self, camera: int) -> slice:
        return slice(LENS * camera, LENS * (camera + 1))

    def camera(self, camera: int) -> slice:
        begin = LENS * self.cameras + PLACE * (camera - 1)
        return slice(begin, begin + PLACE)

    def board(self, rest: int) -> slice:
        begin = LENS * self.cameras + PLACE * (self.cameras - 1 + rest)
        return slice(begin, begin + PLACE)

    @property
    def length(self) -> int:
        return LENS * self.cameras + PLACE * (self.cameras - 1 + self.rests)


def start_of(lenses: Sequence[Lens], cameras: Sequence[Place], rests: int) -> Start:
    """The vector: lenses, then each board's place relative to the first camera that shows it."""
    numbers = [
        [lens.K[0, 0], lens.K[1, 1], lens.K[0, 2], lens.K[1, 2], lens.k1, 0.0] for lens in lenses
    ]
    boards = []
    for rest in range(rests):
        camera = next(n for n, lens in enumerate(lenses) if rest in lens.boards)
        boards.append(chained(lenses[camera].boards[rest], undone(cameras[camera])))
    return Start(np.array(numbers), tuple(cameras), tuple(boards))


def fitted_to(sights: Sequence[Sight], start: Start, size_px: tuple[int, int]) -> Fit:
    """The likeliest cameras and boards, from a start.

    Robust least squares of the reprojection errors, with priors: lenses have their centre near the
    middle, pixels are nearly square, distortion is small. So what few poses leave undetermined
    stays plausible.
    """
    from scipy.optimize import least_squares

    lenses, cameras, boards = start
    layout = _Layout(len(cameras), len(boards))
    begin = np.concatenate(
        [lenses.ravel(), *(np.concatenate(one) for one in (*cameras[1:], *boards))]
    )
    prior, wanted = _prior(layout, lenses, size_px)

    def misses(unknown: Vector) -> Vector:
        off = [(_shown(layout, unknown, one)[0] - one.px).ravel() for one in sights]
        own = [part / one.sigma_px for part, one in zip(off, sights, strict=True)]
        return np.concatenate([*own, prior @ unknown - wanted])

    def slopes(unknown: Vector) -> Vector:
        return np.concatenate([*(_slope(layout, unknown, one) for one in sights), prior])

    found = least_squares(
        misses, begin, jac=slopes, x_scale="jac", loss="soft_l1", f_scale=SOFT, max_nfev=60
    )
    spread = np.sqrt(np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
    return Fit(
        found.x[: LENS * layout.cameras].reshape(-1, LENS),
        (cameras[0], *(_place(found.x[layout.camera(n)]) for n in range(1, layout.cameras))),
        tuple(_place(found.x[layout.board(n)]) for n in range(layout.rests)),
        np.array([spread[layout.lens(n)][0] for n in range(layout.cameras)]),
        tuple(_shown(layout, found.x, one)[0] - one.px for one in sights),
    )


def weighed(sight: Sight, miss_px: Vector) -> Sight:
    """A sight with the standard deviation of its residuals: near boards are seen better than far
    ones."""
    told = float(np.sum(miss_px**2)) / 2 + BELIEVED * SIGMA_PX**2
    return sight._replace(sigma_px=max(FINEST_PX, (told / (len(miss_px) + BELIEVED)) ** 0.5))


def _place(numbers: Vector) -> Place:
    return Place(numbers[:3], numbers[3:])


def _prior(layout: _Layout, lenses: Vector, size_px: tuple[int, int]) -> tuple[Vector, Vector]:
    """The priors on lenses: rows (5 a camera, unknowns), and their targets."""
    rows, wanted = [], []
    for camera, lens in enumerate(lenses):
        begin, focal_px = LENS * camera, float(lens[0])
        beliefs: list[tuple[dict[int, float], float, float]] = [
            ({1: 1.0, 0: -1.0}, 0.0, SQUARE * focal_px),
            ({2: 1.0}, (size_px[0] - 1) / 2, OFF_MIDDLE * size_px[0]),
            ({3: 1.0}, (size_px[1] - 1) / 2, OFF_MIDDLE * size_px[0]),
            ({4: 1.0}, 0.0, BENT),
            ({5: 1.0}, 0.0, BENT),
        ]
        for weights, mean, sigma in beliefs:
            row = np.zeros(layout.length)
            for offset, weight in weights.items():
                row[begin + offset] = weight / sigma
            rows.append(row)
            wanted.append(mean / sigma)
    return np.array(rows), np.array(wanted)


def _shown(
    layout: _Layout, unknown: Vector, sight: Sight
) -> tuple[Vector, Vector, Sequence[Vector]]:
    """Predicted corners of a sight, (n, 2), their derivatives, and those of the places."""
    fx, fy, cx, cy, k1, k2 = unknown[layout.lens(sight.camera)]
    board = unknown[layout.board(sight.rest)]
    camera = unknown[layout.camera(sight.camera)] if sight.camera else np.zeros(PLACE)
    both = cv2.composeRT(board[:3], board[3:], camera[:3], camera[3:])
    K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    bent = np.array([k1, k2, 0.0, 0.0])
    px, slopes = cv2.projectPoints(sight.places, both[0], both[1], K, bent)
    return px[:, 0], slopes, both


def _slope(layout: _Layout, unknown: Vector, sight: Sight) -> Vector:
    """(2n, unknowns), in sigmas."""
    _, slopes, both = _shown(layout, unknown, sight)
    by_turn, by_shift = slopes[:, :3], slopes[:, 3:6]
    rows = np.zeros((len(slopes), layout.length))
    turns, shifts = both[2:6], both[6:10]
    by = [by_turn @ turn + by_shift @ shift for turn, shift in zip(turns, shifts, strict=True)]
    rows[:, layout.board(sight.rest)] = np.concatenate(by[:2], axis=1)
    if sight.camera:
        rows[:, layout.camera(sight.camera)] = np.concatenate(by[2:], axis=1)
    rows[:, layout.lens(sight.camera)] = slopes[:, 6 : 6 + LENS]
    return np.asarray(rows / sight.sigma_px)
