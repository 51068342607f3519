"""FBX: Blender reads back what Blender wrote, and who lacks it reads the cure."""

import sys
from pathlib import Path

import numpy as np
import pytest
from clients import answer_of
from moving import random_joints

from animator.bvh import steady
from animator.exchange import LibraryMissing, fbx
from animator.exchange.fbx import blender, fbx_bytes
from animator.skeleton.bones import joints_of
from common.body.body import JOINT_NAMES

READ = """
import bpy, json, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 15
bpy.ops.import_scene.fbx(filepath=sys.argv[1])
kinds = sorted(each.type for each in bpy.context.scene.objects)
body = next(each for each in bpy.context.scene.objects if each.type == "ARMATURE")
first, last = (round(end) for end in bpy.data.actions[0].frame_range)
said = []
for frame in (0, 20, 39):
    bpy.context.scene.frame_set(first + frame)
    said.append({b.name: list(body.matrix_world @ b.head) for b in body.pose.bones})
print(json.dumps([kinds, last - first + 1, said]))
"""


@pytest.mark.slow
def test_blender_finds_every_joint_where_it_is_and_one_figure(tmp_path: Path) -> None:
    """Blender's axes are +z up: (x, y, z) of the run is (x, -z, y) there."""
    pytest.importorskip("bpy", reason="pip install 'tritrack[fbx]'")
    skeleton, motion, steps = steady(random_joints(3), np.arange(40) / 15)
    (tmp_path / "body.fbx").write_bytes(fbx_bytes(skeleton, motion, steps.step_s))
    kinds, frames, said = answer_of("bpy", READ, str(tmp_path / "body.fbx"))
    assert (kinds, frames) == (["ARMATURE", "MESH"], 40)
    for frame, heads in zip((0, 20, 39), said, strict=True):
        expected = joints_of(skeleton, motion)[frame]
        for bone in skeleton.bones:
            x, y, z = expected[JOINT_NAMES.index(bone.starts)]
            assert heads[bone.name] == pytest.approx([x, -z, y], abs=1e-4)


def test_blender_is_bpy_of_this_python_or_the_program_or_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    there = {"bpy": True}
    monkeypatch.setattr(fbx, "find_spec", lambda name: there.get(name) or None)
    monkeypatch.setattr("shutil.which", lambda name: f"/opt/{name}")
    assert blender() == [sys.executable]
    there.clear()
    assert blender()[:2] == ["/opt/blender", "--background"]
    monkeypatch.setattr("shutil.which", lambda _: None)
    with pytest.raises(LibraryMissing, match=r"blender on the PATH, or pip install 'tritrack\[fbx"):
        blender()


def test_what_blender_says_last_is_the_reason_that_there_is_no_file(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fails = [sys.executable, "-c", "raise SystemExit('reading\\nno such addon')"]
    monkeypatch.setattr(fbx, "blender", lambda: fails)
    skeleton, motion, steps = steady(random_joints(3), np.arange(40) / 15)
    with pytest.raises(OSError, match="Blender wrote no file: no such addon"):
        fbx_bytes(skeleton, motion, steps.step_s)


def test_a_blender_that_does_not_end_is_given_up_with_a_cure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waits = [sys.executable, "-c", "import time; time.sleep(60)"]
    monkeypatch.setattr(fbx, "blender", lambda: waits)
    monkeypatch.setattr(fbx, "WITHIN_S", 0.2)
    skeleton, motion, steps = steady(random_joints(3), np.arange(40) / 15)
    with pytest.raises(OSError, match="export to gltf instead"):
        fbx_bytes(skeleton, motion, steps.step_s)
