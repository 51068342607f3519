"""Put a run's motion on a character of your own, in Blender.

    blender --background character.blend --python retarget_blender.py -- body.bvh out.blend mixamo

The last word is mixamo, rigify, unreal or vrm; the character is the first armature of its scene.
Each bone gets the turn of ours in the world, so that the rests of the two may differ; the hips move
as ours do, by the ratio of the legs. Names of other rigs: add a column to NAMES.
"""

import sys

import bpy
from mathutils import Matrix, Quaternion, Vector

NAMES = {
    # ours: mixamo, rigify, unreal, vrm (what Unity calls them)
    "Hips": ("mixamorig:Hips", "spine", "pelvis", "hips"),
    "Spine": ("mixamorig:Spine", "spine.001", "spine_01", "spine"),
    "Head": ("mixamorig:Head", "spine.006", "head", "head"),
    "LeftShoulder": ("mixamorig:LeftShoulder", "shoulder.L", "clavicle_l", "leftShoulder"),
    "LeftArm": ("mixamorig:LeftArm", "upper_arm.L", "upperarm_l", "leftUpperArm"),
    "LeftForeArm": ("mixamorig:LeftForeArm", "forearm.L", "lowerarm_l", "leftLowerArm"),
    "LeftHand": ("mixamorig:LeftHand", "hand.L", "hand_l", "leftHand"),
    "RightShoulder": ("mixamorig:RightShoulder", "shoulder.R", "clavicle_r", "rightShoulder"),
    "RightArm": ("mixamorig:RightArm", "upper_arm.R", "upperarm_r", "rightUpperArm"),
    "RightForeArm": ("mixamorig:RightForeArm", "forearm.R", "lowerarm_r", "rightLowerArm"),
    "RightHand": ("mixamorig:RightHand", "hand.R", "hand_r", "rightHand"),
    "LeftUpLeg": ("mixamorig:LeftUpLeg", "thigh.L", "thigh_l", "leftUpperLeg"),
    "LeftLeg": ("mixamorig:LeftLeg", "shin.L", "calf_l", "leftLowerLeg"),
    "LeftFoot": ("mixamorig:LeftFoot", "foot.L", "foot_l", "leftFoot"),
    "RightUpLeg": ("mixamorig:RightUpLeg", "thigh.R", "thigh_r", "rightUpperLeg"),
    "RightLeg": ("mixamorig:RightLeg", "shin.R", "calf_r", "rightLowerLeg"),
    "RightFoot": ("mixamorig:RightFoot", "foot.R", "foot_r", "rightFoot"),
}
RIGS = ("mixamo", "rigify", "unreal", "vrm")


def rest_of(armature: bpy.types.Object, bone: str) -> Matrix:
    """The bone's rest in the world, without its place."""
    return (armature.matrix_world @ armature.data.bones[bone].matrix_local).to_3x3().normalized()


def aligned(ours: Matrix, theirs: Matrix) -> Quaternion:
    """The shortest turn in the world from their bone's direction at rest to ours."""
    return (theirs @ Vector((0, 1, 0))).rotation_difference(ours @ Vector((0, 1, 0)))


def leg_m(armature: bpy.types.Object, thigh: str, foot: str) -> float:
    """Length of a leg at rest."""
    bones, scale = armature.data.bones, armature.matrix_world.to_scale()[0]
    return scale * (bones[thigh].head_local - bones[foot].head_local).length


def retarget(source: bpy.types.Object, target: bpy.types.Object, rig: str) -> list[str]:
    """Key the target's bones on every frame of the source's action; returns their names."""
    column = RIGS.index(rig)
    pairs = {ours: theirs[column] for ours, theirs in NAMES.items()}
    pairs = {a: b for a, b in pairs.items() if a in source.pose.bones and b in target.pose.bones}
    legs = ("LeftUpLeg", "LeftFoot" if "LeftFoot" in pairs else "LeftLeg")
    ratio = leg_m(target, *(pairs[each] for each in legs)) / leg_m(source, *legs)
    turns = {ours: aligned(rest_of(source, ours), rest_of(target, b)) for ours, b in pairs.items()}
    hips_m = source.matrix_world @ source.data.bones["Hips"].head_local
    own_m = target.matrix_world @ target.data.bones[pairs["Hips"]].head_local
    first, last = (round(end) for end in source.animation_data.action.frame_range)
    for bone in target.pose.bones:
        bone.rotation_mode = "QUATERNION"
    for frame in range(first, last + 1):
        bpy.context.scene.frame_set(frame)
        for ours, theirs in pairs.items():  # parents come before their children in NAMES
            posed, bone = source.pose.bones[ours], target.pose.bones[theirs]
            now = (source.matrix_world @ posed.matrix).to_3x3().normalized()
            turned = now @ rest_of(source, ours).inverted()
            world = turned.to_quaternion() @ turns[ours] @ rest_of(target, theirs).to_quaternion()
            place = target.matrix_world @ bone.matrix.translation
            if ours == "Hips":
                moved = source.matrix_world @ posed.head - hips_m
                place = own_m + ratio * moved
            whole = Matrix.LocRotScale(place, world, target.matrix_world.to_scale())
            bone.matrix = target.matrix_world.inverted() @ whole
            bpy.context.view_layer.update()
            bone.keyframe_insert("rotation_quaternion", frame=frame)
            if ours == "Hips":
                bone.keyframe_insert("location", frame=frame)
    return [*pairs.values()]


def main(bvh: str, out: str, rig: str = "mixamo") -> None:
    """Import the run, retarget it to the scene's armature, and save."""
    target = next(each for each in bpy.context.scene.objects if each.type == "ARMATURE")
    bpy.ops.import_anim.bvh(filepath=bvh, update_scene_fps=True, update_scene_duration=True)
    moved = retarget(bpy.context.object, target, rig)
    print(f"{len(moved)} bones: {', '.join(moved)}")
    bpy.ops.wm.save_as_mainfile(filepath=out)


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1 :])
