"""The decisions of a run with one camera, their confidence, and the notes' effect on them."""

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
"""Confidence below which a decision is worth checking."""
SEEN: Final = 0.3
"""Ratio of a joint's confidence to that of the joint before it, below which it is hidden, the
thesis's "highly occluded"; an unsure direction costs at most a half."""
FLAT_DEG: Final = 15.0
"""Lean out of the picture's plane, degrees, below which a segment has no visible direction."""

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
_FAR: Final = {int(far): int(near) for near, far in LIMB_ENDS}
_HANGS_ON: Final = [
    (i, _FAR.get(i, _AT["neck" if name.endswith("shoulder") else "pelvis"]))
    for i, name in enumerate(JOINT_NAMES)
    if name != "pelvis"
]
"""Each landmark with its parent, parents first."""


class Take(NamedTuple):
    """A run: n frames."""

    frame: NDArray[np.int64]
    """(n,) index of the frame in the video."""
    joints_px: NDArray[np.float64]
    """(n, 15, 2) in the video's own pixels; NaN where there is no pose."""
    joints_m: NDArray[np.float64]
    """(n, 15, 3): x to the right of the picture, y up, z to the camera."""
    confidence: NDArray[np.float64]
    """(n, 15) confidence."""
    orientation: NDArray[np.str_]
    """(n,) names of ORIENTATIONS; "" where the run did not need one."""
    orientation_confidence: NDArray[np.float64]
    """(n,) confidence of the orientation."""
    depth_confidence: NDArray[np.float64]
    """(n, 10), LIMBS order: confidence of each depth's sign."""

    @property
    def posed(self) -> NDArray[np.bool_]:
        """Whether there is a pose, (n,)."""
        whole = np.array(np.isfinite(self.joints_m).all(axis=(1, 2)))
        return whole


class Doubt(NamedTuple):
    """A decision of the program with low confidence."""

    kind: str
    """Kind: orientation, depth or joint."""
    name: str
    """Name of the segment or joint; for an orientation, the choice."""
    confidence: float


def take_of(poses: Arrays, px_scale: float = 1.0, turn: ArrayLike = PAPER_ROTATIONS[0]) -> Take:
    """A run from its `poses.npz`.

    Args:
        poses: A run of a single view has, beside the common arrays, `orientation` (n,),
            `orientation_confidence` (n,) and `depth_confidence` (n, 10) in the order of LIMBS; a
            run without them was sure. A frame in which the body was lost gets the pose of the
            nearest frame with one, without confidence, for the user to correct.
        px_scale: Pixels of the video per pixel of the working picture.
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
    """(n,) the row whose pose a frame shows: its own, unless the body was lost."""
    rows = np.arange(len(poses["frame"]))
    posed = np.flatnonzero(np.isfinite(poses["joints_m"]).all(axis=(1, 2)))
    lost = rows[np.array(poses.get("status", [""] * len(rows))) == "lost"]
    if len(posed):
        rows[lost] = nearest(lost, posed)
    return rows


def depth_of(joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lean of segments, (n, 10), LIMBS order.

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
    """A frame's open questions, the least sure first; those that the user settled are left out."""
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
    """The next or previous row with an open question; None: there is none.

    A stretch of frames with the same open questions counts once: its first frame.
    """
    here = _questions(take, row, notes)
    while 0 <= (row := row + step) < len(take.frame):
        questions = _questions(take, row, notes)
        if questions and questions != here:
            return row
        here = questions
    return None


def with_notes(take: Take, row: int, annotations: Held) -> tuple[Vector, Vector]:
    """A frame's stick body (15, 2) and body (15, 3) with the user's joints and depths applied.

    It shows an input at once; the fit itself follows when the video is tracked again.
    """
    joints_px, joints_m = take.joints_px[row].copy(), take.joints_m[row].copy()
    for name, place in annotations.joints_px.items():
        joints_px[_AT[name]] = place
    return joints_px, leaned(joints_m, annotations.depth)


def leaned(joints_m: Vector, depth: Mapping[str, Depth]) -> Vector:
    """A body (15, 3) whose named segments lean as given, with their children."""
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
