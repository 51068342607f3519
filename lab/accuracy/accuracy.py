"""Distances of tracked joints from the true ones, as the scoring script defines them."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from common.body.body import Vector
from common.npz_file import Arrays, Facts
from lab.accuracy.intervals import intervals

JOINTS: Final = tuple(
    f"{side}_{name}"
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    for side in "lr"
)
"""The scored joints."""
INDEX: Final = {name: i for i, name in enumerate(JOINTS)}

INNER: Final = {
    "shoulder": ("elbow", "shoulder", "hip"),
    "elbow": ("shoulder", "elbow", "wrist"),
    "hip": ("shoulder", "hip", "knee"),
    "knee": ("hip", "knee", "ankle"),
}
"""The inner angles: each between two limbs that meet at the joint in the middle."""

LOST_MM: Final = 200.0
"""Error of a joint, mm, above which its frame is lost."""

TINY_M2: Final = 1e-12
"""Added to limbs' lengths so that none is divided by 0, as in the scoring script."""


class Mismatch(ValueError):
    """A run or a ground truth with unexpected arrays; the text names them."""


class Compared(NamedTuple):
    """One clip: the frames with a true and a tracked person, and the number of frames with a
    true one."""

    frames: NDArray[np.int64]
    """(n,) frames of camera 1's video."""
    rows: NDArray[np.int64]
    """(n,) rows of the ground truth."""
    tracked_m: Vector
    """(n, 12, 3) world, tracked."""
    true_m: Vector
    """(n, 12, 3) world, true."""
    confidence: Vector
    """(n, 12) confidence in [0, 1]."""
    due: int
    """Number of frames with a true person."""
    empty: int
    """Number of frames without one."""
    ghosts: int
    """Number of frames without one that have a pose."""

    @property
    def off_mm(self) -> Vector:
        """Distance of each joint in the world, (n, 12)."""
        return 1e3 * np.linalg.norm(self.tracked_m - self.true_m, axis=-1)


def compare(poses: Arrays, truth: Arrays) -> Compared:
    """Match the rows of a run with those of a ground truth.

    Args:
        poses: Content of `poses.npz`.
        truth: Content of `truth.npz`. Without `frames_cam1` frame and row are the same.

    Raises:
        Mismatch: When a joint is missing, or an array has an unexpected shape.
    """
    refuse_other_shapes(poses, "frame", "joints_m")
    refuse_other_shapes(truth, "present", "joints3d")
    n = len(truth["present"])
    row_of = np.asarray(truth["frames_cam1"] if "frames_cam1" in truth else np.arange(n), int)
    frame = np.asarray(poses["frame"], int)
    known = (frame >= 0) & (frame < len(row_of))
    known[known] &= (row_of[frame[known]] >= 0) & (row_of[frame[known]] < n)
    at = row_of[frame[known]]
    tracked, confidence = np.full((n, len(JOINTS), 3), np.nan), np.zeros((n, len(JOINTS)))
    tracked[at] = picked(poses["joints_m"], poses["joint_names"])[known]
    confidence[at] = picked(poses["confidence"], poses["joint_names"])[known]
    true = picked(truth["joints3d"], truth["joint_names"])
    frame_of = np.full(n, -1)
    filmed = (row_of >= 0) & (row_of < n)
    frame_of[row_of[filmed]] = np.flatnonzero(filmed)
    present, seen = np.asarray(truth["present"], bool), frame_of >= 0
    due = present & np.isfinite(true).all(axis=(1, 2)) & seen
    has = due & np.isfinite(tracked).all(axis=(1, 2))
    absent = ~present & seen
    return Compared(
        frames=frame_of[has],
        rows=np.flatnonzero(has),
        tracked_m=tracked[has],
        true_m=true[has],
        confidence=confidence[has],
        due=int(due.sum()),
        empty=int(absent.sum()),
        ghosts=int((absent & np.isfinite(tracked).any(axis=(1, 2))).sum()),
    )


def refuse_other_shapes(arrays: Arrays, rows: str, places: str) -> None:
    """Raise where joints do not have one row for each entry of another array.

    Raises:
        Mismatch: Then.
    """
    _places(arrays["joint_names"])
    due = (np.size(arrays[rows]), np.size(arrays["joint_names"]), 3)
    if np.ndim(arrays[rows]) != 1 or np.shape(arrays[places]) != due:
        raise Mismatch(f"{places} is {np.shape(arrays[places])}, {rows} {np.shape(arrays[rows])}")


def picked(of_all: ArrayLike, names: NDArray[np.str_]) -> Vector:
    """The twelve joints, in order, of an array (n, joints, ...).

    Raises:
        Mismatch: When one of them is not among the names.
    """
    return np.asarray(of_all, float)[:, _places(names)]


