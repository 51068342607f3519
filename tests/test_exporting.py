"""Runs for other programs: what is written is the run, and a bad run is named with its cure."""

import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from common.atomic_file import FileRefused
from common.body.body import JOINT_NAMES, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import Body
from runtime.store import past_run
from runtime.store.past_run import PastRunError, open_run
from runtime.store.pose_arrays import poses
from runtime.store.run_exports import OWN_NAMES, Format
from tritrack.commands.export_command import line_of_gaps
from tritrack.exporting import ExportError, export_run

LIBRARIES: dict[Format, tuple[str, str, str]] = {
    "usd": ("pxr", "usd-core", "usd"),
    "c3d": ("ezc3d", "ezc3d", "export"),
}
"""Module, distribution and extra of the formats that need one."""


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run of six frames: nobody at first, then somebody who stands."""
    bodies = [Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")]
    pose = rest_pose()
    standing = joints(body_vector(thesis_bdp(1.7)), pose)
    for frame in range(1, 6):
        bodies.append(
            Body(
                frame=frame,
                captured_s=frame / 15,
                clock_s=0.0,
                status="tracking",
                views="1",
                joints_m=tuple(map(tuple, standing)),
                joints_px=(((1.0, 2.0),) * 15,) * 2,
                pose=tuple(pose),
                angles_raw_deg=(0.0,) * 17,
                confidence=(0.5,) * 15,
                seen=(True, False),
                score=(0.8, 0.7),
            )
        )
    write(tmp_path / "run", poses(bodies))
    return tmp_path / "run"


def write(folder: Path, arrays: dict[str, Any], summary: str = "{}") -> None:
    folder.mkdir(exist_ok=True)
    np.savez(folder / "poses.npz", **arrays)
    (folder / "summary.json").write_text(summary)


def test_a_table_has_a_row_a_frame_and_empty_cells_where_nobody_is(run: Path) -> None:
    facts = export_run(run, "csv", None)
    rows = list(csv.DictReader(Path(facts["file"]).read_text().splitlines()))
    wrist = joints(body_vector(thesis_bdp(1.7)), rest_pose())[JOINT_NAMES.index("l_wrist")]
    assert [row["frame"] for row in rows] == ["0", "1", "2", "3", "4", "5"]
    assert rows[0]["l_wrist_y_m"] == ""
    assert float(rows[3]["l_wrist_y_m"]) == pytest.approx(wrist[1], abs=1e-4)
    assert (rows[3]["status"], rows[3]["person"]) == ("tracking", "0")
    assert (rows[3]["seen_cam1"], rows[3]["seen_cam2"]) == ("1", "0")
    assert (rows[3]["score_cam1"], rows[3]["score_cam2"]) == ("0.8000", "0.7000")
    assert len(rows[0]) == 8 + 45 + 17 + 15


def test_an_animation_is_written_where_it_is_asked_for(run: Path, tmp_path: Path) -> None:
    facts = export_run(run, "bvh", tmp_path / "new" / "dance.bvh")
    assert facts["frames"] == 5
    assert facts["first_frame"] == 1
    assert facts["off_mm"]["p95"] < 1.0
    assert (tmp_path / "new" / "dance.bvh").read_text().startswith("HIERARCHY\nROOT Hips\n")
    assert open_run(run).poses["frame"].tolist() == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize(
    ("to", "said"),
    [
        ("bvh", "; 2 without a pose lie between their neighbours"),
        (
            "trc",
            "; 2 without a pose are empty, where OpenSim's inverse kinematics stops:"
            " name times between them, or use mot",
        ),
        ("c3d", "; 2 without a pose are empty"),
        ("csv", ""),
    ],
)
def test_what_became_of_a_gap_is_said(run: Path, to: Format, said: str) -> None:
    if to in LIBRARIES:
        pytest.importorskip(LIBRARIES[to][0], reason=f"pip install {LIBRARIES[to][1]}")
    assert line_of_gaps(export_run(run, to, None), to) == ""
    arrays = dict(open_run(run).poses)
    arrays["joints_m"][[3, 4]] = np.nan
    write(run, arrays)
    assert line_of_gaps(export_run(run, to, None), to) == said


@pytest.mark.parametrize("to", ["bvh", "gltf", "usd", "trc", "mot", "c3d", "csv", "angles"])
def test_every_format_is_written_beside_the_run(run: Path, to: Format) -> None:
    if to in LIBRARIES:
        library, _, extra = LIBRARIES[to]
        pytest.importorskip(library, reason=f"pip install 'tritrack[{extra}]'")
    facts = export_run(run, to, None)
    assert Path(facts["file"]) == run / OWN_NAMES[to]
    assert facts["frames"] == (6 if to in ("csv", "angles") else 5)
    assert Path(facts["file"]).stat().st_size > 1000
    assert (run / "body.osim").is_file() == (to == "mot")


@pytest.mark.parametrize(
    ("to", "name", "endings"),
    [
        ("gltf", "dance.gltf", r"\.glb$"),
        ("usd", "dance.usdz", r"\.usdc or \.usd or \.usda$"),
        ("csv", "poses.npz", r"\.csv$"),
        ("bvh", "dance", r"\.bvh$"),
    ],
)
def test_a_name_of_another_format_is_refused_by_the_endings_that_it_may_have(
    run: Path, tmp_path: Path, to: Format, name: str, endings: str
) -> None:
    with pytest.raises(ExportError, match=rf"{name} is no name for {to}: let it end in {endings}"):
        export_run(run, to, tmp_path / name)
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize(("to", "there"), [("csv", "a.csv"), ("mot", "a.mot"), ("mot", "a.osim")])
def test_a_file_that_is_there_is_replaced_only_when_asked(
    run: Path, tmp_path: Path, to: Format, there: str
) -> None:
    out = tmp_path / f"a.{to}"
    (tmp_path / there).write_text("an afternoon's work")
    before = sorted(tmp_path.iterdir())
    with pytest.raises(FileRefused, match=rf"{there} is there already: .* or add --force"):
        export_run(run, to, out)
    assert (tmp_path / there).read_text() == "an afternoon's work"
    assert sorted(tmp_path.iterdir()) == before
    export_run(run, to, out, replace=True)
    assert (tmp_path / there).read_text() != "an afternoon's work"


@pytest.mark.parametrize("to", OWN_NAMES)
@pytest.mark.parametrize("name", ["run/poses.npz", "run/summary.json", "clip/cam2.avi"])
def test_no_force_writes_over_a_run_or_its_films(
    run: Path, tmp_path: Path, to: Format, name: str
) -> None:
    (tmp_path / "clip").mkdir()
    (tmp_path / "clip" / "cam2.avi").write_bytes(b"a film")
    before = (tmp_path / name).read_bytes()
    with pytest.raises(ExportError, match=rf"is no name for {to}"):
        export_run(run, to, tmp_path / name, replace=True)
    assert (tmp_path / name).read_bytes() == before


def test_beside_the_run_an_export_takes_the_place_of_the_one_before(run: Path) -> None:
    assert export_run(run, "bvh", None, "cm")["file"] == export_run(run, "bvh", None)["file"]


@pytest.mark.parametrize(
    ("name", "begins"), [("a.usda", b"#usda"), ("a.USD", b"PXR-USDC"), ("a.usdc", b"PXR-USDC")]
)
def test_the_ending_tells_whether_usd_is_text(
    run: Path, tmp_path: Path, name: str, begins: bytes
) -> None:
    pytest.importorskip("pxr", reason="pip install 'tritrack[usd]'")
    export_run(run, "usd", tmp_path / name)
    assert (tmp_path / name).read_bytes().startswith(begins)


def test_centimetres_are_for_bvh_alone(run: Path) -> None:
    facts = export_run(run, "bvh", None, "cm")
    first = Path(facts["file"]).read_text().split("Frame Time")[1].splitlines()[1].split()
    pelvis = open_run(run).poses["joints_m"][1, 0]
    assert [float(word) for word in first[:3]] == pytest.approx((100 * pelvis).tolist(), abs=1e-3)
    with pytest.raises(ExportError, match="--scale is for bvh: gltf has a unit of its own"):
        export_run(run, "gltf", None, "cm")


@pytest.mark.parametrize("to", LIBRARIES)
def test_a_format_without_its_library_names_the_cure(
    run: Path, to: Format, monkeypatch: pytest.MonkeyPatch
) -> None:
    module, library, extra = LIBRARIES[to]
    monkeypatch.setitem(sys.modules, module, None)
    cure = rf"{to.upper()} needs {library}: pip install 'tritrack\[{extra}\]'"
    with pytest.raises(ExportError, match=cure):
        export_run(run, to, None)


@pytest.mark.slow
def test_a_run_that_is_too_long_for_c3d_is_refused_before_its_end_is_lost(run: Path) -> None:
    """The last frame's number has 16 bits in the header; more are written, and never read."""
    pytest.importorskip("ezc3d", reason="pip install 'tritrack[export]'")
    arrays = dict(np.load(run / "poses.npz"))
    arrays["time_s"] = arrays["time_s"].copy()
    arrays["time_s"][-1] = 65_534 / 15 + arrays["time_s"][1]
    write(run, arrays)
    assert export_run(run, "c3d", None)["frames"] == 65_535
    arrays["time_s"][-1] += 1 / 15
    write(run, arrays)
    with pytest.raises(ExportError, match=r"65536 frames, and c3d has room for 65535: .* to trc"):
        export_run(run, "c3d", None)
    assert export_run(run, "trc", None)["frames"] == 65_536


