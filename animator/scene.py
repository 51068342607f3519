"""The newest messages as shapes in the room, ready to be drawn."""

import math
from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from common.body.body import JOINT_NAMES, LIMBS, Bdp, Elliptic, Round, Vector
from common.body.kinematics import HEAD, TORSO, limb_frames
from common.body.proportions import body_vector
from common.bus.messages import Body, Picture, Posture, View
from common.rig.camera import Camera, Rig, centre

Colour = tuple[int, int, int]
Colours = NDArray[np.uint8]

LEFT: Final[Colour] = (224, 146, 68)
"""Colour of the body's left side: amber. It and RIGHT are distinct for colour-blind people."""
RIGHT: Final[Colour] = (66, 122, 184)
TRUNK: Final[Colour] = (140, 152, 166)
PEOPLE: Final[tuple[Colour, ...]] = (
    (0, 114, 178),
    (230, 159, 0),
    (0, 158, 115),
    (204, 121, 167),
    (213, 94, 0),
    (86, 180, 233),
)
"""Colours of the people of a run that follows several, the first person's first; distinct for
colour-blind people. Source: Okabe & Ito 2008, Color Universal Design."""
UNSURE: Final[Colour] = (222, 225, 229)
"""Colour of a limb with confidence 0."""

BEHIND, ABOVE = 1.3, 0.45
"""The spectator's distance behind and above the cameras, in distances of the farthest one."""

NEAR_ENDS: Final = [i for i in range(len(LIMBS)) if i not in (TORSO, HEAD)]
HANDS: Final = [LIMBS.index("r_lower_arm"), LIMBS.index("l_lower_arm")]

_DISTAL: Final = {
    "upper_leg": "knee",
    "lower_leg": "ankle",
    "upper_arm": "elbow",
    "lower_arm": "wrist",
}
_JOINT_OF_LIMB: Final = tuple(
    JOINT_NAMES.index(
        {"torso": "pelvis", "head": "head_top"}.get(limb) or f"{limb[0]}_{_DISTAL[limb[2:]]}"
    )
    for limb in LIMBS
)
"""Index of the landmark whose confidence a limb has: the one at its far end."""


class Known(msgspec.Struct, frozen=True):
    """A person of an instant."""

    body: Body
    posture: Posture | None = None
    performed: str = ""
    """Posture of their last reported performance."""


class Snapshot(msgspec.Struct, frozen=True):
    """The newest message of everything that is shown; None for one that has not come yet."""

    body: Body | None = None
    """Of several people, that of the lowest number."""
    reports: Mapping[int, View] = {}
    """By viewer."""
    pictures: Mapping[int, Picture] = {}
    """By viewer."""
    posture: Posture | None = None
    """Of the same person."""
    performed: str = ""
    """Posture of the last reported performance."""
    others: tuple[Known, ...] = ()
    """All other people of the instant, by number."""


class Figure(NamedTuple):
    """A body that can be drawn."""

    bdp: Bdp
    pose: Vector
    """(25,), POSE_NAMES order."""
    confidence: tuple[float, ...] = ()
    """JOINT_NAMES order, in [0, 1]; empty: all are sure."""
    person: int = 0
    """As in the body; it sets the colour."""


class Shapes(NamedTuple):
    """Copies of one unit shape: scaled, then turned, then moved."""

    positions: Vector
    """(n, 3), metres."""
    wxyzs: Vector
    """(n, 4), unit quaternions."""
    scales: Vector
    """(n, 3), metres."""
    colours: Colours
    """(n, 3), red, green, blue."""


class Frustum(NamedTuple):
    """A camera in the room: it looks along its +z, its picture's rows run along +y."""

    position: Vector
    wxyz: Vector
    fov_rad: float
    """Vertical angle of view."""
    aspect: float
    """Width of the view over its height."""


class Viewpoint(NamedTuple):
    """The spectator's place, and the point looked at."""

    position: Vector
    look_at: Vector


def snapshot_of(
    bodies: Sequence[Body],
    postures: Mapping[int, Posture],
    performed: Mapping[int, str],
    reports: Mapping[int, View],
    pictures: Mapping[int, Picture] = {},
) -> Snapshot:
    """What is shown of an instant.

    Args:
        bodies: One or more, by number.
        postures: By person.
        performed: By person, the posture of their last reported performance.
        reports: By viewer.
        pictures: By viewer.
    """
    first, *others = (
        Known(body, postures.get(body.person), performed.get(body.person, "")) for body in bodies
    )
    return Snapshot(first.body, reports, pictures, first.posture, first.performed, tuple(others))


def figure(body: Body | None) -> Figure | None:
    """The drawable part of a body; None where it has no pose or no measures."""
    if body is None or not body.pose or body.bdp is None:
        return None
    return Figure(body.bdp, np.array(body.pose), body.confidence, body.person)


