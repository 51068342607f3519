"""glTF: an animated skinned stick figure in one binary file, for browsers and engines.

Source: Khronos glTF 2.0 specification, sections 3.6 (accessors), 3.7.3 (skins), 3.11 (animations),
4 (GLB). Metres, +y up, the figure faces +z, as the specification requires. Each node's own +y
points along its bone, by which programs draw bones; the hips' own axes are the world's.
"""

import struct
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from animator.exchange.sticks import COLOUR, Sticks, sticks_of
from animator.skeleton.bones import BONES, Motion, Skeleton, offset_m, rest_origins_m
from animator.turns import arc, unbroken
from common.body.body import Vector
from common.npz_file import Facts

FLOAT, USHORT, UINT = 5126, 5123, 5125
VERTICES, INDICES = 34962, 34963
"""What the specification calls ARRAY_BUFFER and ELEMENT_ARRAY_BUFFER."""
KINDS: Final = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
UP: Final = np.array([0.0, 1.0, 0.0])
DTYPES: Final = {"float32": FLOAT, "uint16": USHORT, "uint32": UINT}


class _Buffer:
    """The binary half of the file, and its layout."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[Facts] = []
        self.accessors: list[Facts] = []

    def add(self, values: NDArray[Any], target: int | None = None) -> int:
        """Append an array to the buffer; returns its accessor's index. All arrays of the figure
        have a multiple of four bytes, so each is aligned as the format requires."""
        start, content = len(self.data), np.ascontiguousarray(values).tobytes()
        self.data += content
        view = {"buffer": 0, "byteOffset": start, "byteLength": len(content)}
        self.views.append(view | ({"target": target} if target else {}))
        flat = values.reshape(len(values), -1)
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": DTYPES[values.dtype.name],
                "count": len(values),
                "type": KINDS[values.shape[1:]],
                "min": flat.min(axis=0).tolist(),
                "max": flat.max(axis=0).tolist(),
            }
        )
        return len(self.accessors) - 1


def gltf_bytes(skeleton: Skeleton, motion: Motion, step_s: float) -> bytes:
    """A GLB file.

    Args:
        skeleton: The body.
        motion: (n,) its motion.
        step_s: Seconds per frame.
    """
    buffer = _Buffer()
    figure = _figure(buffer, sticks_of(skeleton))
    rests = rest_turns(skeleton)
    nodes = _nodes(skeleton, rests)
    moves = _animation(buffer, motion, step_s, rests)
    inverse = np.tile(np.eye(4, dtype=np.float32), (len(skeleton.bones), 1, 1))
    inverse[:, :3, :3] = rests.as_matrix()  # stored column by column: this is its transpose
    inverse[:, 3, :3] = rests.inv().apply(-rest_origins_m(skeleton))
    content = {
        "asset": {"version": "2.0", "generator": "tritrack"},
        "scene": 0,
        "scenes": [{"nodes": [0, len(nodes) - 1]}],
        "nodes": nodes,
        "meshes": [{"name": "Body", "primitives": [figure]}],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [*COLOUR, 1.0], "metallicFactor": 0.0}}
        ],
        "skins": [
            {
                "joints": [*range(len(skeleton.bones))],
                "skeleton": 0,
                "inverseBindMatrices": buffer.add(inverse),
            }
        ],
        "animations": [moves],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    return _glb(msgspec.json.encode(content), bytes(buffer.data))


def rest_turns(skeleton: Skeleton) -> Rotation:
    """Turns of the nodes in the world at rest, (bones,): +y to each bone's tip."""
    along = skeleton.tips_m.copy()
    along[0] = UP
    return arc(UP, along)


def _nodes(skeleton: Skeleton, rests: Rotation) -> list[Facts]:
    """The bones, then a node at the end of each bone without children, then the skinned mesh."""
    nodes: list[Facts] = []
    for i, bone in enumerate(skeleton.bones):
        children = [n for n, other in enumerate(skeleton.bones) if other.parent == i]
        nodes.append(
            {
                "name": bone.name,
                "translation": _offset_m(skeleton, rests, i).tolist(),
                "rotation": _in_parent(rests, i).as_quat().tolist(),
            }
            | ({"children": children} if children else {})
        )
    for i, node in enumerate(nodes[:]):
        if "children" not in node:
            node["children"] = [len(nodes)]
            tip_m = rests[i].inv().apply(skeleton.tips_m[i])
            nodes.append({"name": f"{BONES[i].name}_end", "translation": tip_m.tolist()})
    return [*nodes, {"name": "Body", "mesh": 0, "skin": 0}]


def _offset_m(skeleton: Skeleton, rests: Rotation, bone: int) -> Vector:
    """From the parent's joint to the bone's own in the parent's axes at rest, (3,); of the hips
    from the floor."""
    if bone == 0:
        place: Vector = rest_origins_m(skeleton)[0]
        return place
    own: Vector = rests[BONES[bone].parent].inv().apply(offset_m(skeleton, bone))
    return own


def _in_parent(rests: Rotation, bone: int) -> Rotation:
    """A node's turn at rest in its parent's axes."""
    parent = BONES[bone].parent
    return rests[bone] if parent < 0 else rests[parent].inv() * rests[bone]


def _figure(buffer: _Buffer, sticks: Sticks) -> Facts:
    joints = np.zeros((len(sticks.bones), 4), np.uint16)
    joints[:, 0] = sticks.bones
    weights = np.zeros((len(sticks.bones), 4), np.float32)
    weights[:, 0] = 1.0
    return {
        "attributes": {
            "POSITION": buffer.add(sticks.places_m, VERTICES),
            "JOINTS_0": buffer.add(joints, VERTICES),
            "WEIGHTS_0": buffer.add(weights, VERTICES),
        },
        "indices": buffer.add(sticks.faces.reshape(-1), INDICES),
        "material": 0,
    }


def _animation(buffer: _Buffer, motion: Motion, step_s: float, rests: Rotation) -> Facts:
    """Of turns that are the identity at rest, those of nodes that rest as these."""
    times = buffer.add((np.arange(len(motion.root_m)) * step_s).astype(np.float32))
    tracks = [(0, "translation", motion.root_m)]
    for i, own in enumerate(motion.turns):
        parent = BONES[i].parent
        turned = own * rests[i] if parent < 0 else rests[parent].inv() * own * rests[i]
        tracks.append((i, "rotation", unbroken(turned.as_quat())))
    samplers = [
        {"input": times, "output": buffer.add(values.astype(np.float32))}
        for _node, _path, values in tracks
    ]
    channels = [
        {"sampler": i, "target": {"node": node, "path": path}}
        for i, (node, path, _) in enumerate(tracks)
    ]
    return {"name": "Motion", "samplers": samplers, "channels": channels}


def _glb(content: bytes, data: bytes) -> bytes:
    content += b" " * (-len(content) % 4)
    chunks = struct.pack("<I4s", len(content), b"JSON") + content
    chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