def test_a_folder_that_cannot_be_written_is_named(run: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ExportError, match=r"cannot write .*file/a\.csv.*--out"):
        export_run(run, "csv", tmp_path / "file" / "a.csv")


def test_a_run_without_poses_cannot_be_animated(run: Path) -> None:
    arrays = dict(open_run(run).poses)
    arrays["joints_m"] = np.full((6, 15, 3), np.nan)
    write(run, arrays)
    with pytest.raises(ExportError, match=r"0 frames have a pose.*another run"):
        export_run(run, "bvh", None)
    assert export_run(run, "csv", None)["frames"] == 6


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda a: a.pop("joints_m"), r"joints_m is missing, not \(6, 15, 3\)"),
        (lambda a: a.update(joints_m=np.zeros((6, 20, 3))), r"\(6, 20, 3\), not \(6, 15, 3\)"),
        (lambda a: a.update(frame=np.zeros((6, 2))), "frame is"),
        (lambda a: a.update(joint_names=np.array(["nose"] * 15)), "joint_names"),
        (lambda a: a.update(time_s=np.zeros(5)), "time_s"),
        (lambda a: a.update(joints_m=np.full((6, 15, 3), "x")), "joints_m"),
        (lambda a: a.update(depth_confidence=np.ones((6, 3))), "depth_confidence"),
        (lambda a: a.update(status=np.array([{}] * 6, object)), "damaged"),
    ],
)
def test_arrays_that_are_no_runs_are_named(run: Path, change: Any, said: str) -> None:
    arrays = dict(open_run(run).poses)
    change(arrays)
    write(run, arrays)
    with pytest.raises(PastRunError, match=said):
        open_run(run)


