"""What a run of one camera decided by itself, how sure it was, and what notes make of it."""

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from animator.skeleton.planted_feet import nearest
from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, Vector
from common.notes.notes import Depth, Held, Notes, held
from common.npz_file import Arrays
from common.rig.camera import PAPER_ROTATIONS, TOWARDS

CONFIDENT: Final = 0.7
"""A decision with less confidence than this is worth a look."""
SEEN: Final = 0.3
"""A joint that keeps less than this of the confidence of the joint before it is hidden, the
thesis's "highly occluded"; a direction that is not sure costs it a half at most."""
FLAT_DEG: Final = 15.0
"""A segment that leans less out of the picture's plane has no direction that anyone would
see."""

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
_FAR: Final = {int(far): int(near) for near, far in LIMB_ENDS}
_HANGS_ON: Final = [
    (i, _FAR.get(i, _AT["neck" if name.endswith("shoulder") else "pelvis"]))
    for i, name in enumerate(JOINT_NAMES)
    if name != "pelvis"
]
"""Each landmark with the one that carries it, carriers first."""


class Take(NamedTuple):
    """A run: n frames."""

    frame: NDArray[np.int64]
    """(n,) index into the video."""
    joints_px: NDArray[np.float64]
    """(n, 15, 2) in the video's own pixels; NaN where there is no pose."""
    joints_m: NDArray[np.float64]
    """(n, 15, 3): x to the right of the picture, y up, z to the camera."""
    confidence: NDArray[np.float64]
    """(n, 15)"""
    orientation: NDArray[np.str_]
    """(n,) names of ORIENTATIONS; "" where the run did not need one."""
    orientation_confidence: NDArray[np.float64]
    """(n,)"""
    depth_confidence: NDArray[np.float64]
    """(n, 10), LIMBS order."""

    @property
    def posed(self) -> NDArray[np.bool_]:
        """Whether there is a pose, (n,)."""
        whole = np.array(np.isfinite(self.joints_m).all(axis=(1, 2)))
        return whole


class Doubt(NamedTuple):
    """One thing that the program was not sure of."""

    kind: str
    """orientation, depth or joint."""
    name: str
    """Of the segment or joint; what was chosen, of an orientation."""
    confidence: float


def take_of(poses: Arrays, px_scale: float = 1.0, turn: ArrayLike = PAPER_ROTATIONS[0]) -> Take:
    """A run as its `poses.npz` has it.

    Args:
        poses: Beside the arrays of every run, one of a single view has `orientation` (n,),
            `orientation_confidence` (n,) and `depth_confidence` (n, 10) in the order of LIMBS; a
            run without them was sure. A frame in which the body was lost has that of the nearest
            frame with one, without confidence: something to put right.
        px_scale: Pixels of the video in one of the working picture.
        turn: World to camera, (3, 3).
    """
    n = len(poses["frame"])
    rows = _nearest_posed(poses)
    return Take(
        frame=poses["frame"],
        joints_px=px_scale * poses["joints_px"][rows, 0],
        joints_m=poses["joints_m"][rows] @ np.transpose(turn) * TOWARDS,
        confidence=poses["confidence"],
        orientation=np.array(poses.get("orientation", [""] * n), np.str_),
        orientation_confidence=np.array(poses.get("orientation_confidence", np.ones(n))),
        depth_confidence=np.array(poses.get("depth_confidence", np.ones((n, len(LIMBS))))),
    )


def _nearest_posed(poses: Arrays) -> NDArray[np.int64]:
    """(n,) the row whose pose a frame opens with: its own, but where the body was lost."""
    rows = np.arange(len(poses["frame"]))
    posed = np.flatnonzero(np.isfinite(poses["joints_m"]).all(axis=(1, 2)))
    lost = rows[np.array(poses.get("status", [""] * len(rows))) == "lost"]
    if len(posed):
        rows[lost] = nearest(lost, posed)
    return rows


def depth_of(joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Which way segments lean, (n, 10), LIMBS order.

    1: toward the camera, -1: away, 0: less than FLAT_DEG out of the picture's plane, or no pose.
    """
    along = joints_m[:, LIMB_ENDS[:, 1]] - joints_m[:, LIMB_ENDS[:, 0]]
    lean = along[..., 2] / np.maximum(np.linalg.norm(along, axis=2), 1e-9)
    enough = np.abs(lean) >= np.sin(np.radians(FLAT_DEG))
    signs: NDArray[np.float64] = np.where(enough, np.sign(lean), 0.0)
    return signs


def hidden_of(confidence: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether the joint at each segment's far end is hidden: (..., 15) to (..., 10)."""
    near, far = confidence[..., LIMB_ENDS[:, 0]], confidence[..., LIMB_ENDS[:, 1]]
    hidden: NDArray[np.bool_] = far < SEEN * near
    return hidden


def doubts_at(take: Take, row: int, notes: Notes) -> list[Doubt]:
    """What a frame leaves open, the least sure first; what the user settled is not."""
    if not take.posed[row]:
        return []
    annotations = held(notes, int(take.frame[row]))
    found = []
    confidence = float(take.orientation_confidence[row])
    if confidence < CONFIDENT and annotations.orientation is None:
        found.append(Doubt("orientation", str(take.orientation[row]), confidence))
    leans = depth_of(take.joints_m[row : row + 1])[0]
    hidden = hidden_of(take.confidence[row])
    for name, lean, confidence in zip(LIMBS, leans, take.depth_confidence[row], strict=True):
        if lean and confidence < CONFIDENT and name not in annotations.depth:
            found.append(Doubt("depth", name, float(confidence)))
    for joint in LIMB_ENDS[hidden, 1]:
        if (name := JOINT_NAMES[joint]) not in annotations.joints_px:
            found.append(Doubt("joint", name, float(take.confidence[row, joint])))
    return sorted(found, key=lambda doubt: doubt.confidence)


def next_doubtful(take: Take, row: int, notes: Notes, step: int = 1) -> int | None:
    """The next row after this one, or before it, that leaves something open; None: there is none.

    A stretch of frames with the same open questions is one place to look at: its first frame.
    """
    here = _questions(take, row, notes)
    while 0 <= (row := row + step) < len(take.frame):
        questions = _questions(take, row, notes)
        if questions and questions != here:
            return row
        here = questions
    return None


def with_notes(take: Take, row: int, annotations: Held) -> tuple[Vector, Vector]:
    """A frame's stick (15, 2) and body (15, 3) with the user's joints and depths laid over them.

    Shows at once what was said; the fit itself follows when the video is tracked again.
    """
    joints_px, joints_m = take.joints_px[row].copy(), take.joints_m[row].copy()
    for name, place in annotations.joints_px.items():
        joints_px[_AT[name]] = place
    return joints_px, leaned(joints_m, annotations.depth)


def leaned(joints_m: Vector, depth: Mapping[str, Depth]) -> Vector:
    """A body (15, 3) whose named segments lean as said, and what hangs on them with them."""
    given = {
        int(LIMB_ENDS[LIMBS.index(limb), 1]): 1.0 if way == "toward" else -1.0
        for limb, way in depth.items()
    }
    found = joints_m.copy()
    for joint, carrier in _HANGS_ON:
        step_m = joints_m[joint, 2] - joints_m[carrier, 2]
        if joint in given:
            step_m = given[joint] * abs(step_m)
        found[joint, 2] = found[carrier, 2] + step_m
    return found


def _questions(take: Take, row: int, notes: Notes) -> set[tuple[str, str]]:
    return {(doubt.kind, doubt.name) for doubt in doubts_at(take, row, notes)}
