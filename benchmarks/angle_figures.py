"""The conventions drawn with our own body: every angle's sign, the joints' names, the rig.

    .venv/bin/python benchmarks/angle_figures.py docs/pictures

Grey is the body before, in colour the limb that an angle moves, turned by what the title says.
"""

import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np
from house_figure import save
from numpy.typing import NDArray

from common.body.body import ANGLE_NAMES, JOINT_NAMES, LIMB_ENDS, POSE_INDEX, Vector, rest_pose
from common.body.extremities import ALL_JOINT_NAMES, extremities
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.rig.camera import arrays_of, paper_rig

Floats = NDArray[np.float64]
STATURE_M: Final = 1.75
BODY: Final = body_vector(thesis_bdp(STATURE_M))
GREY, RIGHT, LEFT, TRUNK = "#c9c9cf", "#c0392b", "#1f6fb2", "#3b3b44"


class Shown(NamedTuple):
    """How one angle is shown."""

    view: str
    """front: as camera 1 sees who faces it; side: from their right, as camera 2; top: from above,
    who faces camera 1 faces down."""
    by_deg: float
    says: str
    base: Mapping[str, float] = MappingProxyType({})
    """Other angles of both bodies: a twist shows only on what is bent."""


def shown() -> dict[str, Shown]:
    """Of each of ANGLE_NAMES, in words what it does."""
    stretched = {"r_shoulder_z": 90.0, "l_shoulder_z": 270.0}
    told = {"torso_y": Shown("top", 40.0, "turns to the own left", stretched)}
    for side in ("r", "l"):
        right = side == "r"
        bent = {f"{side}_elbow_x": 90.0}
        lifted = {f"{side}_hip_x": 60.0, f"{side}_knee_x": -90.0}
        arm = {f"{side}_shoulder_z": 110.0 if right else 210.0}
        leg = {f"{side}_hip_z": 150.0 if right else 180.0}
        told |= {
            f"{side}_shoulder_x": Shown("side", 40.0, "swings forward"),
            f"{side}_shoulder_y": Shown(
                "top", 40.0, f"turns a bent arm {'back' if right else 'forward'}", bent
            ),
            f"{side}_shoulder_z": Shown(
                "front", 40.0, "90 level, 180 hanging" if right else "180 hanging, 270 level", arm
            ),
            f"{side}_elbow_x": Shown("front", 70.0, "bends"),
            f"{side}_hip_x": Shown("side", 40.0, "swings forward"),
            f"{side}_hip_y": Shown(
                "front", 40.0, f"turns a bent leg {'inwards' if right else 'outwards'}", lifted
            ),
            f"{side}_hip_z": Shown(
                "front",
                30.0,
                "180 hanging, less is out" if right else "180 hanging, more is out",
                leg,
            ),
            f"{side}_knee_x": Shown("side", -60.0, "less than 0 bends"),
        }
    return told


def places(pose: Vector) -> Floats:
    """(15, 3) of a pose."""
    return np.asarray(joints(BODY, pose))


def flat(places_m: Floats, view: str) -> Floats:
    """Where a view has places, (n, 2)."""
    x, y, z = places_m.T
    if view == "front":
        return np.stack([x, y], axis=1)
    if view == "top":
        return np.stack([x, -z], axis=1)
    return np.stack([z, y], axis=1)  # camera 2 looks along +x: what is nearer to camera 1 is right


def draw_body(axes: Any, places_m: Floats, view: str, moved: Floats | None = None) -> None:
    """A stick body; where another one is given, only what of it differs, in colour."""
    at = flat(places_m, view)
    lines = [
        *LIMB_ENDS.tolist(),
        [JOINT_NAMES.index("l_shoulder"), JOINT_NAMES.index("r_shoulder")],
    ]
    lines.append([JOINT_NAMES.index("l_hip"), JOINT_NAMES.index("r_hip")])
    for near, far in lines:
        name, colour = JOINT_NAMES[far], GREY
        if moved is not None:
            if max(np.linalg.norm((moved - places_m)[[near, far]], axis=1)) < 0.005:
                continue
            colour = {"l": LEFT, "r": RIGHT}[name[0]] if name[1] == "_" else TRUNK
        axes.plot(*at[[near, far]].T, color=colour, lw=5.0, solid_capstyle="round")
    if moved is None:
        axes.plot(*at[JOINT_NAMES.index("head_top")], "o", color=GREY, ms=9)


def draw_angle(axes: Any, name: str, told: Shown) -> None:
    """One angle: before and after."""
    pose = rest_pose()
    for other, angle_deg in told.base.items():
        pose[POSE_INDEX[other]] = angle_deg
    after = pose.copy()
    after[POSE_INDEX[name]] += told.by_deg
    old, new = places(pose), places(after)
    draw_body(axes, old, told.view)
    draw_body(axes, new, told.view, old)
    tip = int(np.linalg.norm(new - old, axis=1).argmax())
    ends = flat(np.stack([old[tip], new[tip]]), told.view)
    middle = flat(np.stack([old, new]).mean(axis=0), told.view)[tip]
    bow = np.linalg.det([ends[1] - ends[0], flat(old, told.view).mean(axis=0) - middle])
    axes.annotate(
        "",
        ends[1],
        ends[0],
        arrowprops={
            "arrowstyle": "-|>",
            "color": "black",
            "lw": 1.2,
            "connectionstyle": f"arc3,rad={0.3 * np.sign(bow):.1f}",
        },
    )
    low, high = float(pose[POSE_INDEX[name]]), float(after[POSE_INDEX[name]])
    axes.set_title(f"{name}\n{low:g} to {high:g} degrees", size=8.5, weight="bold", pad=2)
    axes.text(
        0.5,
        -0.02,
        f"{told.says}\n({told.view})",
        transform=axes.transAxes,
        ha="center",
        va="top",
        size=8,
    )
    axes.set(xlim=(-0.95, 0.95), ylim=(-1.05, 0.9) if told.view != "top" else (-0.95, 0.95))
    axes.set_aspect("equal")
    axes.axis("off")


