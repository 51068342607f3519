"""Run folders, held against the contract that users and tools read them by (design, section 3)."""

import errno
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from common.body.body import ANGLE_NAMES, JOINT_NAMES
from common.body.extremities import EXTREMITY_NAMES
from common.bus.messages import Body, Performance, Posture
from common.config.settings import Settings
from runtime.offline.lockstep import Tracked
from runtime.store.joint_arrays import on_disk
from runtime.store.past_run import open_run
from runtime.store.pose_arrays import poses
from runtime.store.run_exports import EXPORTS
from runtime.store.runs import (
    RunError,
    belief_facts,
    summary_of,
    unwritable,
    write_postures,
    write_run,
)
from runtime.terminal import json_text

N = 69
CONTRACT = {
    "frame": ("i", (N,)),
    "person": ("i", (N,)),
    "time_s": ("f", (N,)),
    "joints_m": ("f", (N, 22, 3)),
    "joint_names": ("U", (22,)),
    "joints_px": ("f", (N, 2, 22, 2)),
    "angles_deg": ("f", (N, 17)),
    "angle_names": ("U", (17,)),
    "angles_raw_deg": ("f", (N, 17)),
    "confidence": ("f", (N, 22)),
    "status": ("U", (N,)),
    "camera_names": ("U", (2,)),
    "seen": ("b", (N, 2)),
    "views": ("U", (N,)),
    "score": ("f", (N, 2)),
    "facing": ("U", (N, 2)),
}
"""Kind of number and shape of each array, as printed there."""


@pytest.fixture(scope="module")
def run(clip: Path, tracked_clip: Tracked, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    write_run(folder, tracked_clip.bodies, Settings(clip=str(clip)), tracked_clip.facts)
    return folder


@pytest.fixture(scope="module")
def arrays(run: Path) -> dict[str, np.ndarray]:
    with np.load(run / "poses.npz", allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def test_a_summary_counts_instants_as_well_as_bodies_and_the_bodies_of_each_person() -> None:
    """Four instants: nobody; two people believed; one of two; neither."""
    status = [(0, 0, "empty"), (1, 1, "tracking"), (1, 2, "measuring"), (2, 1, "lost")]
    status += [(2, 2, "tracking"), (3, 1, "predicted"), (3, 2, "lost")]
    told = summary_of([body(at, person=who, status=how) for at, who, how in status], Settings(), {})
    assert (told["frames"], told["instants"], told["instants_believed"]) == (7, 4, 2)
    assert told["people"] == {
        "1": {"frames": 3, "believed": 1},
        "2": {"frames": 3, "believed": 2},
    }
    alone = summary_of([body(0), body(1, status="tracking")], Settings(), {})
    assert (alone["instants"], alone["instants_believed"], "people" in alone) == (2, 1, False)


def test_a_run_that_is_written_anew_removes_what_was_exported_of_the_one_before(
    tmp_path: Path,
) -> None:
    """Of other poses; what the user put beside them stays."""
    mine = ("dance.glb", "notes.toml", "dance_person2.glb", "body_personal.bvh")
    of_people = ("body_person1.bvh", "markers_person12.trc", "body_person2.osim")
    for name in (*EXPORTS, *of_people, *mine):
        (tmp_path / name).write_bytes(b"of other poses")
    write_run(tmp_path, [body(0), body(1)], Settings(), {})
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"poses.npz", "summary.json", *mine}


def body(frame: int, **more: object) -> Body:
    told = {"status": "empty", "views": "none", **more}
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, **told)  # type: ignore[arg-type]


def test_the_arrays_are_those_of_the_contract(arrays: dict[str, np.ndarray]) -> None:
    assert {name: (a.dtype.kind, a.shape) for name, a in arrays.items()} == CONTRACT


def test_rows_are_camera_1s_frames_and_their_times(arrays: dict[str, np.ndarray]) -> None:
    assert arrays["frame"].tolist() == list(range(N))
    np.testing.assert_allclose(arrays["time_s"], np.arange(N) / 15)


def test_joints_are_named_as_printed(arrays: dict[str, np.ndarray]) -> None:
    sides = [f"{side}_{part}" for side in "lr" for part in ("shoulder", "elbow", "wrist")]
    sides += [f"{side}_{part}" for side in "lr" for part in ("hip", "knee", "ankle")]
    assert arrays["joint_names"].tolist()[:3] == ["pelvis", "neck", "head_top"]
    assert set(arrays["joint_names"].tolist()[3:15]) == set(sides)


