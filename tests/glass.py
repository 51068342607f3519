"""A rig and a room as a mirror shows them, left for right."""

from typing import Final

import msgspec
import numpy as np

from common.rig.camera import Camera, Rig, as_matrix, as_row

MIRROR: Final = np.array([-1.0, 1.0, 1.0])
"""What a place is multiplied by."""


def in_mirror(rig: Rig) -> Rig:
    """The cameras whose pictures are the rig's, left for right, when the world is."""
    first, second = (_mirrored(camera, rig.width) for camera in rig.cameras)
    return msgspec.structs.replace(rig, cameras=(first, second))


def _mirrored(camera: Camera, width: int) -> Camera:
    K, R = np.array(camera.K), np.array(camera.R)
    K[0, 2] = width - K[0, 2]
    return msgspec.structs.replace(
        camera,
        K=as_matrix(K),
        R=as_matrix(MIRROR[:, None] * R * MIRROR),
        t=as_row(MIRROR * camera.t),
    )
