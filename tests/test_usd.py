"""USD, opened by readers that are not ours: the skeleton stands where ours does."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from clients import answer_of
from moving import random_joints

from animator.bvh import steady
from animator.exchange.sticks import sticks_of
from animator.exchange.usd import usd_bytes
from animator.skeleton.bones import BONES, joints_of, rest_origins_m
from common.body.body import JOINT_NAMES

pytest.importorskip("pxr", reason="pip install 'tritrack[usd]'")

BLENDER = """
import bpy, json, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=sys.argv[1])
body = next(each for each in bpy.data.objects if each.type == "ARMATURE")
mesh = next(each for each in bpy.data.objects if each.type == "MESH")
said = {"skinned": any(each.type == "ARMATURE" for each in mesh.modifiers), "frames": []}
for frame in (0, 20, 39):
    bpy.context.scene.frame_set(frame)
    said["frames"].append({b.name: list(body.matrix_world @ b.head) for b in body.pose.bones})
print(json.dumps(said))
"""


def made(path: Path, seed: int = 3) -> tuple[Any, Any]:
    skeleton, motion, steps = steady(random_joints(seed), np.arange(40) / 15)
    path.write_bytes(usd_bytes(skeleton, motion, steps.step_s))
    return skeleton, motion


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "body.usdc"


def test_the_library_puts_every_joint_where_the_skeleton_has_it(path: Path) -> None:
    """Within 1 mm in every frame, by UsdSkel's own evaluation of the file."""
    from pxr import Usd, UsdGeom, UsdSkel

    skeleton, motion = made(path)
    stage = Usd.Stage.Open(str(path))
    query = UsdSkel.Cache().GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Body/Skeleton")))
    names = [each.split("/")[-1] for each in query.GetJointOrder()]
    expected = joints_of(skeleton, motion)
    for frame in range(40):
        placed = np.array(query.ComputeJointSkelTransforms(frame))[:, 3, :3]
        for bone, place in zip(skeleton.bones, placed, strict=True):
            assert names[BONES.index(bone)] == bone.name
            assert place == pytest.approx(expected[frame, JOINT_NAMES.index(bone.starts)], abs=1e-3)
    assert UsdGeom.GetStageUpAxis(stage) == "Y"
    assert stage.GetDefaultPrim().GetPath() == "/Body"
    assert stage.GetFramesPerSecond() == pytest.approx(15)
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 39)
    assert stage.GetTimeCodesPerSecond() == pytest.approx(15)


def test_every_stick_goes_with_its_bone(path: Path) -> None:
    """The skin, moved by UsdSkel, spans each bone from its joint to what it is aimed at."""
    from pxr import Usd, UsdSkel

    skeleton, motion = made(path, 5)
    stage = Usd.Stage.Open(str(path))
    mesh = stage.GetPrimAtPath("/Body/Sticks")
    owner = np.array(UsdSkel.BindingAPI(mesh).GetJointIndicesPrimvar().Get())
    assert UsdSkel.BakeSkinning(UsdSkel.Root(stage.GetPrimAtPath("/Body")))
    skin = np.array(mesh.GetAttribute("points").Get(20))
    expected = joints_of(skeleton, motion)[20]
    for i, bone in enumerate(skeleton.bones):
        start, end = (expected[JOINT_NAMES.index(name)] for name in (bone.starts, bone.ends))
        length_m = float(np.linalg.norm(end - start))
        heights = (skin[owner == i] - start) @ (end - start) / length_m
        assert heights.min() == pytest.approx(0.0, abs=1e-3)
        assert heights.max() == pytest.approx(length_m, abs=1e-3)


def test_the_same_run_makes_the_same_file(tmp_path: Path) -> None:
    made(tmp_path / "a.usdc")
    made(tmp_path / "b.usdc")
    assert (tmp_path / "a.usdc").read_bytes() == (tmp_path / "b.usdc").read_bytes()