def _places(names: NDArray[np.str_]) -> list[int]:
    known = [str(name) for name in names]
    missing = [name for name in JOINTS if name not in known]
    if missing:
        raise Mismatch(f"there is no joint {missing[0]!r}; there are {', '.join(known)}")
    return [known.index(name) for name in JOINTS]


def summary(clips: Sequence[Compared]) -> Facts:
    """All clips together, with equal weight for every frame and joint; NaN without any.

    `abs_mm` is the distance in the world, `root_mm` after aligning the middles of the hips, `pa_mm`
    after the best similarity of each frame; `between` holds their 95 % intervals under resampling
    of clips; `lost` counts frames without a pose too.
    """
    tracked = np.concatenate([clip.tracked_m for clip in clips])
    true = np.concatenate([clip.true_m for clip in clips])
    off = {
        "abs_mm": [clip.off_mm for clip in clips],
        "root_mm": [_off_mm(rooted(clip.tracked_m), rooted(clip.true_m)) for clip in clips],
        "pa_mm": [_off_mm(aligned(clip.tracked_m, clip.true_m), clip.true_m) for clip in clips],
    }
    due, has = sum(clip.due for clip in clips), len(tracked)
    empty, ghosts = sum(clip.empty for clip in clips), sum(clip.ghosts for clip in clips)
    bad = sum(int((each > LOST_MM).any(axis=1).sum()) for each in off["abs_mm"]) + due - has
    turned = np.abs(inner_deg(tracked) - inner_deg(true))
    return {
        "clips": len(clips),
        "frames": due,
        "coverage": has / due if due else np.nan,
        "lost": bad / due if due else np.nan,
        "ghost": ghosts / empty if empty else np.nan,
        **{name: spread(np.concatenate(values)) for name, values in off.items()},
        "between": {name: intervals(values) for name, values in off.items()},
        "angle_deg": {
            **{name: _mean(turned[:, 2 * i : 2 * i + 2]) for i, name in enumerate(INNER)},
            "all": _mean(turned),
        },
    }


def per_joint(clips: Sequence[Compared]) -> dict[str, Facts]:
    """Distance of each joint in the world, mm, and its 95 % intervals."""
    told = {}
    for i, name in enumerate(JOINTS):
        off = [clip.off_mm[:, i] for clip in clips]
        told[name] = {**spread(np.concatenate(off)), "between": intervals(off)}
    return told


def spread(values: Vector) -> dict[str, float]:
    """Mean, median and 95th percentile; NaN without values."""
    if not values.size:
        return {"mean": np.nan, "median": np.nan, "p95": np.nan}
    median, p95 = np.percentile(values, (50, 95)).tolist()
    return {"mean": float(values.mean()), "median": median, "p95": p95}


def inner_deg(joints_m: Vector) -> Vector:
    """The inner angles of INNER, left and right of each, (n, 8) from joints (n, 12, 3)."""
    found = []
    for one, corner, other in INNER.values():
        for side in "lr":
            at = joints_m[:, INDEX[f"{side}_{corner}"]]
            u = joints_m[:, INDEX[f"{side}_{one}"]] - at
            v = joints_m[:, INDEX[f"{side}_{other}"]] - at
            lengths = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1)
            cosine = (u * v).sum(axis=1) / (lengths + TINY_M2)
            found.append(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
    return np.stack(found, axis=1)


def rooted(joints_m: Vector) -> Vector:
    """Joints (n, 12, 3) with the middle of the hips at the origin."""
    hips = joints_m[:, [INDEX["l_hip"], INDEX["r_hip"]]]
    return joints_m - hips.mean(axis=1, keepdims=True)


def aligned(joints_m: Vector, onto_m: Vector) -> Vector:
    """Each frame translated, rotated and scaled to fit another as well as possible.

    Source: Umeyama 1991, least squares of similarities, eqs. (40)-(43).
    """
    middle = onto_m.mean(axis=1, keepdims=True)
    p, q = joints_m - joints_m.mean(axis=1, keepdims=True), onto_m - middle
    u, s, vt = np.linalg.svd(p.transpose(0, 2, 1) @ q)
    upright = np.ones_like(s)
    upright[:, 2] = np.sign(np.linalg.det(u @ vt))
    turn = (u * upright[:, None]) @ vt
    size = np.maximum((p * p).sum(axis=(1, 2)), TINY_M2)
    scale = (s * upright).sum(axis=1) / size
    moved: Vector = scale[:, None, None] * (p @ turn) + middle
    return moved


def _off_mm(one: Vector, other: Vector) -> Vector:
    return 1e3 * np.linalg.norm(one - other, axis=-1)


def _mean(values: Vector) -> float:
    return float(values.mean()) if values.size else np.nan
