"""OpenSim's model and motion: coordinates in the right order, and OpenSim itself agrees."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from clients import answer_of
from moving import random_joints

from animator.bvh import steady
from animator.exchange.marker_files import forward_x, trc_text
from animator.exchange.opensim_model import mot_text, osim_text
from animator.skeleton.bones import joints_of, skeleton_of
from common.body.body import JOINT_NAMES

PLAYED = """
import json, sys, opensim
opensim.Logger.setLevelString("off")
model = opensim.Model(sys.argv[1])
state = model.initSystem()
table = opensim.TimeSeriesTable(sys.argv[2])
names, said = table.getColumnLabels(), []
turning = opensim.Coordinate.Rotational
for row in (0, 20, 39):
    values = table.getRowAtIndex(row)
    for i, name in enumerate(names):
        coordinate = model.getCoordinateSet().get(name)
        turns = coordinate.getMotionType() == turning
        coordinate.setValue(state, values[i] * (0.017453292519943295 if turns else 1.0), False)
    model.realizePosition(state)
    markers = [model.getMarkerSet().get(i) for i in range(model.getMarkerSet().getSize())]
    said.append({m.getName(): m.getLocationInGround(state).to_numpy().tolist() for m in markers})
print(json.dumps(said))
"""
SOLVED = """
import json, sys, opensim
opensim.Logger.setLevelString("off")
tool = opensim.InverseKinematicsTool()
model = opensim.Model(sys.argv[1])
tool.setModel(model)
tool.setMarkerDataFileName(sys.argv[2])
tool.setStartTime(0.0)
tool.setEndTime(39 / 15)
tool.setResultsDir(sys.argv[3])
tool.setOutputMotionFileName(sys.argv[3] + "/solved.mot")
tool.run()
errors = opensim.TimeSeriesTable(sys.argv[3] + "/_ik_marker_errors.sto")
print(json.dumps(max(errors.getDependentColumn("marker_error_max").to_numpy().tolist())))
"""


def written(folder: Path) -> np.ndarray:
    """The files of a moving body; the joints that they hold, in OpenSim's axes."""
    joints_m = random_joints(4)
    skeleton, motion, steps = steady(joints_m, np.arange(40) / 15)
    (folder / "body.osim").write_text(osim_text(skeleton))
    (folder / "body.mot").write_text(mot_text(motion, steps.step_s, "body.mot"))
    (folder / "body.trc").write_text(trc_text(joints_m, steps.step_s, "body.trc"))
    return forward_x(joints_of(skeleton, motion))


def test_every_coordinate_of_the_motion_is_one_of_the_model(tmp_path: Path) -> None:
    written(tmp_path)
    model = ElementTree.parse(tmp_path / "body.osim")
    known = [each.get("name") for each in model.iter("Coordinate")]
    lines = (tmp_path / "body.mot").read_text().splitlines()
    head = lines.index("endheader")
    columns = lines[head + 1].split("\t")
    assert columns[0] == "time"
    assert sorted(columns[1:]) == sorted(str(name) for name in known)
    assert "inDegrees=yes" in lines[:head]
    assert f"nRows={len(lines) - head - 2}" in lines[:head]
    assert [each.get("name") for each in model.iter("Marker")] == list(JOINT_NAMES)


@pytest.mark.slow
def test_opensim_plays_the_motion_through_the_joints(tmp_path: Path) -> None:
    expected = written(tmp_path)
    said = answer_of("opensim", PLAYED, str(tmp_path / "body.osim"), str(tmp_path / "body.mot"))
    for row, markers in zip((0, 20, 39), said, strict=True):
        for n, joint in enumerate(JOINT_NAMES):
            assert markers[joint] == pytest.approx(expected[row, n].tolist(), abs=1e-3)


@pytest.mark.slow
def test_opensims_inverse_kinematics_runs_on_the_markers(tmp_path: Path) -> None:
    written(tmp_path)
    paths = [str(tmp_path / name) for name in ("body.osim", "body.trc")]
    assert answer_of("opensim", SOLVED, *paths, str(tmp_path)) < 1e-3


def test_rows_of_the_motion_are_as_far_apart_as_the_frames(tmp_path: Path) -> None:
    written(tmp_path)
    lines = (tmp_path / "body.mot").read_text().splitlines()
    rows = [line.split("\t") for line in lines[lines.index("endheader") + 2 :]]
    assert [float(row[0]) for row in rows] == pytest.approx(np.arange(40) / 15, abs=1e-6)