def test_words_are_those_of_the_contract(arrays: dict[str, np.ndarray]) -> None:
    statuses = {"empty", "measuring", "tracking", "predicted", "lost"}
    assert set(arrays["status"]) <= statuses
    assert set(arrays["views"]) <= {"both", "1", "2", "none"}
    assert set(arrays["facing"].ravel()) <= {"facade", "flank"}


def test_a_pose_is_there_from_the_persons_first_frame_on_and_nan_before(
    arrays: dict[str, np.ndarray], clip: Path
) -> None:
    """The truth says when the person is there."""
    with np.load(clip / "truth.npz", allow_pickle=False) as truth:
        present = truth["present"].astype(bool)
    for name in ("joints_m", "angles_deg", "angles_raw_deg"):
        rows = arrays[name].reshape(N, -1)
        np.testing.assert_array_equal(np.isfinite(rows).all(axis=1), present, err_msg=name)
        np.testing.assert_array_equal(np.isnan(rows).all(axis=1), ~present, err_msg=name)
    np.testing.assert_array_equal(arrays["status"] == "empty", ~present)
    np.testing.assert_array_equal(arrays["confidence"].any(axis=1), present)


def test_confidence_and_score_are_shares(arrays: dict[str, np.ndarray]) -> None:
    for name in ("confidence", "score"):
        assert arrays[name].min() >= 0.0
        assert arrays[name].max() <= 1.0


def test_every_word_that_a_body_may_hold_fits_its_array() -> None:
    """A fixed width that cuts words would do so in silence."""
    longest = poses([body(0, status="predicted", views="both", facing=("facade", "flank"))])
    assert longest["status"][0] == "predicted"
    assert poses([body(0, status="measuring", views="none")])["status"][0] == "measuring"
    assert (longest["views"][0], longest["facing"][0, 0]) == ("both", "facade")


def test_only_what_the_views_bear_out_counts_as_believed() -> None:
    """Of the eight frames with a person four have a pose that is borne out."""
    often = {"empty": 5, "measuring": 1, "tracking": 3, "predicted": 2, "lost": 2}
    bodies = [
        body(0, status=status, confidence=(0.6,) * 15)
        for status, count in often.items()
        for _ in range(count)
    ]
    assert belief_facts(bodies)["believed"] == summary_of(bodies, Settings(), {})["believed"] == 0.5
    assert belief_facts([body(0, status="predicted")])["believed"] == 0.0
    assert belief_facts([body(0)])["believed"] is None
    assert belief_facts(bodies)["followed"] == summary_of(bodies, Settings(), {})["followed"] == 0.5
    assert belief_facts([body(0)])["followed"] is None


@pytest.mark.parametrize(
    ("confidence", "share"),
    [((0.5,) * 15, 1.0), ((0.25,) * 15, 0.5), ((0.9,) * 5 + (0.0,) * 10, 0.6), ((), 0.0)],
)
def test_a_frame_counts_less_where_joints_are_more_likely_wrong_than_right(
    confidence: tuple[float, ...], share: float
) -> None:
    doubtful = body(0, status="tracking", confidence=confidence)
    assert (
        belief_facts([doubtful])["followed"]
        == summary_of([doubtful], Settings(), {})["followed"]
        == 1.0
    )
    assert (
        belief_facts([doubtful])["believed"]
        == summary_of([doubtful], Settings(), {})["believed"]
        == share
    )
    sure = body(0, status="tracking", confidence=(0.9,) * 15)
    assert belief_facts([doubtful, sure])["believed"] == (1.0 + share) / 2.0


