"""Runs with gaps in every format, opened by programs that are not ours."""

import json
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from clients import answer_of
from moving import random_joints

from animator.exchange.marker_files import forward_x
from animator.skeleton.bones import BONES, OF_JOINTS
from common.body.body import JOINT_NAMES
from common.bus.messages import Body
from runtime.store.pose_arrays import poses
from runtime.store.run_exports import Format
from tritrack.exporting import export_run

GAPS: Final = {
    "start": [0, 1, 2],
    "middle": [10, 11, 20],
    "end": [37, 38, 39],
    "everywhere": [0, 10, 11, 20, 39],
}
"""Rows of 40 without a pose."""
STARTS: Final = {bone.name: bone.starts for bone in BONES[: OF_JOINTS[len(JOINT_NAMES)]]}
"""Which landmark each bone starts at."""

MARKERS = """
import json, sys, opensim
opensim.Logger.setLevelString("off")
said = []
for path in sys.argv[1:]:
    table = opensim.TimeSeriesTableVec3(path)
    rows = [table.getRowAtIndex(i) for i in range(table.getNumRows())]
    columns = range(table.getNumColumns())
    said.append([[row[c].to_numpy().tolist() for c in columns] for row in rows])
print(json.dumps(said))
"""
PLAYED = """
import json, sys, opensim
opensim.Logger.setLevelString("off")
said = []
for path in sys.argv[1:]:
    model = opensim.Model(path.replace(".mot", ".osim"))
    state = model.initSystem()
    table, places = opensim.TimeSeriesTable(path), []
    for row in range(table.getNumRows()):
        values = table.getRowAtIndex(row)
        for i, name in enumerate(table.getColumnLabels()):
            coordinate = model.getCoordinateSet().get(name)
            turns = coordinate.getMotionType() == opensim.Coordinate.Rotational
            scale = 0.017453292519943295 if turns else 1.0
            coordinate.setValue(state, values[i] * scale, False)
        model.realizePosition(state)
        markers = [model.getMarkerSet().get(i) for i in range(model.getMarkerSet().getSize())]
        places.append([m.getLocationInGround(state).to_numpy().tolist() for m in markers])
    said.append(places)
print(json.dumps(said))
"""
SOLVED = """
import json, sys, opensim
opensim.Logger.setLevelString("off")
tool = opensim.InverseKinematicsTool()
model = opensim.Model(sys.argv[1])
tool.setModel(model)
tool.setMarkerDataFileName(sys.argv[2])
tool.setStartTime(float(sys.argv[4]))
tool.setEndTime(float(sys.argv[5]))
tool.setResultsDir(sys.argv[3])
tool.setOutputMotionFileName(sys.argv[3] + "/solved.mot")
tool.run()
print(json.dumps(opensim.TimeSeriesTable(sys.argv[3] + "/solved.mot").getNumRows()))
"""
BLENDER = """
import bpy, json, sys
said = []
for path in sys.argv[1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 15
    first = 0
    if path.endswith(".bvh"):
        bpy.ops.import_anim.bvh(filepath=path, update_scene_fps=True)
        first = 1
    elif path.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        bpy.ops.wm.usd_import(filepath=path)
    body = next(each for each in bpy.data.objects if each.type == "ARMATURE")
    _, end = body.animation_data.action.frame_range
    frames = []
    for frame in range(first, round(end) + 1):
        bpy.context.scene.frame_set(frame)
        frames.append({b.name: list(body.matrix_world @ b.head) for b in body.pose.bones})
    said.append(frames)
print(json.dumps(said))
"""


def with_gap(where: str) -> np.ndarray:
    joints_m = random_joints(3)
    joints_m[GAPS[where]] = np.nan
    return joints_m


def write(folder: Path, joints_m: np.ndarray, time_s: np.ndarray) -> None:
    """A run folder of these rows."""
    bodies = [
        Body(
            frame=frame,
            captured_s=float(time_s[frame]),
            clock_s=0.0,
            status="tracking" if np.isfinite(row).all() else "lost",
            views="both",
            joints_m=tuple(map(tuple, row)) if np.isfinite(row).all() else (),
        )
        for frame, row in enumerate(joints_m)
    ]
    folder.mkdir(exist_ok=True)
    arrays: dict[str, Any] = dict(poses(bodies))
    np.savez(folder / "poses.npz", **arrays)
    (folder / "summary.json").write_text("{}")


