"""A rig as no paper has it: cameras that look down, are rolled, and stand 120 degrees apart."""

import math

import msgspec
import numpy as np
from posing import posed

from common.body.body import Vector
from common.body.observation import Observation, Search
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import View, ViewerNumber
from common.raster.kernel import draw_body, view_of
from common.raster.silhouette_report import people_of, silhouette_view, with_person
from common.raster.similarity import Mask
from common.rig.camera import Camera, Rig, as_matrix, as_row

SIZE = (160, 240)
BODY = thesis_bdp(1.75)
LOOKED_AT = np.array([0.0, 0.9, 0.0])


def rolled_camera(name: str, place_m: tuple[float, float, float], roll_deg: float) -> Camera:
    """One that looks at the middle of the room, its picture turned by some degrees."""
    forward = LOOKED_AT - place_m
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    R = np.stack([right, np.cross(forward, right), forward])
    s, c = math.sin(math.radians(roll_deg)), math.cos(math.radians(roll_deg))
    R = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ R
    K = ((230.0, 0.0, SIZE[0] / 2), (0.0, 230.0, SIZE[1] / 2), (0.0, 0.0, 1.0))
    return Camera(name, K, as_matrix(R), as_row(-R @ np.array(place_m)))


ROLLED = Rig(
    *SIZE,
    (
        rolled_camera("one", (2.0, 1.9, 3.2), 12.0),
        rolled_camera("two", (-3.6, 1.9, 0.8), -20.0),
    ),
)


def on_one_leg(lean_deg: float = 45.0) -> Vector:
    """Somebody who leans far over to the right and lifts the left leg level to the side."""
    pose = posed(
        torso_z=lean_deg,
        r_hip_z=180.0 - lean_deg,
        l_hip_z=225.0,
        r_shoulder_z=135.0,
        l_shoulder_z=215.0,
        r_knee_x=-8.0,
        l_knee_x=-8.0,
    )
    pose[:3] = 0.0, 0.95, 0.0
    return pose


def outlines(pose: Vector) -> tuple[Mask, Mask]:
    first, second = (
        draw_body(body_vector(BODY), pose, view_of(camera), SIZE) for camera in ROLLED.cameras
    )
    return first, second


def person_in(mask: Mask) -> Observation:
    """The person of an outline, with a navel that is not in its middle."""
    (person,) = people_of(mask)
    return msgspec.structs.replace(person, search=Search((80.0, 120.0), {}, False, 0.0, 0))


def told(viewer: ViewerNumber, mask: Mask) -> View:
    """What a viewer says of an outline."""
    return with_person(silhouette_view(viewer, mask), person_in(mask))