def test_the_hips_shift_and_turn_and_every_other_bone_turns_alone() -> None:
    """Each axis of a joint moves by the coordinate of its own name, or not at all."""
    model = ElementTree.fromstring(osim_text(skeleton_of(random_joints(4)))[38:])
    for joint in model.iter("CustomJoint"):
        kinds = {
            str(each.get("name")): each.findtext("motion_type") for each in joint.iter("Coordinate")
        }
        bone = joint.get("name")
        turns = {f"{bone}_r{axis}": "rotational" for axis in "xyz"}
        shifts = {f"{bone}_t{axis}": "translational" for axis in "xyz"}
        assert kinds == (turns | shifts if bone == "Hips" else turns)
        moved: dict[str, str] = {}
        for axis in joint.iter("TransformAxis"):
            said = axis.findtext("coordinates") or ""
            moves = axis.find("LinearFunction") is not None
            assert moves == (axis.find("Constant") is None) == (said in kinds)
            moved |= {said: str(axis.get("name"))} if said else {}
            along = np.array([float(each) for each in str(axis.findtext("axis")).split()])
            assert along.sum() == np.linalg.norm(along) == 1.0
            if said:
                assert "xyz"[int(along.argmax())] == said[-1]
        assert moved.keys() == kinds.keys()
        assert all(place.startswith(str(kinds[name])[:4]) or kinds[name] == "translational"
                   for name, place in moved.items())  # fmt: skip


def test_markers_stand_where_bones_start_and_end() -> None:
    skeleton = skeleton_of(random_joints(4))
    model = ElementTree.fromstring(osim_text(skeleton)[38:])
    at = {
        str(each.get("name")): (
            str(each.findtext("socket_parent_frame")).removeprefix("/bodyset/"),
            [float(value) for value in str(each.findtext("location")).split()],
        )
        for each in model.iter("Marker")
    }
    bones = {bone.name: i for i, bone in enumerate(skeleton.bones)}
    for joint, (body, place_m) in at.items():
        bone = skeleton.bones[bones[body]]
        assert joint in (bone.starts, bone.ends)
        tip_m = skeleton.tips_m[bones[body]] if joint == bone.ends else np.zeros(3)
        assert place_m == pytest.approx(tip_m.tolist(), abs=1e-8)


def turned(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues's formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def vector(parent: ElementTree.Element, path: str) -> np.ndarray:
    return np.array([float(each) for each in str(parent.findtext(path)).split()])


def markers_of(model: ElementTree.Element, said: dict[str, float]) -> dict[str, np.ndarray]:
    """Where a model's markers are, read as OpenSim's documentation has it: a joint's frame, then
    its translations, then its turns one after the other, each about the axes turned so far."""
    at = {"/ground": (np.eye(3), np.zeros(3))}
    for joint in model.iter("CustomJoint"):
        start = next(
            each for each in joint.iter("PhysicalOffsetFrame") if each.get("name") == "from"
        )
        turn, place = at[str(start.findtext("socket_parent"))]
        place = place + turn @ vector(start, "translation")
        for about, angle in zip(np.eye(3), vector(start, "orientation"), strict=True):
            turn = turn @ turned(about, angle)
        moved = np.zeros(3)
        own = np.eye(3)
        for axis in joint.iter("TransformAxis"):
            value = said.get(str(axis.findtext("coordinates")), 0.0)
            if str(axis.get("name")).startswith("r"):
                own = own @ turned(vector(axis, "axis"), np.radians(value))
            else:
                moved += value * vector(axis, "axis")
        at[f"/bodyset/{joint.get('name')}"] = (turn @ own, place + turn @ moved)
    found = {}
    for marker in model.iter("Marker"):
        turn, place = at[str(marker.findtext("socket_parent_frame"))]
        found[str(marker.get("name"))] = place + turn @ vector(marker, "location")
    return found


def test_the_motion_moves_the_model_through_the_joints(tmp_path: Path) -> None:
    expected = written(tmp_path)
    model = ElementTree.parse(tmp_path / "body.osim").getroot()
    lines = (tmp_path / "body.mot").read_text().splitlines()
    head = lines.index("endheader") + 1
    names = lines[head].split("\t")
    assert f"nColumns={len(names)}" in lines[:head]
    for row in (0, 20, 39):
        values = [float(value) for value in lines[head + 1 + row].split("\t")]
        markers = markers_of(model, dict(zip(names, values, strict=True)))
        for n, joint in enumerate(JOINT_NAMES):
            assert markers[joint] == pytest.approx(expected[row, n], abs=1e-3)
