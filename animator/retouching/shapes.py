"""Copies of a solid in a page's scene, with one handle for all."""

import numpy as np
import viser

from animator.scene import Shapes
from animator.solids import Mesh


def add_shapes(scene: viser.SceneApi, name: str, mesh: Mesh, count: int) -> viser.BatchedMeshHandle:
    """Copies of a solid; each is invisible until it is placed and shown."""
    return scene.add_batched_meshes_simple(
        name,
        mesh.vertices,
        mesh.faces,
        batched_wxyzs=np.tile((1.0, 0.0, 0.0, 0.0), (count, 1)),
        batched_positions=np.zeros((count, 3)),
        batched_scales=np.ones((count, 3)),
        batched_colors=np.zeros((count, 3), np.uint8),
        lod="off",
        visible=False,
    )


def place_shapes(handle: viser.BatchedMeshHandle, shapes: Shapes) -> None:
    """Set every copy's place, turn, size and colour."""
    handle.batched_positions = shapes.positions
    handle.batched_wxyzs = shapes.wxyzs
    handle.batched_scales = shapes.scales
    handle.batched_colors = shapes.colours
