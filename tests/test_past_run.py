"""A run folder read again: what is wrong with one is named with its cure."""

import json
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.body.extremities import ALL_JOINT_NAMES
from common.bus.control_messages import Cameras
from common.bus.messages import Body, Posture
from common.config.settings import Settings
from common.rig.camera import paper_rig
from runtime.store.journal import Head, Journal
from runtime.store.past_run import CUT_SHORT, PastRunError, is_run, open_run
from runtime.store.runs import write_run

RIG = paper_rig((320, 240), (400.0, 400.0), (4.0, 4.0))


def body(frame: int, status: Any = "empty") -> Body:
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, status=status, views="none")


@pytest.fixture
def run(tmp_path: Path) -> Path:
    write_run(tmp_path, [body(4), body(5), body(7)], Settings(), {"clip": "walk"})
    return tmp_path


def refused(folder: Path) -> str:
    with pytest.raises(PastRunError) as error:
        open_run(folder)
    return str(error.value)


def spoilt(folder: Path, **changed: Any) -> str:
    """What is said of a run with other arrays; None: one that is missing."""
    path = folder / "poses.npz"
    with np.load(path) as held:
        arrays = {name: held[name] for name in held.files} | changed
    np.savez(path, **{name: value for name, value in arrays.items() if value is not None})
    return refused(folder)


def test_what_was_written_is_read_with_hands_and_feet_apart(run: Path) -> None:
    past = open_run(run)
    assert past.folder == run
    assert past.poses["frame"].tolist() == [4, 5, 7]
    assert past.poses["joints_m"].shape == (3, 15, 3)
    assert past.poses["extremities_m"].shape == (3, 7, 3)
    assert past.summary["clip"] == "walk"


def test_a_folder_is_a_run_by_its_poses_or_its_journal(tmp_path: Path, run: Path) -> None:
    assert is_run(run)
    (tmp_path / "cut").mkdir()
    assert not is_run(tmp_path / "cut")
    Journal(tmp_path / "cut", Head(settings=Settings(), facts={})).close()
    assert is_run(tmp_path / "cut")


@pytest.mark.parametrize(
    ("name", "array", "found"),
    [
        ("confidence", np.zeros((3, 22), int), "int64 (3, 15)"),
        ("time_s", np.zeros(2), "float64 (2,)"),
        ("score", None, "missing"),
        ("joints_px", np.zeros((3, 1, 22, 2)), "float64 (3, 1, 15, 2)"),
        ("frame", np.zeros((3, 1), int), "int64 (3, 1)"),
    ],
)
def test_arrays_of_another_kind_or_shape_are_named(
    run: Path, name: str, array: Any, found: str
) -> None:
    said = spoilt(run, **{name: array})
    assert f"{name} is {found}, not (" in said
    assert said.startswith(f"{run / 'poses.npz'}: ")
    assert said.endswith("): track it again")


def test_extremities_and_what_one_view_adds_are_held_to_their_shapes_too(run: Path) -> None:
    said = spoilt(run, orientation=np.zeros(3))
    assert "orientation is float64 (3,), not (3,): track it again" in said


def test_joints_of_another_order_are_refused(run: Path) -> None:
    names = np.array([*ALL_JOINT_NAMES[1:], ALL_JOINT_NAMES[0]])
    said = spoilt(run, joint_names=names)
    assert said.endswith("joints_m is float64 (3, 22, 3), not (3, 15, 3): track it again")


def test_a_run_of_fifteen_joints_with_others_names_is_refused(run: Path) -> None:
    with np.load(run / "poses.npz") as held:
        arrays = {name: held[name] for name in held.files}
    arrays["joints_m"] = arrays["joints_m"][:, :15]
    arrays["joints_px"] = arrays["joints_px"][:, :, :15]
    arrays["confidence"] = arrays["confidence"][:, :15]
    arrays["joint_names"] = np.array(JOINT_NAMES)
    np.savez(run / "poses.npz", **arrays)
    past = open_run(run)
    assert past.poses["joints_m"].shape == (3, 15, 3)
    assert "extremities_m" not in past.poses
    said = spoilt(run, joint_names=np.array([*JOINT_NAMES[1:], JOINT_NAMES[0]]))
    assert said.endswith("poses.npz: joint_names are not those of this version: track it again")