def angles_figure(out: Path) -> None:
    """All 17."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 7.6))
    told = shown()
    for n, name in enumerate(ANGLE_NAMES):
        axes = figure.add_axes(((n % 6) / 6, 0.70 - n // 6 * 0.33, 1 / 6, 0.255))
        draw_angle(axes, name, told[name])
    legend = (
        "front: as camera 1\nsees who faces it\nside: from their\nright, as camera 2\n"
        "top: from above,\nahead is down\nred: right, blue: left"
    )
    figure.text(0.835, 0.16, legend, size=8, va="center")
    save(figure, out)


def joints_figure(out: Path) -> None:
    """The names of the 22 joints, and the world."""
    from matplotlib.figure import Figure

    pose = rest_pose()
    pose[POSE_INDEX["r_shoulder_z"]], pose[POSE_INDEX["l_shoulder_z"]] = 125.0, 235.0
    pose[1] = -places(pose)[JOINT_NAMES.index("l_ankle"), 1] + 0.039 * STATURE_M
    at = places(pose)
    whole = np.concatenate([at, extremities(at, STATURE_M)])
    figure = Figure(figsize=(9.0, 5.2))
    axes = figure.add_axes((0.0, 0.0, 0.62, 1.0))
    _front(axes, at, whole)
    world_axes(figure.add_axes((0.63, 0.05, 0.36, 0.9)))
    save(figure, out)


def _front(axes: Any, at: Floats, whole: Floats) -> None:
    draw_body(axes, at, "front")
    ends = flat(whole, "front")
    for name, (x, y) in zip(ALL_JOINT_NAMES, ends, strict=True):
        measured = name in JOINT_NAMES
        side = {"l_": LEFT, "r_": RIGHT}.get(name[:2], TRUNK)
        axes.plot(x, y, "o" if measured else "D", color=side, ms=6 if measured else 5)
        right = x > 0.01 or name in ("neck", "pelvis")
        down = {"heel": 0, "toe": -11, "knuckle": -11}.get(name[2:], -14 if name == "pelvis" else 3)
        axes.annotate(
            name,
            (x, y),
            (8 if right and name != "pelvis" else -8, down),
            textcoords="offset points",
            ha="left" if right and name != "pelvis" else "right",
            size=9,
            color=side,
        )
    axes.text(0, -0.12, "dots: the 15 joints; diamonds: what follows them", ha="center", size=9)
    axes.set(xlim=(-1.2, 1.2), ylim=(-0.2, 1.9))
    axes.set_aspect("equal")
    axes.axis("off")


def world_axes(axes: Any) -> None:
    """The paper's rig from above: both cameras, the axes, which way somebody faces."""
    rig = paper_rig((320, 240), (300.0, 300.0), (4.5, 4.5))
    for camera in rig.cameras:
        known = arrays_of(camera)
        x, _, z = known.centre
        ahead = known.R[2] * 0.9
        axes.plot(x, -z, "s", color=TRUNK, ms=10)
        axes.annotate("", (x + ahead[0], -z - ahead[2]), (x, -z), arrowprops={"arrowstyle": "-|>"})
        axes.annotate(camera.name, (x, -z), (9, -14), textcoords="offset points", size=9)
    at = flat(places(rest_pose()), "top")
    shoulders = at[[JOINT_NAMES.index("l_shoulder"), JOINT_NAMES.index("r_shoulder")]]
    axes.plot(*(2.2 * shoulders).T, color=GREY, lw=9, solid_capstyle="round")
    axes.plot(0, 0, "o", color=GREY, ms=12)
    for name, along, colour in (
        ("+x: left", (1.7, 0.0), LEFT),
        ("+z: ahead", (0.0, -1.7), "black"),
    ):
        axes.annotate("", along, (0, 0), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 2})
        axes.annotate(
            name,
            along,
            (-20, 8) if along[0] else (8, 4),
            textcoords="offset points",
            size=9,
            color=colour,
        )
    axes.text(-3.7, 0.45, "+y: up, 0 on the floor", size=9)
    axes.set_title("the paper's rig from above, 1 m a square", size=10)
    axes.tick_params(labelbottom=False, labelleft=False, length=0)
    axes.set_xticks(range(-5, 3))
    axes.set_yticks(range(-5, 2))
    axes.set(xlim=(-5.4, 2.8), ylim=(-5.6, 1.2))
    axes.set_aspect("equal")
    axes.grid(alpha=0.3)


def main() -> None:
    """Draw both."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    angles_figure(folder / "angles.png")
    joints_figure(folder / "joints.png")


if __name__ == "__main__":
    main()