def written(folder: Path, where: str, to: Format) -> Path:
    """The file of a run with such a gap."""
    write(folder / where, with_gap(where), np.arange(40) / 15)
    return Path(export_run(folder / where, to, None)["file"])


def in_file(where: str) -> np.ndarray:
    """(frames, 15, 3) as a file shall have them: from the first pose to the last."""
    joints_m = with_gap(where)
    posed = np.flatnonzero(np.isfinite(joints_m).all(axis=(1, 2)))
    return joints_m[posed[0] : posed[-1] + 1]


def off_m(read: Any, expected: np.ndarray) -> float:
    """How far places are off where the run has a pose; all must be known."""
    assert np.shape(read) == expected.shape
    assert np.isfinite(read).all()
    return float(np.nanmax(np.abs(read - expected)))


@pytest.mark.parametrize("where", GAPS)
def test_numpy_reads_a_table_with_every_frame_of_the_run(tmp_path: Path, where: str) -> None:
    path = written(tmp_path, where, "csv")
    table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert table["frame"].tolist() == list(range(40))
    knee = JOINT_NAMES.index("l_knee")
    expected = with_gap(where)[:, knee, 1]
    assert table["l_knee_y_m"] == pytest.approx(expected, abs=1e-4, nan_ok=True)


@pytest.mark.parametrize("where", GAPS)
def test_numpy_reads_markers_row_by_row_though_some_are_lost(tmp_path: Path, where: str) -> None:
    """It refuses rows of different lengths, as OpenSim does."""
    path = written(tmp_path, where, "trc")
    read = np.genfromtxt(path, delimiter="\t", skip_header=6)[:, 2:].reshape(-1, 15, 3)
    assert all(line.split("\t")[-1] for line in path.read_text().splitlines()[6:])
    assert read == pytest.approx(1e3 * forward_x(in_file(where)), abs=1e-3, nan_ok=True)


def test_of_a_phones_varying_rate_no_row_is_empty_and_every_one_has_its_time(
    tmp_path: Path,
) -> None:
    """30, then 24 frames a second; the body goes 1 m/s along x, which is -z of OpenSim."""
    time_s = np.concatenate([np.arange(60) / 30, 2.0 + np.arange(72) / 24])
    joints_m = np.repeat(random_joints(3, 2)[:1], len(time_s), axis=0)
    joints_m[..., 0] += time_s[:, None]
    write(tmp_path / "run", joints_m, time_s)
    facts = export_run(tmp_path / "run", "trc", None)
    assert (facts["frames"], facts["empty"]) == (149, 0)
    read = np.genfromtxt(facts["file"], delimiter="\t", skip_header=6)
    assert np.diff(read[:, 1]) == pytest.approx(1 / 30, abs=2e-6)
    assert (read[0, 4] - read[:, 4]) / 1e3 == pytest.approx(read[:, 1], abs=2e-6)
    assert export_run(tmp_path / "run", "bvh", None)["off_mm"]["p95"] < 0.01


@pytest.mark.parametrize("where", GAPS)
def test_ezc3d_reads_markers(tmp_path: Path, where: str) -> None:
    ezc3d = pytest.importorskip("ezc3d", reason="pip install 'tritrack[export]'")
    read = ezc3d.c3d(str(written(tmp_path, where, "c3d")))["data"]["points"][:3]
    expected = 1e3 * forward_x(in_file(where))
    assert read.transpose(2, 1, 0) == pytest.approx(expected, abs=0.1, nan_ok=True)


