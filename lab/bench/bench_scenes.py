"""Synthetic matches for benchmarks: limbs of a standing person over the drawn rest of the body."""

from collections.abc import Callable
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, Floats, Vector, rest_pose
from common.body.kinematics import ALL_LIMBS, FRAME, hang_limbs, limb_frames, place_limbs
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import place_in_rig
from common.compiled import compiled
from common.raster.bits import Bits, pack_words, unpack_words
from common.raster.kernel import draw_body, draw_limbs, limb_primitive, score
from common.raster.row_spans import PRIMITIVE, gain, spans
from common.rig.camera import PAPER_ROTATIONS
from viewer.paper.posed_model import PosedModel, model_over, view_at

STATURE_SHARE: Final = 0.65
"""Height of the person over the picture's, as in the development clips."""
MATCHES: Final = 9
"""Number of matches of one limb over one rest: a search's maximum (P41)."""
SWAY_DEG: Final = 12.0
"""Standard deviation of every angle around the rest: that of a walking person."""
RING: Final = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
"""Angles of the points on a disc's contour, for OpenCV."""


class Scene(NamedTuple):
    """Each arm and leg limb several times over the rest that belongs to it."""

    size: tuple[int, int]
    body: Vector
    view: Vector
    seen: Bits
    limbs: NDArray[np.int64]
    """(8,) indices in LIMBS: the limbs that a search moves."""
    poses: Vector
    """(8, MATCHES, 25)."""
    primitives: Vector
    """(8, MATCHES, PRIMITIVE)."""
    rests: Bits
    """(8, H, words): the body without the limb."""

    @property
    def matched(self) -> tuple[Floats, Bits, Bits, int]:
        """Arguments of `match_all`."""
        return self.primitives, self.rests, self.seen, self.size[0]

    @property
    def placed(self) -> tuple[NDArray[np.int64], Floats, Vector, Vector, Bits, Bits, int]:
        """Arguments of `match_placed`."""
        return self.limbs, self.poses, self.body, self.view, self.rests, self.seen, self.size[0]


def scene(size: tuple[int, int]) -> Scene:
    """Matches at one size of the picture, always the same ones."""
    random = np.random.default_rng(0)
    width, height = size
    body, view = body_vector(thesis_bdp(1.0)), _view(size, 1)
    pose, limbs = swayed(rest_pose(), random), np.arange(2, 10)
    poses = np.array([[swayed(pose, random) for _ in range(MATCHES)] for _ in limbs])
    primitives = np.empty((len(limbs), MATCHES, PRIMITIVE))
    rests = np.zeros((len(limbs), height, (width + 63) // 64), np.uint64)
    for i, limb in enumerate(limbs):
        draw_limbs(body, pose, view, ALL_LIMBS & ~(1 << int(limb)), width, rests[i])
        for j in range(MATCHES):
            limb_primitive(limb_frames(body, poses[i, j]), body, int(limb), view, primitives[i, j])
    seen = pack_words(draw_body(body, swayed(pose, random), view, size))
    return Scene(size, body, view, seen, limbs, poses, primitives, rests)


def swayed(pose: Vector, random: np.random.Generator) -> Vector:
    """A pose with random angles of arms and legs."""
    changed = pose.copy()
    begin = POSE_INDEX["r_shoulder_x"]
    changed[begin:] += random.normal(0.0, SWAY_DEG, len(pose) - begin)
    return changed


@compiled
def match_all(primitives: Floats, rests: Bits, seen: Bits, width: int) -> int:
    """Match every primitive over its rest; returns the sum of counts, so that nothing is
    optimised away."""
    height, total = seen.shape[0], 0
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    for i in range(primitives.shape[0]):
        for j in range(primitives.shape[1]):
            top, bottom = spans(primitives[i, j], width, height, first, last)
            drawn, hit = gain(first, last, top, bottom, rests[i], seen)
            total += drawn + hit
    return total


@compiled
def match_placed(
    limbs: NDArray[np.int64],
    poses: Floats,
    body: Vector,
    view: Vector,
    rests: Bits,
    seen: Bits,
    width: int,
) -> float:
    """The same from angles to scores: kinematics, contour, rows, counts, S."""
    height, total = seen.shape[0], 0.0
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    frames, p = np.empty((10, FRAME)), np.empty(PRIMITIVE)
    place_limbs(body, poses[0, 0], ALL_LIMBS, frames)
    for i in range(limbs.size):
        for j in range(poses.shape[1]):
            hang_limbs(body, poses[i, j], 1 << limbs[i], frames)
            limb_primitive(frames, body, limbs[i], view, p)
            top, bottom = spans(p, width, height, first, last)
            drawn, hit = gain(first, last, top, bottom, rests[i], seen)
            total += score(hit, drawn, 1000)
    return total


def by_opencv(given: Scene) -> Callable[[], int]:
    """The same matches with full masks: a convex polygon drawn, unions and overlaps counted."""
    polygons = [[_polygon(primitive) for primitive in row] for row in given.primitives]
    rests = [unpack_words(rest, given.size[0]).astype(np.uint8) for rest in given.rests]
    seen = unpack_words(given.seen, given.size[0]).astype(np.uint8)

    def run() -> int:
        total = 0
        for rest, row in zip(rests, polygons, strict=True):
            for polygon in row:
                drawn = rest.copy()
                cv2.fillConvexPoly(drawn, polygon, 1)
                total += int(np.count_nonzero(drawn & seen)) + int(np.count_nonzero(drawn | seen))
        return total

    return run


def model_pairs(size: tuple[int, int]) -> list[tuple[PosedModel, PosedModel]]:
    """A person in the facade and in the flank view, each with a model slightly off."""
    random = np.random.default_rng(1)
    body = body_vector(thesis_bdp(1.0))
    pairs = []
    for _ in range(12):
        pose = swayed(rest_pose(), random)
        before = swayed(pose, random)
        one, other = (
            model_over(
                draw_body(body, pose, _view(size, viewer), size),
                body,
                before,
                _view(size, viewer, (2.0, -1.0)),
            )
            for viewer in (1, 2)
        )
        pairs.append((one, other))
    return pairs


def _view(size: tuple[int, int], viewer: int, off_px: tuple[float, float] = (0.0, 0.0)) -> Vector:
    """The paper's camera; the navel is in the middle of the picture."""
    width, height = size
    root = (width / 2 + off_px[0], height / 2 + off_px[1])
    return view_at(np.array(PAPER_ROTATIONS[place_in_rig(viewer)]), STATURE_SHARE * height, root)


def _polygon(primitive: Vector) -> NDArray[np.int32]:
    """A limb's contour as a convex polygon in OpenCV's whole pixels."""
    discs = [
        (x + r * np.cos(RING), y + r * np.sin(RING)) for x, y, r in primitive[:6].reshape(2, 3)
    ]
    sheared, y = np.concatenate(discs, axis=1)
    x = primitive[7] * sheared + primitive[6] * y
    points = np.round(np.stack([x, y], axis=1) - 0.5).astype(np.int32)
    return np.asarray(cv2.convexHull(points), np.int32)