@pytest.mark.slow
def test_blender_opens_it_as_a_skinned_armature(path: Path) -> None:
    """Its axes are +z up: (x, y, z) of the file is (x, -z, y) there."""
    skeleton, motion = made(path)
    said = answer_of("bpy", BLENDER, str(path))
    assert said["skinned"]
    for frame, heads in zip((0, 20, 39), said["frames"], strict=True):
        expected = joints_of(skeleton, motion)[frame]
        for bone in skeleton.bones:
            x, y, z = expected[JOINT_NAMES.index(bone.starts)]
            assert heads[bone.name] == pytest.approx([x, -z, y], abs=1e-3)


def test_the_figure_is_of_triangles_bound_to_one_bone_each(path: Path) -> None:
    from pxr import Usd, UsdGeom, UsdSkel

    skeleton, _ = made(path)
    sticks = sticks_of(skeleton)
    stage = Usd.Stage.Open(str(path))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Body/Sticks"))
    assert list(mesh.GetFaceVertexCountsAttr().Get()) == [3] * len(sticks.faces)
    assert list(mesh.GetFaceVertexIndicesAttr().Get()) == sticks.faces.ravel().tolist()
    assert np.array(mesh.GetPointsAttr().Get()) == pytest.approx(sticks.places_m)
    assert mesh.GetSubdivisionSchemeAttr().Get() == "none"
    low, high = np.array(mesh.GetExtentAttr().Get())
    assert low == pytest.approx(sticks.places_m.min(axis=0))
    assert high == pytest.approx(sticks.places_m.max(axis=0))
    (colour,) = mesh.GetDisplayColorAttr().Get()
    assert tuple(colour) == pytest.approx((0.55, 0.6, 0.65))
    binding = UsdSkel.BindingAPI(mesh.GetPrim())
    indices, weights = binding.GetJointIndicesPrimvar(), binding.GetJointWeightsPrimvar()
    assert list(indices.Get()) == sticks.bones.tolist()
    assert list(weights.Get()) == [1.0] * len(sticks.bones)
    assert (indices.GetElementSize(), weights.GetElementSize()) == (1, 1)


def test_the_skeleton_at_rest_is_ours(path: Path) -> None:
    """Rest transforms are told in a parent's axes, bind transforms in the world's; row vectors."""
    from pxr import Usd, UsdSkel

    skeleton, _ = made(path)
    stage = Usd.Stage.Open(str(path))
    bones = UsdSkel.Skeleton(stage.GetPrimAtPath("/Body/Skeleton"))
    rest = np.array(bones.GetRestTransformsAttr().Get())
    bind = np.array(bones.GetBindTransformsAttr().Get())
    for i, bone in enumerate(skeleton.bones):
        above = bind[bone.parent, 3, :3] if bone.parent >= 0 else np.zeros(3)
        assert bind[i, 3, :3] - above == pytest.approx(rest[i, 3, :3], abs=1e-6)
        for found in (rest[i], bind[i]):
            assert (found[:3, :3] == np.eye(3)).all()
            assert found[:, 3].tolist() == [0, 0, 0, 1]
    assert bind[:, 3, :3] == pytest.approx(rest_origins_m(skeleton), abs=1e-6)
    joints = list(bones.GetJointsAttr().Get())
    for path_of, bone in zip(joints, skeleton.bones, strict=True):
        *above_it, own = path_of.split("/")
        assert own == bone.name
        assert "/".join(above_it) == (joints[bone.parent] if bone.parent >= 0 else "")


@pytest.mark.parametrize(("ending", "begins"), [(".usda", b"#usda"), (".usdc", b"PXR-USDC")])
def test_the_ending_tells_the_form(ending: str, begins: bytes) -> None:
    skeleton, motion, steps = steady(random_joints(3), np.arange(40) / 15)
    assert usd_bytes(skeleton, motion, steps.step_s, ending).startswith(begins)
