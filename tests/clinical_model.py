"""A model for OpenSim of a person's own lengths, with the coordinates of Rajagopal's by name.

It is written by OpenSim's documentation and knows nothing of how we compute the angles.
"""

from typing import Final, NamedTuple

import numpy as np

from common.body.body import JOINT_NAMES

AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


class Part(NamedTuple):
    """A body, what it hangs on, where, and its coordinates with their axes."""

    name: str
    parent: str
    at_m: tuple[float, float, float]
    turns: tuple[tuple[str, tuple[int, int, int]], ...]
    markers: dict[str, tuple[float, float, float]]


def minus(axis: tuple[int, int, int]) -> tuple[int, int, int]:
    return (-axis[0], -axis[1], -axis[2])


def parts_of(joints_m: np.ndarray) -> list[Part]:
    """The model's parts, scaled to the median distances of joints (n, 15, 3)."""

    def long_m(one: str, other: str) -> float:
        apart = joints_m[:, AT[one]] - joints_m[:, AT[other]]
        return float(np.median(np.linalg.norm(apart, axis=1)))

    hip_m, trunk_m = long_m("l_hip", "r_hip") / 2, long_m("pelvis", "neck")
    middle = joints_m[:, [AT["l_shoulder"], AT["r_shoulder"]]].mean(axis=1)
    up = joints_m[:, AT["neck"]] - joints_m[:, AT["pelvis"]]
    share = np.einsum("ni,ni->n", middle - joints_m[:, AT["pelvis"]], up)
    along = share / np.einsum("ni,ni->n", up, up)
    high_m, wide_m = trunk_m * float(np.median(along)), long_m("l_shoulder", "r_shoulder") / 2
    parts = [
        Part(
            *("pelvis", "/ground", (0, 0, 0)),
            (("pelvis_tilt", Z), ("pelvis_list", X), ("pelvis_rotation", Y)),
            {"pelvis": (0, 0, 0), "r_hip": (0, 0, hip_m), "l_hip": (0, 0, -hip_m)},
        ),
        Part(
            *("torso", "pelvis", (0, 0, 0)),
            (("lumbar_bending", X), ("lumbar_rotation", Y)),
            {
                "neck": (0, trunk_m, 0),
                "r_shoulder": (0, high_m, wide_m),
                "l_shoulder": (0, high_m, -wide_m),
            },
        ),
    ]
    for side, way in (("r", 1), ("l", -1)):
        x, y = (X, Y) if side == "r" else (minus(X), minus(Y))
        thigh = long_m(f"{side}_hip", f"{side}_knee")
        shank = long_m(f"{side}_knee", f"{side}_ankle")
        upper, lower = (
            long_m(f"{side}_shoulder", f"{side}_elbow"),
            long_m(f"{side}_elbow", f"{side}_wrist"),
        )
        hip = (("hip_flexion", Z), ("hip_adduction", x), ("hip_rotation", y))
        arm = (("arm_flex", Z), ("arm_add", x), ("arm_rot", y))

        def named(turns: tuple[tuple[str, tuple[int, int, int]], ...], side: str = side):  # type: ignore[no-untyped-def]
            return tuple((f"{name}_{side}", axis) for name, axis in turns)

        parts += [
            Part(
                *(f"femur_{side}", "pelvis", (0, 0, way * hip_m), named(hip)),
                {f"{side}_knee": (0, -thigh, 0)},
            ),
            Part(
                *(f"tibia_{side}", f"femur_{side}", (0, -thigh, 0)),
                named((("knee_angle", minus(Z)),)),
                {f"{side}_ankle": (0, -shank, 0)},
            ),
            Part(
                *(f"humerus_{side}", "torso", (0, high_m, way * wide_m), named(arm)),
                {f"{side}_elbow": (0, -upper, 0)},
            ),
            Part(
                *(f"ulna_{side}", f"humerus_{side}", (0, -upper, 0), named((("elbow_flex", Z),))),
                {f"{side}_wrist": (0, -lower, 0)},
            ),
        ]
    return parts