def test_a_run_of_three_cameras_has_entries_of_each_by_name() -> None:
    """And no word for who sees the person, which was made for two."""
    pixels = tuple(((float(n), 2.0),) * len(JOINT_NAMES) for n in range(3))
    several = {"seen": (True, False, True), "score": (0.5, 0.0, 0.7), "made_of": (1, -1, 1)}
    tracked = body(1, joints_px=pixels, facing=("facade", "flank", "flank"), **several)
    empty = body(0, seen=(False,) * 3, score=(0.0,) * 3, facing=("facade", "flank", "flank"))
    found = poses([empty, tracked], ("left", "door"))
    assert found["camera_names"].tolist() == ["left", "door", "cam3"]
    assert found["seen"].tolist() == [[False] * 3, [True, False, True]]
    assert found["score"].tolist() == [[0.0] * 3, [0.5, 0.0, 0.7]]
    assert found["joints_px"].shape == (2, 3, len(JOINT_NAMES), 2)
    assert found["joints_px"][1, :, 0, 0].tolist() == [0.0, 1.0, 2.0]
    assert np.isnan(found["joints_px"][0]).all()
    assert "views" not in found


def test_a_run_of_three_cameras_is_read_again(tmp_path: Path) -> None:
    several = {"seen": (True,) * 3, "score": (0.5,) * 3, "facing": ("flank",) * 3}
    write_run(tmp_path, [body(0, **several)], Settings(), {"cameras": ["a", "b", "c"]})
    run = open_run(tmp_path)
    assert run.poses["camera_names"].tolist() == run.summary["cameras"] == ["a", "b", "c"]
    assert run.poses["score"].shape == (1, 3)


def test_a_run_without_frames_has_empty_arrays_of_the_same_shapes() -> None:
    for name, array in on_disk(poses([])).items():
        kind, shape = CONTRACT[name]
        expected = shape if name.endswith("_names") else (0, *shape[1:])
        assert (array.dtype.kind, array.shape) == (kind, expected)


def test_an_instant_that_camera_1_missed_gets_no_row(tmp_path: Path) -> None:
    write_run(tmp_path, [body(0), body(-1), body(1)], Settings(), {})
    with np.load(tmp_path / "poses.npz", allow_pickle=False) as file:
        assert file["frame"].tolist() == [0, 1]
    assert json.loads((tmp_path / "summary.json").read_text())["frames"] == 2


def test_the_summary_tells_what_the_contract_names(run: Path) -> None:
    told = strict((run / "summary.json").read_text())
    assert told["frames"] == N
    assert told["scale_source"] == "calibrated"
    assert {"preparation", "viewers", "integrator", "all"} <= set(told["seconds"])
    assert sum(told["status"].values()) == N
    assert told["matches_a_frame"] == 0  # joints are proposed: no view searches for them
    assert told["warnings"] == []
    assert {"tritrack", "numpy", "opencv-python-headless", "python"} <= set(told["versions"])
    assert told["settings"]["size"] == "160x120"
    assert told["settings"]["silhouette"]["empty_s"] == 0.5


def strict(text: str) -> dict[str, Any]:
    """JSON as the standard has it: no NaN, no Infinity."""

    def refuse(word: str) -> None:
        raise ValueError(word)

    told: dict[str, Any] = json.loads(text, parse_constant=refuse)
    return told


def test_json_has_no_nan(tmp_path: Path) -> None:
    write_run(tmp_path, [body(0)], Settings(), {"odd": [math.nan, {"more": (math.inf, 1.5)}]})
    assert strict((tmp_path / "summary.json").read_text())["odd"] == [None, {"more": [None, 1.5]}]
    unlikely = Posture(
        frame=0, captured_s=0.0, clock_s=0.0, name="", log_likelihoods={"squat": -math.inf}
    )
    write_postures(tmp_path, [unlikely], "")
    told = strict((tmp_path / "posture.json").read_text())
    assert told["frames"][0]["log_likelihoods"] == {"squat": None}


def test_postures_name_frame_time_segment_and_scores(tmp_path: Path) -> None:
    said = Posture(
        frame=40,
        captured_s=2.66666,
        clock_s=9.0,
        name="squat",
        segment=(1, 40),
        log_likelihoods={"squat": -12.34567},
        doing="",
        event=Performance("squat", 8, 36, 0.533, 2.4, 0.99, 1),
    )
    write_postures(tmp_path, [said], "squat")
    assert strict((tmp_path / "posture.json").read_text()) == {
        "posture": "squat",
        "events": [
            {
                "name": "squat",
                "onset": 8,
                "end": 36,
                "onset_s": 0.533,
                "end_s": 2.4,
                "posterior": 0.99,
                "times": 1,
            }
        ],
        "frames": [
            {
                "frame": 40,
                "time_s": 2.6667,
                "name": "squat",
                "segment": [1, 40],
                "doing": "",
                "log_likelihoods": {"squat": -12.346},
            }
        ],
    }


