"""BVH: a run's motion for Blender and other animation programs (T28)."""

from collections.abc import Iterator, Sequence
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from animator.even_steps import EvenSteps, even_steps
from animator.inbetween import between
from animator.skeleton.bone_turns import motion_of
from animator.skeleton.bones import BONES, Joints, Motion, Skeleton, offset_m, skeleton_of
from animator.skeleton.planted_feet import Planted, on_its_feet, planted
from common.body.body import Vector

ROOT_CHANNELS: Final = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
CHANNELS: Final = "CHANNELS 3 Zrotation Xrotation Yrotation"
METRES_IN: Final = {"m": 1.0, "cm": 0.01}
"""Units of length that a file may use."""


def steady(joints_m: Joints, time_s: Vector) -> tuple[Skeleton, Motion, EvenSteps]:
    """A run as a skeleton that moves in even steps, from its first pose to its last.

    Frames that are missing, have no pose or fall between two rows are interpolated from their
    neighbours. Lengths are fixed (`skeleton_of`); where the run's joints keep theirs, the skeleton
    has the same joints. A standing foot does not slide (`planted`).

    Args:
        joints_m: (n, 15 or 22, 3), NaN where there is no pose.
        time_s: (n,) times of the rows.

    Returns:
        The skeleton, its motion, and the rows' places in the file.

    Raises:
        NoMotion: When there are fewer than two poses, or the times give no even steps.
    """
    steps = even_steps(joints_m, time_s)
    run = planted(joints_m, time_s)
    skeleton = skeleton_of(joints_m)
    posed = Planted(run.joints_m[steps.posed], run.held[steps.posed])
    motion = motion_of(skeleton, on_its_feet(skeleton, posed), time_s[steps.posed])
    return skeleton, between(steps.places, motion, np.arange(steps.frames)), steps


def bvh_text(
    skeleton: Skeleton, motion: Motion, step_s: float, scale: Literal["m", "cm"] = "m"
) -> str:
    """A BVH file: metres or centimetres, degrees, +y up, the body faces +z.

    Rotations apply in the order of their channels, R = R_z R_x R_y.
    """
    skeleton = Skeleton(skeleton.tips_m / METRES_IN[scale])
    angles = euler_zxy_deg(motion.turns)
    rows = np.concatenate(
        [motion.root_m / METRES_IN[scale], angles.reshape(len(angles), -1)], axis=1
    )
    order = _file_order(skeleton, 0)
    columns = [0, 1, 2, *(3 + 3 * bone + axis for bone in order for axis in range(3))]
    body = "\n".join(" ".join(f"{value:.6f}" for value in row) for row in rows[:, columns])
    head = "\n".join(_hierarchy(skeleton, 0, ""))
    return f"HIERARCHY\n{head}\nMOTION\nFrames: {len(rows)}\nFrame Time: {step_s:.8f}\n{body}\n"


def euler_zxy_deg(turns: Sequence[Rotation]) -> NDArray[np.float64]:
    """Angles (n, bones, 3) about z, x, y with R = R_z R_x R_y, without jumps along the first axis.

    A turn has two triples, and all that differ by full circles; the one nearest to the frame before
    is taken, in the first frame the one nearest to rest. Otherwise programs that interpolate
    between frames would spin a limb round, and a knee that is bent by 120 degrees would be 60 about
    x and half turns about the other axes.

    Args:
        turns: (n,) turns of each bone.
    """
    angles = np.stack(
        [own.as_euler("ZXY", degrees=True, suppress_warnings=True) for own in turns], axis=1
    )
    before = np.zeros(angles.shape[1:])
    for row in angles:
        row[:] = _nearest(row, before)
        before = row
    return angles


def _nearest(
    angles_deg: NDArray[np.float64], before_deg: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Of the triples (..., 3) for one turn, those nearest to others."""
    flipped = np.stack(
        [angles_deg[..., 0] + 180.0, 180.0 - angles_deg[..., 1], angles_deg[..., 2] + 180.0], -1
    )
    both = np.stack([angles_deg, flipped])
    both = both + 360.0 * np.rint((before_deg - both) / 360.0)
    cost = np.abs(both - before_deg).sum(-1)
    return np.where((cost[0] <= cost[1])[..., None], both[0], both[1])


def _hierarchy(skeleton: Skeleton, bone: int, indent: str) -> Iterator[str]:
    own, inner = BONES[bone], indent + "  "
    yield f"{indent}{'JOINT' if bone else 'ROOT'} {own.name}"
    yield f"{indent}{{"
    yield f"{inner}OFFSET {_numbers(offset_m(skeleton, bone))}"
    yield f"{inner}{CHANNELS if bone else ROOT_CHANNELS}"
    children = _children(skeleton, bone)
    for child in children:
        yield from _hierarchy(skeleton, child, inner)
    if not children:
        yield f"{inner}End Site"
        yield f"{inner}{{"
        yield f"{inner}  OFFSET {_numbers(skeleton.tips_m[bone])}"
        yield f"{inner}}}"
    yield f"{indent}}}"


def _children(skeleton: Skeleton, bone: int) -> list[int]:
    return [i for i, other in enumerate(skeleton.bones) if other.parent == bone]


def _file_order(skeleton: Skeleton, bone: int) -> list[int]:
    """Bones in the order in which the hierarchy names them."""
    inner = (_file_order(skeleton, child) for child in _children(skeleton, bone))
    return [bone, *(each for children in inner for each in children)]


def _numbers(vector: Vector) -> str:
    return " ".join(f"{value:.6f}" for value in vector)
