"""FBX: an animated skinned stick figure, for Unity, Unreal and Mixamo, written by Blender.

No kept library writes FBX but Blender's exporter; it reads our glTF file in a process of its own.
"""

import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from animator.exchange import LibraryMissing
from animator.exchange.gltf import gltf_bytes
from animator.skeleton.bones import Motion, Skeleton

WITHIN_S: Final = 600.0
"""Seconds that Blender may take."""
CONVERT: Final = """
import sys
import bpy

read, write, fps, frames = sys.argv[-4:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps, scene.render.fps_base = round(float(fps)), round(float(fps)) / float(fps)
bpy.ops.import_scene.gltf(filepath=read)
for shape in [each for each in scene.objects if each.type == "MESH" and not each.modifiers]:
    bpy.data.objects.remove(shape)  # the importer's picture of a bone
scene.frame_start, scene.frame_end = 0, int(frames) - 1
bpy.ops.export_scene.fbx(
    filepath=write,
    object_types={"ARMATURE", "MESH"},
    add_leaf_bones=False,
    bake_anim_use_nla_strips=False,
    bake_anim_use_all_actions=False,
    bake_anim_simplify_factor=0.0,
)
"""
"""Blender's program; its arguments are the glTF file, the FBX file, the frame rate, and the number
of frames."""


def fbx_bytes(skeleton: Skeleton, motion: Motion, step_s: float) -> bytes:
    """An FBX file, binary, with one take.

    Args:
        skeleton: The body.
        motion: (n,) its motion.
        step_s: Seconds per frame.

    Raises:
        LibraryMissing: Without Blender.
        OSError: When Blender writes no file, or none within WITHIN_S.
    """
    command = blender()
    with tempfile.TemporaryDirectory() as folder:
        read, written = Path(folder) / "body.glb", Path(folder) / "body.fbx"
        read.write_bytes(gltf_bytes(skeleton, motion, step_s))
        (program := Path(folder) / "convert.py").write_text(CONVERT)
        count = str(len(motion.root_m))
        asked = [*command, str(program), "--", str(read), str(written), repr(1.0 / step_s), count]
        try:
            done = subprocess.run(
                asked, cwd=folder, capture_output=True, check=False, timeout=WITHIN_S
            )
        except subprocess.TimeoutExpired as error:
            text = f"Blender wrote no file within {WITHIN_S:.0f} s: export to gltf instead"
            raise OSError(text) from error
        if not written.is_file():
            last = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
            raise OSError(f"Blender wrote no file: {last or done.returncode}")
        return written.read_bytes()


def blender() -> list[str]:
    """The command that runs a program in Blender: this Python with bpy, or the program itself.

    Raises:
        LibraryMissing: Without either.
    """
    if find_spec("bpy") is not None:
        return [sys.executable]
    if (path := shutil.which("blender")) is not None:
        return [path, "--background", "--factory-startup", "--python"]
    raise LibraryMissing(
        "FBX is written by Blender: put blender on the PATH, or pip install 'tritrack[fbx]'"
    )
