"""Landmarks as rays in the world."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.bus.instant import Seen
from common.rig.camera import Rig, arrays_of, rays
from integrator.proposal.network_weights import JOINTS

AT: Final = [JOINT_NAMES.index(name) for name in JOINTS]
"""Indices of the twelve proposed joints among the landmarks."""


class Rays(NamedTuple):
    """The rays on which the views see the twelve proposed joints."""

    centres_m: NDArray[np.float64]
    """(V, 3) the cameras."""
    directions: NDArray[np.float64]
    """(V, 12, 3) unit length."""
    confidence: NDArray[np.float64]
    """(V, 12) `Landmarks.confidence`; 0: that view has no landmarks."""
    others: NDArray[np.float64]
    """(V, 12, 3) rays of the second candidates, as `directions`."""
    others_confidence: NDArray[np.float64]
    """(V, 12) their confidence; 0: that view has one place alone."""
    rotations: NDArray[np.float64]
    """(V, 3, 3) from the world to each camera."""
    facing_deg: tuple[float, ...]
    """Facing: 0 towards the camera, 90 to the right of its picture."""
    facing_confidence: tuple[float, ...]
    """Confidence of the facing; 0: that view reports none."""


def rays_of(rig: Rig, seen: Seen) -> Rays | None:
    """The rays of an instant; None where no view reports landmarks.

    Args:
        rig: V cameras without distortion.
        seen: The person in each view, without distortion; None where it has none.
    """
    shown = [None if person is None else person.landmarks for person in seen]
    if all(landmarks is None for landmarks in shown):
        return None
    directions = np.zeros((2, len(shown), len(AT), 3))
    confidence = np.zeros((2, len(shown), len(AT)))
    for view, (camera, landmarks) in enumerate(zip(rig.cameras, shown, strict=True)):
        if landmarks is not None:
            directions[0, view] = rays(camera, np.array(landmarks.joints_px)[AT])
            confidence[0, view] = np.array(landmarks.confidence)[AT]
        if landmarks is not None and landmarks.second_px:
            directions[1, view] = rays(camera, np.array(landmarks.second_px)[AT])
            confidence[1, view] = np.array(landmarks.second_confidence)[AT]
    cameras = [arrays_of(camera) for camera in rig.cameras]
    facings = [
        (0.0, 0.0) if each is None else (each.facing_deg, each.facing_confidence) for each in shown
    ]
    return Rays(
        np.stack([camera.centre for camera in cameras]),
        directions[0],
        confidence[0],
        directions[1],
        confidence[1],
        np.stack([camera.R for camera in cameras]),
        tuple(deg for deg, _ in facings),
        tuple(sure for _, sure in facings),
    )