@pytest.mark.parametrize("theirs", ["9.9.9", "1.0", "0.3.0rc1"])
def test_a_run_of_a_newer_version_is_refused_by_both_versions(
    run: Path, theirs: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(past_run, "version", lambda _: "0.2.4")
    write(run, dict(open_run(run).poses), json.dumps({"versions": {"tritrack": theirs}}))
    with pytest.raises(
        PastRunError, match=rf"run was written by tritrack {theirs}, and this is 0\.2\.4: .*upgrade"
    ):
        export_run(run, "bvh", None)
    assert not (run / "body.bvh").exists()
    (run / "poses.npz").write_bytes(b"of a form that this version does not know")
    with pytest.raises(PastRunError, match="was written by tritrack"):
        open_run(run)


def test_a_journal_that_this_version_cannot_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "journal.bin").write_bytes(b"of another version")
    with pytest.raises(PastRunError, match=r"its journal is empty or of another version of tri"):
        open_run(tmp_path)


@pytest.mark.parametrize("theirs", ["0.2.9", "0.2.0", "0.1", "unknown", None])
def test_runs_of_this_minor_version_of_older_ones_and_of_none_are_read(
    run: Path, theirs: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(past_run, "version", lambda _: "0.2.4")
    write(run, dict(open_run(run).poses), json.dumps({"versions": {"tritrack": theirs}}))
    assert export_run(run, "csv", None)["frames"] == 6


@pytest.mark.parametrize("kept", [0, 3, 200])
def test_a_damaged_run_is_named(run: Path, kept: int) -> None:
    whole = (run / "poses.npz").read_bytes()
    (run / "poses.npz").write_bytes(whole[:kept])
    with pytest.raises(PastRunError, match="damaged"):
        open_run(run)


def test_what_is_no_run_is_named(run: Path, tmp_path: Path) -> None:
    with pytest.raises(PastRunError, match=r"no run folder .*absent"):
        open_run(tmp_path / "absent")
    with pytest.raises(PastRunError, match=r"no poses\.npz"):
        open_run(tmp_path)
    (run / "summary.json").write_text(json.dumps({})[:-1])
    with pytest.raises(PastRunError, match="damaged"):
        open_run(run)
    (run / "summary.json").unlink()
    with pytest.raises(PastRunError, match=r"no summary\.json"):
        open_run(run)


def test_a_run_that_may_not_be_read_is_not_called_damaged(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def closed(*_: object) -> None:
        raise PermissionError(13, "Permission denied", str(run / "poses.npz"))

    monkeypatch.setattr(past_run, "read_arrays", closed)
    with pytest.raises(PastRunError, match=r"cannot read .*npz: Permission denied; see that"):
        open_run(run)


def test_a_run_without_its_summary_and_a_clip_are_told_apart(run: Path, tmp_path: Path) -> None:
    (run / "summary.json").unlink()
    with pytest.raises(PastRunError, match=r"has no summary\.json: track the clip again"):
        open_run(run)
    (tmp_path / "walk").mkdir()
    with pytest.raises(PastRunError, match=r"walk has no poses\.npz: name one"):
        open_run(tmp_path / "walk")
    (tmp_path / "walk" / "cam1.avi").write_bytes(b"")
    with pytest.raises(PastRunError, match=r"it is a clip; track it first: tritrack track .*walk"):
        open_run(tmp_path / "walk")


@pytest.fixture
def of_two(tmp_path: Path) -> Path:
    """Eight frames: nobody, then a person of 1.7 m, and from frame 3 on one of 1.5 m, 1 m beside,
    who is away in frame 5."""
    bodies = [Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")]
    for frame in range(1, 8):
        bodies.append(standing(frame, 1, 1.7, 0.0))
        if frame >= 3 and frame != 5:
            bodies.append(standing(frame, 2, 1.5, 1.0))
    write(tmp_path / "two", poses(bodies))
    return tmp_path / "two"


def standing(frame: int, person: int, height_m: float, x_m: float) -> Body:
    pose = rest_pose()
    places = joints(body_vector(thesis_bdp(height_m)), pose) + np.array([x_m, 0.0, 0.0])
    return Body(
        frame=frame,
        person=person,
        captured_s=frame / 15,
        clock_s=0.0,
        status="tracking",
        views="both",
        joints_m=tuple(map(tuple, places)),
        pose=tuple(pose),
        confidence=(0.5,) * 15,
    )


def rows_of(path: str | Path) -> list[dict[str, str]]:
    return list(csv.DictReader(Path(path).read_text().splitlines()))


def test_of_several_people_each_gets_a_file_with_their_own_frames(of_two: Path) -> None:
    facts = export_run(of_two, "csv", None)
    assert [Path(name).name for name in facts["files"]] == [
        "poses_person1.csv",
        "poses_person2.csv",
    ]
    first, second = (rows_of(name) for name in facts["files"])
    assert [row["frame"] for row in first] == list("1234567")
    assert [row["frame"] for row in second] == list("3467")
    assert {row["person"] for row in second} == {"2"}
    assert {row["neck_x_m"] for row in second} == {"1.0000"}
    assert (facts["frames"], [own["frames"] for own in facts["people"]]) == (11, [7, 4])
    assert not (of_two / "poses.csv").exists()


@pytest.mark.parametrize(("to", "gap"), [("trc", "empty"), ("bvh", "filled")])
def test_a_frame_without_the_person_is_a_gap_of_the_motion(
    of_two: Path, to: Format, gap: str
) -> None:
    facts = export_run(of_two, to, None, person=2)
    assert (facts["frames"], facts["first_frame"], facts[gap]) == (5, 3, 1)
    assert Path(facts["file"]).name == f"{Path(OWN_NAMES[to]).stem}_person2.{to}"
    assert "people" not in facts


def test_one_person_goes_where_the_user_says_and_several_beside_each_other(
    of_two: Path, tmp_path: Path
) -> None:
    out = tmp_path / "dance.mot"
    assert export_run(of_two, "mot", out, person=1)["files"] == [
        str(tmp_path / "dance.mot"),
        str(tmp_path / "dance.osim"),
    ]
    files = [Path(name).name for name in export_run(of_two, "mot", out)["files"]]
    assert files == [f"dance_person{n}.{end}" for n in (1, 2) for end in ("mot", "osim")]
    before = (tmp_path / "dance_person2.osim").read_bytes()
    (tmp_path / "dance_person1.mot").unlink()
    with pytest.raises(FileRefused, match=r"dance_person1\.osim is there already"):
        export_run(of_two, "mot", out)
    assert not (tmp_path / "dance_person1.mot").exists()
    assert (tmp_path / "dance_person2.osim").read_bytes() == before


@pytest.mark.parametrize("number", [0, 3])
def test_a_person_that_the_run_does_not_have_is_refused_by_those_it_has(
    of_two: Path, number: int
) -> None:
    with pytest.raises(PastRunError, match=rf"has no person {number}: its people are 1, 2$"):
        export_run(of_two, "csv", None, person=number)


def test_a_run_of_one_person_is_one_file_whether_they_are_named_or_not(run: Path) -> None:
    facts = export_run(run, "csv", None)
    whole = Path(facts["file"]).read_bytes()
    assert facts == {**export_run(run, "csv", None, person=0), "frames": 6}
    assert (run / "poses.csv").read_bytes() == whole
    with pytest.raises(PastRunError, match=r"has no person 1: its people are 0$"):
        export_run(run, "csv", None, person=1)


def test_who_has_too_few_poses_to_be_animated_is_left_out_and_said(of_two: Path) -> None:
    arrays = dict(open_run(of_two).poses)
    arrays["joints_m"][np.flatnonzero(arrays["person"] == 2)[1:]] = np.nan
    write(of_two, arrays)
    facts = export_run(of_two, "bvh", None)
    assert [Path(name).name for name in facts["files"]] == ["body_person1.bvh"]
    assert facts["left_out"] == {2: "1 frames have a pose, an animation needs two"}
    with pytest.raises(ExportError, match="cannot be animated: 1 frames have a pose"):
        export_run(of_two, "bvh", None, person=2)
