"""What a lens bends, straightened: the kernel and the network take pictures without distortion."""

from functools import lru_cache

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from common.camera import Camera, Rig
from common.similarity import Mask


def straight(mask: Mask, camera: Camera) -> Mask:
    """A silhouette (H, W) as the camera would show it without distortion.

    What the lens shows beyond the border of that picture is lost; the same mask where it bends
    nothing.
    """
    if not any(camera.distortion):
        return mask
    across, down = _maps(camera, mask.shape[1], mask.shape[0])
    shown = cv2.remap(mask.view(np.uint8), across, down, cv2.INTER_NEAREST)
    return np.asarray(shown > 0)


def straight_camera(camera: Camera) -> Camera:
    """The camera that takes such pictures."""
    return msgspec.structs.replace(camera, distortion=())


def straight_rig(rig: Rig) -> Rig:
    """The cameras that take such pictures."""
    if not any(any(camera.distortion) for camera in rig.cameras):
        return rig
    cameras = tuple(straight_camera(camera) for camera in rig.cameras)
    return msgspec.structs.replace(rig, cameras=cameras, distortion=())


@lru_cache(maxsize=4)
def _maps(
    camera: Camera, width: int, height: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Where the bent picture has each pixel of the straight one; OpenCV's begin in their middle."""
    K = np.array(camera.K)
    K[:2, 2] -= 0.5
    across, down = cv2.initUndistortRectifyMap(
        K, np.array(camera.distortion), np.eye(3), K, (width, height), cv2.CV_32FC1
    )
    return np.asarray(across), np.asarray(down)