@pytest.mark.parametrize("where", GAPS)
def test_another_reader_of_c3d_knows_lost_markers_by_their_residual(
    tmp_path: Path, where: str
) -> None:
    c3d = pytest.importorskip("c3d", reason="pip install 'tritrack[clients]'")
    pytest.importorskip("ezc3d", reason="pip install 'tritrack[export]'")
    with written(tmp_path, where, "c3d").open("rb") as file:
        frames = np.array([points for _, points, _ in c3d.Reader(file).read_frames()])
    read = np.where(frames[..., 3:4] < 0.0, np.nan, frames[..., :3])
    expected = 1e3 * forward_x(in_file(where))
    assert read == pytest.approx(expected, abs=0.1, nan_ok=True)


@pytest.mark.parametrize("where", GAPS)
def test_the_library_of_usd_fills_what_is_missing(tmp_path: Path, where: str) -> None:
    pytest.importorskip("pxr", reason="pip install 'tritrack[usd]'")
    from pxr import Usd, UsdSkel

    stage = Usd.Stage.Open(str(written(tmp_path, where, "usd")))
    query = UsdSkel.Cache().GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Body/Skeleton")))
    frames = range(int(stage.GetEndTimeCode()) + 1)
    read = [np.array(query.ComputeJointSkelTransforms(frame))[:, 3, :3] for frame in frames]
    at = [JOINT_NAMES.index(start) for start in STARTS.values()]
    assert off_m(read, in_file(where)[:, at]) < 1e-3


@pytest.mark.parametrize("where", GAPS)
def test_a_reader_of_gltf_finds_a_key_for_every_frame(tmp_path: Path, where: str) -> None:
    pygltflib = pytest.importorskip("pygltflib", reason="pip install pygltflib")
    file = pygltflib.GLTF2().load(str(written(tmp_path, where, "gltf")))
    frames = in_file(where)
    for sampler in file.animations[0].samplers:
        for number in (sampler.input, sampler.output):
            view = file.bufferViews[file.accessors[number].bufferView]
            values = np.frombuffer(file.binary_blob(), "<f4", view.byteLength // 4, view.byteOffset)
            assert np.isfinite(values).all()
            assert len(values) % len(frames) == 0
            assert file.accessors[number].count == len(frames)


@pytest.mark.slow
def test_opensim_reads_markers_though_some_are_lost(tmp_path: Path) -> None:
    paths = [str(written(tmp_path, where, "trc")) for where in GAPS]
    for where, read in zip(GAPS, answer_of("opensim", MARKERS, *paths), strict=True):
        expected = 1e3 * forward_x(in_file(where))
        assert np.array(read) == pytest.approx(expected, abs=1e-3, nan_ok=True)


@pytest.mark.slow
def test_opensim_plays_the_motion_through_what_is_missing(tmp_path: Path) -> None:
    paths = [str(written(tmp_path, where, "mot")) for where in GAPS]
    for where, read in zip(GAPS, answer_of("opensim", PLAYED, *paths), strict=True):
        assert off_m(read, forward_x(in_file(where))) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(("first", "last"), [(0, 9), (12, 19), (21, 39)])
def test_opensims_inverse_kinematics_runs_between_gaps(
    tmp_path: Path, first: int, last: int
) -> None:
    """It ends at a frame without any marker; docs/exports.md says so."""
    written(tmp_path, "middle", "mot")
    markers = written(tmp_path, "middle", "trc")
    model, times = str(markers.with_name("body.osim")), (str(first / 15), str(last / 15))
    frames = answer_of("opensim", SOLVED, model, str(markers), str(tmp_path), *times)
    assert frames == last - first + 1


@pytest.mark.slow
@pytest.mark.parametrize("to", ["bvh", "gltf", "usd"])
def test_blender_plays_every_frame_of_a_skeleton(tmp_path: Path, to: Format) -> None:
    """Its axes are +z up: (x, y, z) of the file is (x, -z, y) there."""
    if to == "usd":
        pytest.importorskip("pxr", reason="pip install 'tritrack[usd]'")
    paths = [str(written(tmp_path, where, to)) for where in GAPS]
    at = [JOINT_NAMES.index(start) for start in STARTS.values()]
    for where, frames in zip(GAPS, answer_of("bpy", BLENDER, *paths), strict=True):
        read = [[heads[name] for name in STARTS] for heads in frames]
        expected = in_file(where)[:, at] @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
        assert off_m(read, expected) < 1e-3, json.dumps([to, where])
