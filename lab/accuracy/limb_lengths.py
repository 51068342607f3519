"""Accuracy of limb lengths."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from common.body.body import JOINT_NAMES, Bdp, Vector, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector
from common.npz_file import Facts
from lab.accuracy.accuracy import JOINTS, Compared, picked

SEGMENTS: Final[dict[str, tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]]] = {
    **{
        name: tuple(((f"{side}_{start}",), (f"{side}_{end}",)) for side in "lr")
        for name, start, end in (
            ("upper arm", "shoulder", "elbow"),
            ("forearm", "elbow", "wrist"),
            ("thigh", "hip", "knee"),
            ("shank", "knee", "ankle"),
        )
    },
    "trunk": ((("l_shoulder", "r_shoulder"), ("l_hip", "r_hip")),),
    "shoulder width": ((("l_shoulder",), ("r_shoulder",)),),
    "hip width": ((("l_hip",), ("r_hip",)),),
}
"""The joints, or middles of joints, at a segment's ends; both sides of paired segments."""


def segments_m(joints_m: Vector) -> dict[str, Vector]:
    """Length of every segment, (n, sides), of joints (n, 12, 3)."""
    at = {name: joints_m[:, i] for i, name in enumerate(JOINTS)}

    def middle(names: tuple[str, ...]) -> Vector:
        found: Vector = np.mean([at[name] for name in names], axis=0)
        return found

    return {
        segment: np.stack(
            [np.linalg.norm(middle(one) - middle(other), axis=-1) for one, other in sides], axis=1
        )
        for segment, sides in SEGMENTS.items()
    }


def body_joints_m(bdp: Bdp) -> Vector:
    """The twelve joints of a body at rest, (1, 12, 3)."""
    return picked(joints(body_vector(bdp), rest_pose())[None], np.array(JOINT_NAMES))


def length_errors(clips: Sequence[Compared], bodies: Sequence[Bdp | None]) -> Facts:
    """Mean error of every segment, mm: of the measured body, of joints, of their medians.

    The true length of a body's segment is its median over the clip. Published joints are compared
    with the true ones of the same frame, and their medians over a clip with the true medians. `off`
    is the mean absolute error, `bias` the mean error.

    Args:
        clips: The tracked clips.
        bodies: The body measured in each; None where there is none.
    """
    measured: dict[str, list[float]] = {name: [] for name in SEGMENTS}
    published: dict[str, list[Vector]] = {name: [] for name in SEGMENTS}
    settled: dict[str, list[Vector]] = {name: [] for name in SEGMENTS}
    for clip, bdp in zip(clips, bodies, strict=True):
        true, told = segments_m(clip.true_m), segments_m(clip.tracked_m)
        own = None if bdp is None or not len(clip.rows) else segments_m(body_joints_m(bdp))
        for name in SEGMENTS:
            published[name].append((told[name] - true[name]).ravel())
            if len(clip.rows):
                settled[name].append(np.median(told[name], axis=0) - np.median(true[name], axis=0))
            if own is not None:
                measured[name] += (own[name][0] - np.median(true[name], axis=0)).tolist()
    return {
        "body": _told({name: np.array(off) for name, off in measured.items()}),
        "joints": _told({name: np.concatenate(off) for name, off in published.items()}),
        "medians": _told({name: np.concatenate([*off, []]) for name, off in settled.items()}),
    }


def _told(errors_m: dict[str, Vector]) -> dict[str, dict[str, float]]:
    each = {
        name: {"off_mm": _mean_mm(np.abs(off)), "bias_mm": _mean_mm(off)}
        for name, off in errors_m.items()
    }
    over = [one["off_mm"] for one in each.values()]
    return {**each, "all": {"off_mm": float(np.mean(over)), "bias_mm": np.nan}}


def _mean_mm(values_m: Vector) -> float:
    return 1e3 * float(values_m.mean()) if values_m.size else np.nan
