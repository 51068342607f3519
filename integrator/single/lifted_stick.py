"""The stick body of one view lifted into the world: depths, signs, orientation (thesis 3.1.5)."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, Vector
from common.body.kinematics import HEAD
from common.body.observation import Fit
from common.bus.messages import Lifting
from common.rig.camera import centre
from integrator.single import depth_signs
from integrator.single.lifting import Lifted, StickPicture, lift
from integrator.single.sight import Hypothesis, Sight, posed
from integrator.single.stick_similarity import stick_similarity

UNSEEN: Final = 0.25
"""Factor on the confidence of a hidden segment's end."""
TILTED_DEG: Final = 15.0
"""Lean, below which a segment hardly moves with its sign."""


def step(memory: depth_signs.Memory, sight: Sight) -> tuple[depth_signs.Memory, Hypothesis]:
    """The stick body of a view in the world, its signs and orientation chosen or annotated.

    Args:
        memory: Of the frame before.
        sight: A view whose person has a stick body.
    """
    fit, annotations = sight.person.stick, sight.annotations
    assert fit is not None
    lengths_m = sight.man.lengths * sight.stature_m
    px_per_m = fit.stature_px / sight.stature_m
    picture = StickPicture(np.array(fit.joints_px), fit.breadth, lengths_m, px_per_m)
    choice = depth_signs.choose(memory, picture, annotations.depth, annotations.orientation)
    lifted = lift(picture, choice.signs, choice.orientation)
    pixels = picture.of_own_sides(choice.orientation)
    for name, place in annotations.joints_px.items():
        pixels[JOINT_NAMES.index(name)] = place
    pose, joints_m = posed(sight, in_world(sight, pixels, lifted, px_per_m))
    score = fit.score if sight.method.stick_lifting else stick_similarity(sight, joints_m)
    lifting = Lifting(
        choice.orientation,
        choice.orientation_confidence,
        tuple(choice.confidence.tolist()),
        tuple(lifted.error_deg.tolist()),
    )
    confidence = _confidence(fit, lifted, choice)
    memory = depth_signs.remembered(memory, lifted.joints_m, choice)
    return memory, Hypothesis(joints_m, pose, score, confidence, lifting)


def in_world(
    sight: Sight, pixels: NDArray[np.float64], lifted: Lifted, px_per_m: float
) -> NDArray[np.float64]:
    """The joints in the world, (15, 3) metres, at the depth that gives the person's stature.

    The thesis prints scaled orthography (T19): every joint's ray is cut at one depth.
    """
    camera = sight.camera
    K = np.array(camera.K)
    depth_m = K[1, 1] / px_per_m
    plane = (pixels - K[:2, 2]) / np.array([K[0, 0], K[1, 1]])
    if any(camera.distortion):
        plane = cv2.undistortPoints(pixels[:, None], K, np.array(camera.distortion))[:, 0]
    own_m = depth_m - lifted.joints_m[:, 2]
    ray_m = np.full(len(pixels), depth_m) if sight.method.stick_lifting else own_m
    seen = np.concatenate([plane * ray_m[:, None], own_m[:, None]], axis=1)
    world: NDArray[np.float64] = centre(camera) + seen @ np.array(camera.R)
    return world


def _confidence(fit: Fit, lifted: Lifted, choice: depth_signs.Choice) -> Vector:
    """Confidence of each joint: from the fit, from hidden segments, and from the sign where it
    matters."""
    found = np.full(len(JOINT_NAMES), fit.score)
    for limb, (near, far) in enumerate(LIMB_ENDS):
        own = UNSEEN if fit.hidden[limb] else 1.0
        if abs(lifted.tilt_deg[limb]) > TILTED_DEG:
            own *= float(choice.confidence[limb])
        found[far] = (found[near] if limb > HEAD else found[far]) * own
    return found
