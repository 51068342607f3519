"""A person who is hidden behind another in the only view: where they are predicted to be."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from common.body.body import Vector
from common.body.observation import Box
from common.bus.instant import Instant
from common.bus.messages import Body, Guide
from common.rig.camera import Camera, Rig, arrays_of, project
from integrator import outgoing
from integrator.people import lived_instant
from integrator.people.known_life import Life, Places
from integrator.rig.undistortion import undistorted_instant, undistorted_rig

HIDDEN_S: Final = 3.0
"""How long they are predicted, seconds."""
STOPS_S: Final = 0.5
"""Time in which their speed falls to a third, seconds: most who are hidden stop there."""
ASIDE_M: Final = 0.4
"""By how much they are moved at most in an instant to be behind another, metres."""
SURELY: Final = 0.3
"""Least mean confidence of the body of which is predicted: of two people in one region an unsure
body is often neither's, and so are those predicted from it (docs/measurements.md)."""


def lived(life: Life, own: Instant, whole: Instant, now_s: float) -> tuple[Life, Body, Guide]:
    """A person whom no view shows, after an instant, with their body and guide. They are predicted
    as long as the one view shows another where they are expected; else they are lost.

    Args:
        life: Before it.
        own: The views without any person.
        whole: The same with everyone.
        now_s: Capture time.
    """
    nobody = (None,) * len(own.views)
    after, lost, guide = lived_instant.lived(life, own, nobody, now_s)
    rig, last = life.state.rig, life.body
    if rig is None or last is None or life.unseen_s(now_s) > HIDDEN_S:
        return after, lost, guide
    velocity_m_s, places_m = _moved(life, rig, whole, now_s)
    if places_m is None or float(np.mean(last.confidence)) < SURELY:
        return after, lost, guide
    by_m = places_m[0] - np.array(last.joints_m[0])
    x, y, z = velocity_m_s.tolist()
    after = after._replace(joints_m=places_m, joints_s=now_s, velocity_m_s=(x, y, z))
    return after, outgoing.predicted(after.state, lost, last, by_m), guide


def _moved(life: Life, rig: Rig, whole: Instant, now_s: float) -> tuple[Vector, Places | None]:
    """Velocity (3,) and joints (15, 3) of a person, world; None where no one hides them.

    A single view shows no speed towards it that could be relied on.
    """
    view = next(n for n, each in enumerate(whole.views) if each is not None)
    camera = undistorted_rig(rig).cameras[view]
    shown = undistorted_instant(rig, whole).views[view]
    right = arrays_of(camera).R[0]
    velocity_m_s = (np.array(life.velocity_m_s) @ right) * right
    dt_s = now_s - life.joints_s
    boxes = () if shown is None else [each.box for each in shown.people]
    places_m = None
    if life.joints_m is not None:
        places_m = behind(camera, rig.width, life.joints_m + dt_s * velocity_m_s, boxes)
    return math.exp(-dt_s / STOPS_S) * velocity_m_s, places_m


def behind(camera: Camera, width: int, joints_m: Places, boxes: Sequence[Box]) -> Places | None:
    """The joints (15, 3), world, moved sideways until another in the picture can hide them: who
    were not behind one would be seen. None where no one is near enough, and outside the picture.

    Args:
        camera: Without distortion.
        width: Of its picture, pixels.
        joints_m: As expected.
        boxes: Of the people whom the picture shows.
    """
    middle_px = float(project(camera, joints_m)[:, 0].mean())
    if not 0.0 <= middle_px < width or not boxes:
        return None
    aside_px = min((min(max(middle_px, b.left), b.right) - middle_px for b in boxes), key=abs)
    known = arrays_of(camera)
    depth_m = float(known.R[2] @ (joints_m.mean(axis=0) - known.centre))
    aside_m = aside_px * depth_m / float(camera.K[0][0])
    return joints_m + aside_m * known.R[0] if abs(aside_m) <= ASIDE_M else None
