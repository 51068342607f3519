"""Recordings: what was said comes back, any MCAP library reads it, Foxglove finds its schemas."""

import json
import resource
import shutil
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from staging import report

from common.body.body import ANGLES_IN_POSE, JOINT_NAMES, rest_pose
from common.body.extremities import EXTREMITY_NAMES, extremities
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import Body, Posture, View
from common.config.settings import Settings
from runtime.store.foxglove_scene import SCENE, time_of
from runtime.store.recording import Head, RecordingError, read_recording, recording_to
from runtime.store.runs import RunError

mcap_reader = pytest.importorskip("mcap.reader", reason="pip install 'tritrack[mcap]'")

HEAD = Head(name="walk", settings=Settings(), period_s=1 / 15, alone=False, rig=None, body=None)


def standing(frame: int) -> Body:
    pose = rest_pose()
    joints_m = joints(body_vector(thesis_bdp(1.7)), pose)
    return Body(
        frame=frame,
        captured_s=frame / 15,
        clock_s=frame / 15,
        status="tracking",
        views="both",
        joints_m=tuple(map(tuple, joints_m.tolist())),
        extremities_m=tuple(map(tuple, extremities(joints_m, 1.7).tolist())),
        extremities_confidence=(0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 0.0),
        pose=tuple(pose.tolist()),
        angles_raw_deg=tuple(pose[list(ANGLES_IN_POSE)].tolist()),
        confidence=(0.5,) * 15,
    )


def said() -> list[View | Body | Posture]:
    empty = Body(frame=1, captured_s=1 / 15, clock_s=1 / 15, status="empty", views="none")
    named = Posture(frame=0, captured_s=0.0, clock_s=0.0, name="squat")
    return [report(1), report(2), standing(0), named, empty]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    with recording_to(tmp_path, HEAD) as keep:
        for message in said():
            keep(message)
    return tmp_path


def test_what_was_said_comes_back(folder: Path) -> None:
    one, two, body, named, empty = said()
    recording = read_recording(folder)
    assert recording.reports == ([one], [two], *[[]] * 6)
    assert recording.bodies == [body, empty]
    assert recording.postures == [named]
    assert recording.head.settings == Settings()
    assert recording.head.versions["numpy"]


def test_an_mcap_library_finds_a_scene_that_fits_its_schema(folder: Path) -> None:
    with (folder / "recording.mcap").open("rb") as file:
        found = list(mcap_reader.make_reader(file).iter_messages(["/scene", "/numbers"]))
    scenes = [(s, json.loads(m.data)) for s, c, m in found if c.topic == "/scene"]
    assert [schema.name for schema, _ in scenes] == [SCENE, SCENE]
    assert [schema.encoding for schema, _ in scenes] == ["jsonschema"] * 2
    for schema, scene in scenes:
        jsonschema.validate(scene, json.loads(schema.data))
    (entity,) = scenes[0][1]["entities"]
    assert len(entity["spheres"]) == len(JOINT_NAMES)
    head = entity["spheres"][JOINT_NAMES.index("head_top")]["pose"]["position"]
    assert head["z"] == pytest.approx(standing(0).joints_m[JOINT_NAMES.index("head_top")][1])
    points = [list(each.values()) for each in entity["lines"][0]["points"]]
    toe_m = list(standing(0).extremities_m[EXTREMITY_NAMES.index("l_toe")])
    assert points.count([toe_m[2], toe_m[0], toe_m[1]]) == 2  # the sole's and the instep's end
    assert [each["id"] for each in scenes[1][1]["deletions"]] == ["body"]
    numbers: list[dict[str, Any]] = [json.loads(m.data) for _, c, m in found if c.topic != "/scene"]
    assert numbers[0]["joints_m"]["l_wrist"]["y"] == standing(0).joints_m[5][1]
    assert numbers[0]["joints_m"]["l_toe"] == dict(zip("xyz", toe_m, strict=True))
    assert numbers[0]["confidence"]["l_toe"] == 0.8
    assert numbers[1]["joints_m"] == {}


def test_a_moment_before_a_full_second_is_a_time_that_foxglove_reads() -> None:
    """The 24,000th picture at 24000/1001 a second: its nanoseconds must be below 1e9."""
    assert time_of(24000 / (24000 / 1001)) == {"sec": 1001, "nsec": 0}
    assert time_of(-0.02) == {"sec": -1, "nsec": 980_000_000}


def test_a_recording_that_is_absent_or_damaged_is_named(folder: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare"
    bare.mkdir()
    with pytest.raises(RecordingError, match=r"there is no run folder .*none: .*--record"):
        read_recording(tmp_path / "none")
    with pytest.raises(RecordingError, match=r"has no recording\.mcap.*--record"):
        read_recording(bare)
    path = folder / "recording.mcap"
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(RecordingError, match="was damaged"):
        read_recording(folder)


def test_what_is_no_recording_at_all_is_named_with_its_cause(folder: Path) -> None:
    for junk in (b"junk\n", b"", b"\x89MCAP0\r\n" + bytes(40)):
        (folder / "recording.mcap").write_bytes(junk)
        with pytest.raises(RecordingError, match=r"was damaged or is of another version \(\w"):
            read_recording(folder)


def test_of_a_run_that_was_killed_all_is_there_but_its_last_moments(tmp_path: Path) -> None:
    """What lay on the disk while it ran is read as far as it goes, wherever it was torn."""
    with recording_to(tmp_path, HEAD) as keep:
        for _ in range(400):
            for message in said():
                keep(message)
        (torn,) = tmp_path.glob(".recording.*.mcap")
        so_far = torn.read_bytes()
    (tmp_path / "recording.mcap").unlink()
    counts = []
    for share in (1.0, 0.7, 0.4):
        torn.write_bytes(so_far[: int(share * len(so_far))])
        recording = read_recording(tmp_path)
        assert recording.bodies[:2] == [said()[2], said()[4]]
        counts.append(len(recording.bodies))
    assert counts == sorted(counts, reverse=True)
    assert 400 < counts[0] < 800


def test_a_recording_whose_compressed_part_is_damaged_is_named(folder: Path) -> None:
    path = folder / "recording.mcap"
    whole = path.read_bytes()
    at = whole.index(b"zstd") + 60
    path.write_bytes(whole[:at] + bytes(16) + whole[at + 16 :])
    with pytest.raises(RecordingError, match="was damaged"):
        read_recording(folder)


def test_a_recording_whose_folder_is_taken_away_meanwhile_is_no_fault(tmp_path: Path) -> None:
    folder, doors = tmp_path / "run", ExitStack()
    keep = doors.enter_context(recording_to(folder, HEAD))
    keep(said()[0])
    shutil.rmtree(folder)
    with pytest.raises(RunError, match=r"recording.mcap could not be .* \(No such file"):
        doors.close()


def test_a_recording_for_whose_end_there_is_no_room_leaves_it_to_the_results(
    tmp_path: Path,
) -> None:
    folder, doors, before = tmp_path / "run", ExitStack(), resource.getrlimit(resource.RLIMIT_FSIZE)
    keep = doors.enter_context(recording_to(folder, HEAD))
    for message in said():
        keep(message)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1024, before[1]))
    try:
        with pytest.raises(RunError, match=r"recording.mcap could not be .* \(File too large\)"):
            doors.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert not list(folder.iterdir())


def test_without_the_library_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(RecordingError, match=r"pip install 'tritrack\[mcap\]'"):
        read_recording(Path())