def test_a_performance_that_goes_on_takes_the_place_of_what_was_told_of_it(tmp_path: Path) -> None:
    """One of the same onset; it is told after the last frame, too, and has no row of its own."""

    def told(frame: int, event: Performance | None) -> Posture:
        return Posture(frame=frame, captured_s=frame / 15, clock_s=0.0, name="", event=event)

    first = Performance("kick_left_side", 8, 36, 0.533, 2.4, 0.99, 2)
    longer = Performance("kick_left_side", 8, 60, 0.533, 4.0, 0.98, 4)
    other = Performance("squat", 80, 99, 5.333, 6.6, 0.99, 1)
    said = [told(40, first), told(50, None), told(64, longer), told(-1, other)]
    write_postures(tmp_path, said, "squat")
    written = strict((tmp_path / "posture.json").read_text())
    assert [(one["name"], one["end"], one["times"]) for one in written["events"]] == [
        ("kick_left_side", 60, 4),
        ("squat", 99, 1),
    ]
    assert [row["frame"] for row in written["frames"]] == [40, 50, 64]


def test_of_several_people_each_row_and_performance_names_its_person(tmp_path: Path) -> None:
    def told(person: int, frame: int, event: Performance | None = None) -> Posture:
        moment: dict[str, Any] = {"frame": frame, "captured_s": frame / 15, "clock_s": 0.0}
        return Posture(person=person, name="kick", event=event, **moment)

    kick = Performance("kick", 0, 9, 0.0, 0.6, 0.9)
    write_postures(tmp_path, [told(1, 9, kick), told(2, 9, kick), told(2, 10)], "")
    found = json.loads((tmp_path / "posture.json").read_text())
    assert [(event["person"], event["name"]) for event in found["events"]] == [
        (1, "kick"),
        (2, "kick"),
    ]
    assert [(row["person"], row["frame"]) for row in found["frames"]] == [(1, 9), (2, 9), (2, 10)]
    write_postures(tmp_path, [told(0, 9, kick)], "")
    found = json.loads((tmp_path / "posture.json").read_text())
    assert "person" not in found["events"][0]
    assert "person" not in found["frames"][0]


@pytest.mark.parametrize("frames", [0, 1, 3])
def test_postures_are_laid_out_as_the_rest_of_a_summary_is(tmp_path: Path, frames: int) -> None:
    """Though they are written one by one."""
    said = (Posture(frame=n, captured_s=n / 15, clock_s=0.0, name="squat") for n in range(frames))
    write_postures(tmp_path, list(said), "squat")
    text = (tmp_path / "posture.json").read_text()
    assert len(json.loads(text)["frames"]) == frames
    assert text == json_text(json.loads(text)) + "\n"


def test_a_full_disk_keeps_the_run_that_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each file whole or not at all: a new one takes the old one's place when it is complete."""
    write_run(tmp_path, [body(0)], Settings(), {})
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def half(file: object, **_: object) -> None:
        file.write(b"PK half of it")  # type: ignore[attr-defined]
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "savez", half)
    with pytest.raises(RunError, match=rf"cannot write {tmp_path}: No space left .*free some"):
        write_run(tmp_path, [body(0), body(1)], Settings(), {})
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_folder_that_is_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(RunError, match="taken"):
        write_run(tmp_path / "taken", [], Settings(), {})
    with pytest.raises(RunError, match="taken"):
        write_postures(tmp_path / "taken", [], "")


def test_the_names_are_the_bodys_own(arrays: dict[str, np.ndarray]) -> None:
    assert tuple(arrays["joint_names"])[:15] == JOINT_NAMES
    assert tuple(arrays["joint_names"])[15:] == EXTREMITY_NAMES
    assert tuple(arrays["angle_names"]) == ANGLE_NAMES


def test_space_is_what_to_free_where_it_lacks_alone(tmp_path: Path) -> None:
    lacking = OSError(errno.ENOSPC, "No space left on device")
    refused = OSError(errno.EACCES, "Permission denied")
    assert [str(unwritable(tmp_path, error)) for error in (lacking, refused)] == [
        f"cannot write {tmp_path}: No space left on device; free some space or name another --out",
        f"cannot write {tmp_path}: Permission denied; name another --out",
    ]
