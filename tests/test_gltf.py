"""glTF, opened by readers that are not ours: the skeleton stands where ours does."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from clients import answer_of
from moving import random_joints
from scipy.spatial.transform import Rotation

from animator.bvh import steady
from animator.exchange.gltf import gltf_bytes
from animator.skeleton.bones import BONES, joints_of
from common.body.body import JOINT_NAMES

WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
DTYPES = {5126: "<f4", 5123: "<u2", 5125: "<u4"}

BLENDER = """
import bpy, json, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 15
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
body = next(each for each in bpy.data.objects if each.type == "ARMATURE")
mesh = next(each for each in bpy.data.objects if each.name == "Body")
said = {"skinned": any(each.type == "ARMATURE" for each in mesh.modifiers), "frames": []}
for frame in (0, 20, 39):
    bpy.context.scene.frame_set(frame)
    said["frames"].append({b.name: list(body.matrix_world @ b.head) for b in body.pose.bones})
print(json.dumps(said))
"""


def made(seed: int = 3) -> tuple[Any, Any, bytes]:
    skeleton, motion, steps = steady(random_joints(seed), np.arange(40) / 15)
    return skeleton, motion, gltf_bytes(skeleton, motion, steps.step_s)


def array_of(file: Any, number: int) -> np.ndarray:
    accessor = file.accessors[number]
    view = file.bufferViews[accessor.bufferView]
    dtype = np.dtype(DTYPES[accessor.componentType])
    count = accessor.count * WIDTHS[accessor.type]
    values = np.frombuffer(file.binary_blob(), dtype, count, view.byteOffset or 0)
    return values.reshape(accessor.count, -1).copy()


def places_of(file: Any) -> tuple[dict[str, np.ndarray], dict[str, Rotation]]:
    """(n, 3) of every node of the skeleton, by its parents and the animation."""
    tracks = {
        (channel.target.node, channel.target.path): array_of(
            file, file.animations[0].samplers[channel.sampler].output
        )
        for channel in file.animations[0].channels
    }
    places: dict[str, np.ndarray] = {}
    turns: dict[str, Rotation] = {}

    def walk(number: int, place: np.ndarray, turn: Rotation) -> None:
        node = file.nodes[number]
        shift = tracks.get((number, "translation"), np.array(node.translation)[None])
        own = tracks.get((number, "rotation"))
        places[node.name] = place + turn.apply(shift + np.zeros((40, 3)))
        turns[node.name] = turn if own is None else turn * Rotation.from_quat(own)
        assert own is not None or node.rotation is None, "only ends have no track"
        for child in node.children or ():
            walk(child, places[node.name], turns[node.name])

    walk(0, np.zeros((40, 3)), Rotation.identity(40))
    return places, turns


def test_the_animated_nodes_stand_where_the_skeleton_does() -> None:
    """Within 1 mm, joints and ends, as the specification multiplies nodes."""
    pygltflib = pytest.importorskip("pygltflib", reason="pip install pygltflib")
    skeleton, motion, content = made()
    places, _ = places_of(pygltflib.GLTF2.load_from_bytes(content))
    expected = joints_of(skeleton, motion)
    for bone in skeleton.bones:
        off = places[bone.name] - expected[:, JOINT_NAMES.index(bone.starts)]
        assert np.linalg.norm(off, axis=1).max() < 1e-3
        if f"{bone.name}_end" in places:
            off = places[f"{bone.name}_end"] - expected[:, JOINT_NAMES.index(bone.ends)]
            assert np.linalg.norm(off, axis=1).max() < 1e-3


def test_every_stick_is_bound_to_its_bone_and_goes_with_it() -> None:
    """A point of the skin, moved as the specification moves it, keeps its place on the bone."""
    pygltflib = pytest.importorskip("pygltflib", reason="pip install pygltflib")
    skeleton, motion, content = made(5)
    file = pygltflib.GLTF2.load_from_bytes(content)
    places, turns = places_of(file)
    attributes = file.meshes[0].primitives[0].attributes
    skin = array_of(file, attributes.POSITION)
    owner = array_of(file, attributes.JOINTS_0)[:, 0]
    inverse = array_of(file, file.skins[0].inverseBindMatrices).reshape(-1, 4, 4)
    expected = joints_of(skeleton, motion)[20]
    for i, bone in enumerate(skeleton.bones):
        at_bone = skin[owner == i] @ inverse[i, :3, :3] + inverse[i, 3, :3]
        moved = places[bone.name][20] + turns[bone.name][20].apply(at_bone)
        ends = [expected[JOINT_NAMES.index(name)] for name in (bone.starts, bone.ends)]
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        heights = (moved - ends[0]) @ along
        assert heights.min() == pytest.approx(0.0, abs=1e-3)
        assert heights.max() == pytest.approx(float(np.linalg.norm(ends[1] - ends[0])), abs=1e-3)


def test_at_rest_the_feet_are_on_the_floor_and_each_bone_points_to_its_end_by_its_own_y() -> None:
    """As Blender and engines draw bones: along a node's own +y."""
    pygltflib = pytest.importorskip("pygltflib", reason="pip install pygltflib")
    skeleton, _, content = made()
    file = pygltflib.GLTF2.load_from_bytes(content)
    places, turns = {}, {}

    def walk(number: int, place: np.ndarray, turn: Rotation) -> None:
        node = file.nodes[number]
        places[node.name] = place + turn.apply(np.array(node.translation))
        turns[node.name] = turn * Rotation.from_quat(node.rotation or [0.0, 0.0, 0.0, 1.0])
        for child in node.children or ():
            walk(child, places[node.name], turns[node.name])

    walk(0, np.zeros(3), Rotation.identity())
    assert min(place[1] for place in places.values()) == pytest.approx(0.0, abs=1e-6)
    for i, bone in enumerate(skeleton.bones[1:], 1):
        along = skeleton.tips_m[i] / np.linalg.norm(skeleton.tips_m[i])
        assert turns[bone.name].apply([0.0, 1.0, 0.0]) == pytest.approx(along, abs=1e-5)
    inverse = array_of(file, file.skins[0].inverseBindMatrices).reshape(-1, 4, 4)
    for i, bone in enumerate(skeleton.bones):
        assert places[bone.name] @ inverse[i, :3, :3] + inverse[i, 3, :3] == pytest.approx(
            np.zeros(3), abs=1e-5
        )