def told_by(run: Path, told: str) -> None:
    summary = json.loads((run / "summary.json").read_text())
    summary["versions"]["tritrack"] = told
    (run / "summary.json").write_text(json.dumps(summary))


def test_a_run_of_a_later_minor_version_is_refused_and_a_patch_is_not(run: Path) -> None:
    major, minor, *_ = (int(part) for part in version("tritrack").split(".")[:2])
    for well in (f"{major}.{minor}.99", f"{major}.{minor}", "none", f"{major - 1}.{minor + 50}"):
        told_by(run, well)
        assert len(open_run(run).poses["frame"]) == 3
    for late in (f"{major}.{minor + 1}.0", f"{major + 1}.0"):
        told_by(run, late)
        assert refused(run) == (
            f"{run} was written by tritrack {late}, and this is {version('tritrack')}: "
            "read it with that version (pip install --upgrade tritrack)"
        )
    (run / "summary.json").write_text("[]")
    assert open_run(run).summary == {}


def test_a_folder_that_is_no_run_is_named_with_what_it_is(tmp_path: Path) -> None:
    nowhere = tmp_path / "nowhere"
    assert refused(nowhere) == (
        f"there is no run folder {nowhere}: name one that `tritrack track` wrote"
    )
    folder = tmp_path / "some"
    folder.mkdir()
    assert refused(folder) == f"{folder} has no poses.npz: name one that `tritrack track` wrote"
    Journal(folder, Head(settings=Settings(), facts={})).close()
    assert refused(folder).startswith(f"{folder} has no poses.npz: it was cut short, and its jour")
    (folder / "cam2.mp4").write_bytes(b"")
    assert refused(folder) == (
        f"{folder} has no poses.npz: it is a clip; track it first: tritrack track {folder}"
    )


def test_what_is_missing_or_damaged_in_a_run_is_named(run: Path) -> None:
    summary = (run / "summary.json").read_text()
    (run / "summary.json").write_text("{")
    said = refused(run)
    assert said.startswith(f"{run} was damaged (")
    assert said.endswith("): track the clip again")
    (run / "summary.json").unlink()
    assert refused(run) == f"{run} has no summary.json: track the clip again"
    (run / "summary.json").mkdir()
    assert refused(run) == (
        f"cannot read {run / 'summary.json'}: Is a directory; see that you may read it"
    )
    (run / "summary.json").rmdir()
    (run / "summary.json").write_text(summary)
    (run / "poses.npz").write_bytes(b"no arrays")
    assert refused(run).startswith(f"{run} was damaged (")


def test_a_run_that_was_cut_short_tells_what_its_journal_has(tmp_path: Path) -> None:
    """The last rig and the last posture that had a name; instants of no frame have no row."""
    journal = Journal(tmp_path, Head(settings=Settings(room="attic"), facts={"clip": "walk"}))
    rig = Cameras(rig=RIG, scale_source="assumed")
    later = Cameras(rig=RIG, scale_source="person", calibration=1)
    moment: dict[str, Any] = {"frame": 0, "captured_s": 0.0, "clock_s": 0.0}
    named = [Posture(name=name, **moment) for name in ("squat", "kick_left_side", "")]
    journal.keep([rig, body(3, "tracking"), body(-1), later, *named, body(4)])
    journal.close()
    past = open_run(tmp_path)
    assert past.poses["frame"].tolist() == [3, 4]
    assert past.poses["status"].tolist() == ["tracking", "empty"]
    told = past.summary
    assert (told["clip"], told["scale_source"], told["posture"]) == (
        *("walk", "person"),
        "kick_left_side",
    )
    assert (told["warnings"], told["frames"]) == ([CUT_SHORT], 2)
    assert told["settings"]["room"] == "attic"
    plain = tmp_path / "plain"
    plain.mkdir()
    journal = Journal(plain, Head(settings=Settings(), facts={}))
    journal.keep([body(1)])
    journal.close()
    told = open_run(plain).summary
    assert (told["scale_source"], told["posture"]) == (None, "")


def test_a_run_of_no_camera_is_refused(run: Path) -> None:
    none = {"joints_px": np.zeros((3, 0, 22, 2)), "score": np.zeros((3, 0))}
    said = spoilt(run, camera_names=np.array([], "U4"), seen=np.zeros((3, 0), bool), **none)
    assert said == f"{run / 'poses.npz'}: camera_names are missing: track it again"