def osim_of(parts: list[Part]) -> str:
    mass = "<mass>0.1</mass><inertia>1e-3 1e-3 1e-3 0 0 0</inertia>"
    bodies = "".join(f'<Body name="{part.name}">{mass}</Body>' for part in parts)
    markers = "".join(
        f'<Marker name="{name}"><socket_parent_frame>/bodyset/{part.name}</socket_parent_frame>'
        f"<location>{numbers(place)}</location><fixed>false</fixed></Marker>"
        for part in parts
        for name, place in part.markers.items()
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<OpenSimDocument Version="40500">'
        '<Model name="clinical"><length_units>meters</length_units>'
        f"<BodySet><objects>{bodies}</objects></BodySet>"
        f"<JointSet><objects>{''.join(map(joint_of, parts))}</objects></JointSet>"
        f"<MarkerSet><objects>{markers}</objects></MarkerSet></Model></OpenSimDocument>\n"
    )


def joint_of(part: Part) -> str:
    shifts = [(f"pelvis_t{axis}", along) for axis, along in zip("xyz", (X, Y, Z), strict=True)]
    is_root = part.parent == "/ground"
    moves = [*part.turns, *(shifts if is_root else [])]
    coordinates = "".join(
        f'<Coordinate name="{name}"><range>{range_of(name)}</range>'
        "<clamped>true</clamped></Coordinate>"
        for name, _ in moves
    )
    axes = [axis for _, axis in part.turns]
    free = [axis for axis in (X, Y, Z) if axis not in axes and minus(axis) not in axes]
    turns = [*part.turns, *(("", axis) for axis in free)][:3]
    places = shifts if is_root else [("", X), ("", Y), ("", Z)]
    transform = "".join(
        f'<TransformAxis name="{kind}{n}"><coordinates>{name}</coordinates>'
        f"<axis>{numbers(axis)}</axis>{function(bool(name))}</TransformAxis>"
        for kind, those in (("rotation", turns), ("translation", places))
        for n, (name, axis) in enumerate(those, 1)
    )
    parent = part.parent if is_root else f"/bodyset/{part.parent}"
    return (
        f'<CustomJoint name="to_{part.name}"><socket_parent_frame>from</socket_parent_frame>'
        f"<socket_child_frame>to</socket_child_frame><coordinates>{coordinates}</coordinates>"
        f'<frames><PhysicalOffsetFrame name="from"><socket_parent>{parent}</socket_parent>'
        f"<translation>{numbers(part.at_m)}</translation></PhysicalOffsetFrame>"
        '<PhysicalOffsetFrame name="to">'
        f"<socket_parent>/bodyset/{part.name}</socket_parent></PhysicalOffsetFrame></frames>"
        f"<SpatialTransform>{transform}</SpatialTransform></CustomJoint>"
    )


def range_of(name: str) -> str:
    """Hinges bend one way."""
    return "0 2.7" if name.startswith(("knee_angle", "elbow_flex")) else "-10 10"


def function(moves: bool) -> str:
    if moves:
        return "<LinearFunction><coefficients>1 0</coefficients></LinearFunction>"
    return "<Constant><value>0</value></Constant>"


def numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


SOLVED: Final = """
import json, sys, opensim
opensim.Logger.setLevelString("off")
model = opensim.Model(sys.argv[1])
model.initSystem()
tool = opensim.InverseKinematicsTool()
tool.setModel(model)
tool.setMarkerDataFileName(sys.argv[2])
table = opensim.TimeSeriesTableVec3(sys.argv[2])
times = table.getIndependentColumn()
tool.setStartTime(times[0])
tool.setEndTime(times[-1])
tool.setOutputMotionFileName("solved.mot")
tool.run()
solved = opensim.TimeSeriesTable("solved.mot")
names = solved.getColumnLabels()
print(json.dumps({n: [float(v) for v in solved.getDependentColumn(n).to_numpy()] for n in names}))
"""
"""Prints what OpenSim's inverse kinematics makes of markers, by coordinate, degrees."""