def test_a_viewer_of_meshes_opens_it(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh", reason="pip install trimesh")
    path = tmp_path / "body.glb"
    skeleton, _, content = made()
    path.write_bytes(content)
    scene = trimesh.load(path)
    (mesh,) = scene.geometry.values()
    assert len(mesh.faces) > 13 * 100
    wrists = [BONES.index(each) for each in BONES if each.name.endswith("Arm")]
    span_m = np.abs(skeleton.tips_m[wrists, 0]).sum() + abs(skeleton.tips_m[[3, 6], 0]).sum()
    assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(span_m, abs=1e-3)


@pytest.mark.slow
def test_blender_opens_it_as_a_skinned_armature(tmp_path: Path) -> None:
    """Its axes are +z up: (x, y, z) of the file is (x, -z, y) there."""
    skeleton, motion, content = made()
    (tmp_path / "body.glb").write_bytes(content)
    said = answer_of("bpy", BLENDER, str(tmp_path / "body.glb"))
    assert said["skinned"]
    for frame, heads in zip((0, 20, 39), said["frames"], strict=True):
        expected = joints_of(skeleton, motion)[frame]
        for bone in skeleton.bones:
            x, y, z = expected[JOINT_NAMES.index(bone.starts)]
            assert heads[bone.name] == pytest.approx([x, -z, y], abs=1e-3)


def test_frames_are_as_far_apart_as_said_and_arrays_are_what_their_entries_say() -> None:
    pygltflib = pytest.importorskip("pygltflib", reason="pip install pygltflib")
    _, _, content = made()
    file = pygltflib.GLTF2.load_from_bytes(content)
    times = array_of(file, file.animations[0].samplers[0].input)[:, 0]
    assert times == pytest.approx(np.arange(40) / 15, abs=1e-6)
    for number, accessor in enumerate(file.accessors):
        values = array_of(file, number)
        assert accessor.min == pytest.approx(values.min(axis=0).tolist())
        assert accessor.max == pytest.approx(values.max(axis=0).tolist())
        assert file.bufferViews[accessor.bufferView].byteOffset % 4 == 0
    figure = file.meshes[0].primitives[0]
    numbers = vars(figure.attributes)
    drawn = [n for n in (*numbers.values(), figure.indices) if isinstance(n, int)]
    assert len(drawn) == 4
    for number, accessor in enumerate(file.accessors):
        target = file.bufferViews[accessor.bufferView].target
        assert target == ({True: 34963, False: 34962}[number == figure.indices]
                          if number in drawn else None)  # fmt: skip


def test_the_scene_begins_at_the_hips_and_at_the_mesh_and_the_skin_at_its_bones() -> None:
    skeleton, motion, steps = steady(random_joints(3), np.arange(40) / 15)
    content = gltf_content(gltf_bytes(skeleton, motion, steps.step_s))
    hips, mesh = (content["nodes"][n] for n in content["scenes"][content["scene"]]["nodes"])
    assert hips["name"] == "Hips"
    assert (mesh["mesh"], mesh["skin"]) == (0, 0)
    (skin,) = content["skins"]
    assert skin["joints"] == list(range(len(skeleton.bones)))
    assert content["asset"]["version"] == "2.0"
    (material,) = content["materials"]
    assert material["pbrMetallicRoughness"] == {
        "baseColorFactor": [0.55, 0.6, 0.65, 1.0],
        "metallicFactor": 0.0,
    }


def gltf_content(glb: bytes) -> dict[str, Any]:
    """The JSON chunk, after a head of 12 bytes and its own of 8."""
    length = int.from_bytes(glb[12:16], "little")
    content: dict[str, Any] = json.loads(glb[20 : 20 + length])
    return content