def limb_shapes(figure: Figure) -> Shapes:
    """The ten limbs as copies of the unit cylinder, in the order of LIMBS (P55)."""
    frames = limb_frames(body_vector(figure.bdp), figure.pose)
    wxyzs = Rotation.from_matrix(frames[:, 3:].reshape(-1, 3, 3)).as_quat(scalar_first=True)
    scales = np.array([half_sizes(getattr(figure.bdp, limb)) for limb in LIMBS])
    return Shapes(frames[:, :3], wxyzs, scales, limb_colours(figure.confidence, figure.person))


def round_shapes(limbs: Shapes) -> Shapes:
    """Round parts, as copies of the unit ball: the head, every near end of an arm's or a leg's
    cylinder, the two hands.

    The balls close the gap between two cylinders at a bent joint; a model's arms have round ends.
    """
    turns = Rotation.from_quat(limbs.wxyzs, scalar_first=True)
    far = limbs.positions + turns.apply(limbs.scales * (0.0, 1.0, 0.0))
    shapes = rows_of(limbs, [HEAD, *NEAR_ENDS, *HANDS])
    shapes.scales[:, 1] = np.minimum(shapes.scales[:, 0], shapes.scales[:, 2])
    shapes.scales[0, 1] = limbs.scales[HEAD, 1] / 2
    shapes.positions[0] = (limbs.positions[HEAD] + far[HEAD]) / 2
    shapes.positions[-len(HANDS) :] = far[HANDS]
    return shapes


def rows_of(shapes: Shapes, rows: list[int]) -> Shapes:
    """Some of the copies, in the given order."""
    return Shapes(
        shapes.positions[rows], shapes.wxyzs[rows], shapes.scales[rows], shapes.colours[rows]
    )


def limb_colours(confidence: tuple[float, ...] = (), person: int = 0) -> Colours:
    """The colour of each limb, (10, 3): by side, or of one of several people by person; faded
    where its far joint is unsure."""
    sides = [limb[0] if limb[1] == "_" else "" for limb in LIMBS]
    full = np.array([side_colour(side, person) for side in sides], float)
    if not confidence:
        return full.astype(np.uint8)
    return faded(full, np.array(confidence)[list(_JOINT_OF_LIMB)])


def side_colour(side: str, person: int) -> Colour:
    """The colour of a part of the body on a side, l, r or "" for neither.

    All parts of one of several people have that person's colour.
    """
    if person:
        return PEOPLE[(person - 1) % len(PEOPLE)]
    return {"l": LEFT, "r": RIGHT}.get(side, TRUNK)


def faded(full: Vector, strength: Vector) -> Colours:
    """Colours (n, 3) that fade to UNSURE as their strength (n,) falls from 1 to 0."""
    colours: Colours = np.rint(UNSURE + strength[:, None] * (full - UNSURE)).astype(np.uint8)
    return colours


def frustum(camera: Camera, size: tuple[int, int]) -> Frustum:
    """A camera's place and field of view; a principal point off the centre is not shown."""
    (width, height), K = size, np.array(camera.K)
    return Frustum(
        position=centre(camera),
        wxyz=Rotation.from_matrix(np.array(camera.R).T).as_quat(scalar_first=True),
        fov_rad=2.0 * math.atan(height / (2.0 * K[1, 1])),
        aspect=float((width / K[0, 0]) / (height / K[1, 1])),
    )


def viewpoint(rig: Rig) -> Viewpoint:
    """A viewpoint behind and above the cameras from which both of their pictures are readable.

    It looks at the middle of the room: the point nearest to the axes of all cameras. A single
    camera, or two that face each other, are looked at from the side.
    """
    places = np.array([centre(camera) for camera in rig.cameras])
    axes = np.array([camera.R[2] for camera in rig.cameras])
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    middle = np.linalg.lstsq(
        across.reshape(-1, 3), (across @ places[:, :, None]).ravel(), rcond=1e-6
    )[0]
    out = (places - middle) * (1.0, 0.0, 1.0)
    distance_m = max(1.0, float(np.linalg.norm(out, axis=1).max()))
    back = (out / distance_m).sum(axis=0)
    if len(out) == 1 or float(np.linalg.norm(back)) < 0.5:
        back = back + np.cross(out[0] / distance_m, (0.0, 1.0, 0.0))
    back = back / max(float(np.linalg.norm(back)), 1e-9)
    return Viewpoint(middle + distance_m * (BEHIND * back + (0.0, ABOVE, 0.0)), middle)


def half_sizes(part: Elliptic | Round) -> tuple[float, float, float]:
    """Half width from side to side, height, and half width from front to back of a cylinder."""
    if isinstance(part, Elliptic):
        return part.long_radius, part.height, part.short_radius
    return part.radius, part.height, part.radius
