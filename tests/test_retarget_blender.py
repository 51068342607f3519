"""The example that puts a run on another character: its limbs point where ours do, in Blender."""

from pathlib import Path

import numpy as np
import pytest
from clients import answer_of
from moving import random_joints

from animator.bvh import bvh_text, steady

SCRIPTS = Path(__file__).parents[1] / "docs/scripts"
CHARACTER = """
import bpy, json, math, sys
from mathutils import Matrix, Vector
sys.path.insert(0, sys.argv[2])
from retarget_blender import NAMES, retarget
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_anim.bvh(filepath=sys.argv[1], update_scene_fps=True)
ours = bpy.context.object
# A character of 1.4 times the size with hanging arms, rolled bones and Mixamo's names, and turned.
data = bpy.data.armatures.new("own")
own = bpy.data.objects.new("own", data)
bpy.context.scene.collection.objects.link(own)
own.rotation_euler = (0.0, 0.0, 0.4)
bpy.context.view_layer.objects.active = own
bpy.ops.object.mode_set(mode="EDIT")
names = {name: theirs[0] for name, theirs in NAMES.items() if name in ours.data.bones}
for name, mixamo in names.items():
    rest = ours.data.bones[name]
    bone = data.edit_bones.new(mixamo)
    side = 1 if "Left" in name else -1
    arm = any(part in name for part in ("Arm", "Hand"))
    pivot = ours.matrix_world @ ours.data.bones["LeftArm" if side == 1 else "RightArm"].head_local
    turn = Matrix.Rotation(side * math.radians(50), 3, "Y") if arm else Matrix.Identity(3)
    def placed(at):
        return 1.4 * (turn @ (ours.matrix_world @ at - pivot) + pivot)
    bone.head, bone.tail = placed(rest.head_local), placed(rest.tail_local)
    bone.roll = 0.7
    if rest.parent:
        bone.parent = data.edit_bones[names[rest.parent.name]]
bpy.ops.object.mode_set(mode="OBJECT")
moved = retarget(ours, own, "mixamo")
def along(armature, name):
    bone = armature.pose.bones[name]
    return list((armature.matrix_world.to_3x3() @ (bone.tail - bone.head)).normalized())
said = []
for frame in (1, 20, 40):
    bpy.context.scene.frame_set(frame)
    said.append({a: [along(ours, a), along(own, b)] for a, b in names.items()})
print(json.dumps([len(moved), said]))
"""
"""Its last line: how many bones moved, and by frame each bone's direction on ours and theirs."""


@pytest.mark.slow
def test_every_limb_of_another_character_points_where_ours_does(tmp_path: Path) -> None:
    skeleton, motion, steps = steady(random_joints(3), np.arange(40) / 15)
    (tmp_path / "body.bvh").write_text(bvh_text(skeleton, motion, steps.step_s, "m"))
    found = answer_of("bpy", CHARACTER, str(tmp_path / "body.bvh"), str(SCRIPTS))
    moved, said = found
    assert moved == len(skeleton.bones)
    for frame in said:
        for name in (bone.name for bone in skeleton.bones):
            ours, theirs = frame[name]
            assert theirs == pytest.approx(ours, abs=2e-3), name
