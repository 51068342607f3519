"""OpenSim: a model of the run's own skeleton, and its motion in that model's coordinates.

Every bone is a massless body with three rotations in the order of the BVH (about z, x, y). Markers
with the landmarks' names are at the bones' ends; so OpenSim's inverse kinematics runs on the TRC
file too. Source: OpenSim 4 documentation, CustomJoint, SpatialTransform, storage (.mot) files.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np

from animator.bvh import euler_zxy_deg
from animator.skeleton.bones import BONES, Motion, Skeleton, offset_m
from common.body.body import Vector
from common.body.extremities import ALL_JOINT_NAMES

TURNS: Final = (("rz", (0, 0, 1)), ("rx", (1, 0, 0)), ("ry", (0, 1, 0)))
SHIFTS: Final = (("tx", (1, 0, 0)), ("ty", (0, 1, 0)), ("tz", (0, 0, 1)))
QUARTER: Final = "0 1.5707963267948966 0"
"""Rotation from a run's axes to OpenSim's, in the form of the model's ground frame."""
MASS: Final = "<mass>0.001</mass><inertia>1e-6 1e-6 1e-6 0 0 0</inertia>"
"""Mass of each body, kg: OpenSim's solver requires one; the model is for kinematics alone."""


def osim_text(skeleton: Skeleton) -> str:
    """The model (.osim), scaled to the skeleton's bones."""
    bodies = "".join(f'<Body name="{bone.name}">{MASS}</Body>' for bone in skeleton.bones)
    joints = "".join(_joint(skeleton, i) for i in range(len(skeleton.bones)))
    markers = "".join(_markers(skeleton))
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<OpenSimDocument Version="40500">'
        '<Model name="tritrack"><gravity>0 -9.80665 0</gravity>'
        "<length_units>meters</length_units><force_units>N</force_units>"
        f"<BodySet><objects>{bodies}</objects></BodySet>"
        f"<JointSet><objects>{joints}</objects></JointSet>"
        f"<MarkerSet><objects>{markers}</objects></MarkerSet>"
        "</Model></OpenSimDocument>\n"
    )


def mot_text(motion: Motion, step_s: float, name: str) -> str:
    """The motion (.mot) in the coordinates of the model: metres and degrees."""
    angles_deg = euler_zxy_deg(motion.turns).reshape(len(motion.root_m), -1)
    columns = ["time", *_coordinates(len(motion.turns))]
    times_s = np.arange(len(motion.root_m)) * step_s
    rows = np.column_stack([times_s, motion.root_m, angles_deg])
    body = "\n".join("\t".join(f"{value:.6f}" for value in row) for row in rows)
    return (
        f"{name}\nversion=1\nnRows={len(rows)}\nnColumns={len(columns)}\ninDegrees=yes\nendheader\n"
        + "\t".join(columns)
        + f"\n{body}\n"
    )


def _coordinates(bones: int) -> list[str]:
    """Coordinates in the order of the file: the hips' place, then each bone's turns."""
    shifts = [f"Hips_{name}" for name, _ in SHIFTS]
    return [*shifts, *(f"{bone.name}_{name}" for bone in BONES[:bones] for name, _ in TURNS)]


def _joint(skeleton: Skeleton, bone: int) -> str:
    own, root = BONES[bone], BONES[bone].parent < 0
    parent = "/ground" if root else f"/bodyset/{BONES[own.parent].name}"
    turn = QUARTER if root else "0 0 0"
    moves = [*SHIFTS, *TURNS] if root else list(TURNS)
    coordinates = "".join(
        f'<Coordinate name="{own.name}_{name}">'
        f"<motion_type>{'translational' if name[0] == 't' else 'rotational'}</motion_type>"
        "<range>-100 100</range></Coordinate>"
        for name, _ in moves
    )
    axes = [*((f"rotation{i}", *each) for i, each in enumerate(TURNS, 1))]
    axes += [(f"translation{i}", *each) for i, each in enumerate(SHIFTS, 1)]
    transform = "".join(_axis(own.name, root, *each) for each in axes)
    return (
        f'<CustomJoint name="{own.name}">'
        "<socket_parent_frame>from</socket_parent_frame>"
        "<socket_child_frame>to</socket_child_frame>"
        f"<coordinates>{coordinates}</coordinates><frames>"
        f'<PhysicalOffsetFrame name="from"><socket_parent>{parent}</socket_parent>'
        f"<translation>{_numbers(offset_m(skeleton, bone))}</translation>"
        f"<orientation>{turn}</orientation></PhysicalOffsetFrame>"
        f'<PhysicalOffsetFrame name="to"><socket_parent>/bodyset/{own.name}</socket_parent>'
        "<translation>0 0 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>"
        f"</frames><SpatialTransform>{transform}</SpatialTransform></CustomJoint>"
    )


def _axis(bone: str, root: bool, place: str, name: str, axis: tuple[int, ...]) -> str:
    moves = root or name[0] == "r"
    function = (
        "<LinearFunction><coefficients>1 0</coefficients></LinearFunction>"
        if moves
        else "<Constant><value>0</value></Constant>"
    )
    coordinate = f"{bone}_{name}" if moves else ""
    return (
        f'<TransformAxis name="{place}"><coordinates>{coordinate}</coordinates>'
        f"<axis>{_numbers(np.array(axis))}</axis>{function}</TransformAxis>"
    )


def _markers(skeleton: Skeleton) -> Iterator[str]:
    """Every landmark once, at a bone's start or end."""
    at: dict[str, tuple[str, Vector]] = {}
    for bone, tip_m in zip(skeleton.bones, skeleton.tips_m, strict=True):
        at.setdefault(bone.starts, (bone.name, np.zeros(3)))
        at.setdefault(bone.ends, (bone.name, tip_m))
    for joint in (name for name in ALL_JOINT_NAMES if name in at):
        body, place_m = at[joint]
        yield (
            f'<Marker name="{joint}"><socket_parent_frame>/bodyset/{body}</socket_parent_frame>'
            f"<location>{_numbers(place_m)}</location><fixed>false</fixed></Marker>"
        )


def _numbers(vector: Vector) -> str:
    return " ".join(f"{value:.9g}" for value in vector)
