"""The numbers of accuracy, held against cases worked by hand, laws, and the yardstick itself."""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console
from scipy.spatial.transform import Rotation

from common.npz_file import Arrays
from lab.accuracy.accuracy import (
    INDEX,
    JOINTS,
    LOST_MM,
    aligned,
    compare,
    inner_deg,
    per_joint,
    rooted,
    summary,
)
from runtime.offline.batch import Asked, track_all

PLACES = {"shoulder": (0.2, 1.4), "elbow": (0.5, 1.4), "wrist": (0.5, 1.1)}
PLACES |= {"hip": (0.1, 0.9), "knee": (0.1, 0.5), "ankle": (0.1, 0.1)}
PERSON = np.array(
    [(PLACES[j[2:]][0] * (1 if j[0] == "l" else -1), PLACES[j[2:]][1], 0.0) for j in JOINTS]
)
"""Arms out with forearms hanging, legs straight."""

people = st.integers(0, 2**32 - 1).map(
    lambda seed: PERSON + np.random.default_rng(seed).normal(0.0, 0.05, (3, 12, 3))
)


def truth_of(present: list[bool], **more: np.ndarray) -> dict[str, np.ndarray]:
    at = np.where(np.array(present)[:, None, None], PERSON, np.nan)
    return {"present": np.array(present), "joints3d": at, "joint_names": np.array(JOINTS), **more}


def poses_of(frames: list[int], joints_m: np.ndarray, confidence: float = 0.5) -> Arrays:
    return {
        "frame": np.array(frames),
        "joints_m": joints_m,
        "joint_names": np.array(JOINTS),
        "confidence": np.full(joints_m.shape[:2], confidence),
    }


def shifted(joint: str, by_m: float) -> np.ndarray:
    moved = PERSON.copy()
    moved[INDEX[joint], 2] += by_m
    return moved


def test_four_frames_worked_by_hand() -> None:
    """One exact, one with a wrist 300 mm off, one without a pose, and a ghost in an empty room."""
    truth = truth_of([True, True, True, False])
    rows = np.array([PERSON, shifted("l_wrist", 0.3), np.full((12, 3), np.nan), PERSON])
    told = summary([compare(poses_of([0, 1, 2, 3], rows), truth)])
    assert (told["clips"], told["frames"], told["ghost"]) == (1, 3, 1.0)
    assert told["coverage"] == pytest.approx(2 / 3)
    assert told["lost"] == pytest.approx(2 / 3)
    assert told["abs_mm"]["mean"] == pytest.approx(300 / 24)
    assert told["abs_mm"]["median"] == 0.0


def test_a_joint_is_its_own_and_sides_are_kept_apart() -> None:
    rows = np.array([shifted("r_knee", 0.04), shifted("r_knee", -0.02)])
    off = per_joint([compare(poses_of([0, 1], rows), truth_of([True, True]))])
    assert off["r_knee"]["mean"] == pytest.approx(30.0)
    assert all(one["mean"] == 0.0 for name, one in off.items() if name != "r_knee")


def test_frames_that_the_film_has_not_are_not_asked_for() -> None:
    """Frame 1 of the video shows row 2 of the truth; row 1 was never filmed."""
    truth = truth_of([True, True, True], frames_cam1=np.array([0, 2]))
    compared = compare(poses_of([0, 1, 7], np.array([PERSON, PERSON, PERSON])), truth)
    assert compared.due == 2
    assert compared.rows.tolist() == [0, 2]
    assert compared.frames.tolist() == [0, 1]


def test_a_row_half_known_is_no_pose_but_a_ghost() -> None:
    half = np.where(np.arange(12)[:, None] < 6, PERSON, np.nan)
    compared = compare(poses_of([0, 1], np.array([half, half])), truth_of([True, False]))
    assert (compared.due, len(compared.rows), compared.empty, compared.ghosts) == (1, 0, 1, 1)


def test_nothing_measured_is_no_number() -> None:
    told = summary([compare(poses_of([], np.empty((0, 12, 3))), truth_of([True]))])
    assert (told["coverage"], told["lost"]) == (0.0, 1.0)
    assert np.isnan([told["abs_mm"]["mean"], told["angle_deg"]["all"], told["ghost"]]).all()


def test_inner_angles_are_those_of_the_person() -> None:
    """The elbow is bent at a right angle, knees are straight, arms stand off level."""
    found = dict(
        zip(("shoulder", "elbow", "hip", "knee"), inner_deg(PERSON[None])[0, ::2], strict=True)
    )
    slope = np.degrees(np.arctan2(0.1, 0.5))
    assert found["elbow"] == pytest.approx(90.0)
    assert found["knee"] == pytest.approx(180.0, abs=1e-3)
    assert found["shoulder"] == pytest.approx(90.0 + slope)
    assert found["hip"] == pytest.approx(180.0 - slope)


@given(people, st.tuples(*[st.floats(-2.0, 2.0)] * 3))
def test_a_move_costs_its_length_and_the_root_takes_it_away(
    joints_m: np.ndarray, move_m: tuple[float, float, float]
) -> None:
    truth = {**truth_of([True] * 3), "joints3d": joints_m}
    told = summary([compare(poses_of([0, 1, 2], joints_m + move_m), truth)])
    assert told["abs_mm"]["mean"] == pytest.approx(1e3 * float(np.linalg.norm(move_m)), abs=1e-9)
    assert told["root_mm"]["p95"] == pytest.approx(0.0, abs=1e-9)
    assert rooted(joints_m + move_m) == pytest.approx(rooted(joints_m), abs=1e-12)


@given(people, st.integers(0, 2**32 - 1), st.floats(0.2, 5.0))
def test_a_similarity_is_undone(joints_m: np.ndarray, seed: int, scale: float) -> None:
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    moved = scale * joints_m @ turn + [1.0, -2.0, 3.0]
    assert aligned(moved, joints_m) == pytest.approx(joints_m, abs=1e-7)
    assert inner_deg(moved) == pytest.approx(inner_deg(joints_m), abs=1e-4)


def test_a_mirror_image_is_not_undone() -> None:
    bent = PERSON + np.random.default_rng(0).normal(0, 0.1, PERSON.shape)
    assert np.abs(aligned((bent * [-1, 1, 1])[None], bent[None]) - bent).max() > 0.05


def test_a_missing_joint_is_named() -> None:
    poses = {**poses_of([0], PERSON[None]), "joint_names": np.array(["neck", *JOINTS[1:]])}
    with pytest.raises(ValueError, match="there is no joint 'l_shoulder'; there are neck, r_"):
        compare(poses, truth_of([True]))


@pytest.fixture(scope="module")
def yardstick(data_dir: Path) -> ModuleType:
    path = data_dir.parent / "tools" / "score_tracking.py"
    if not path.is_file():
        pytest.skip(f"the yardstick is not at {path}")
    spec = importlib.util.spec_from_file_location("score_tracking", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def real_runs(
    data_dir: Path, tmp_path_factory: pytest.TempPathFactory
) -> list[tuple[Arrays, Arrays]]:
    """Runs and truths of a clip whole and spoiled, and of one with frames missing."""
    out = tmp_path_factory.mktemp("runs")
    clips = [data_dir / "dev" / "r07_t1_14_kick_right_forward"]
    clips += sorted((data_dir / "dev_stress" / "frame_drops").glob("*/"))[:1]
    track_all(clips, out, Asked(), Console(quiet=True))
    pairs = []
    for clip in clips:
        with np.load(out / clip.name / "poses.npz") as poses, np.load(clip / "truth.npz") as truth:
            pairs.append(({k: poses[k] for k in poses.files}, {k: truth[k] for k in truth.files}))
    poses, truth = pairs[0]
    spoiled = poses["joints_m"].copy()
    spoiled[20:25] = np.nan
    spoiled[2:4] = spoiled[30]
    spoiled[40, 3] = np.nan
    return [*pairs, ({**poses, "joints_m": spoiled}, truth)]


@pytest.mark.slow
def test_the_yardstick_says_the_same(
    yardstick: ModuleType, real_runs: list[tuple[Arrays, Arrays]]
) -> None:
    """`score_tracking.py` decides; ours are its figures before they are rounded."""
    theirs = [yardstick.compare(*pair) for pair in real_runs]
    ours = [compare(*pair) for pair in real_runs]
    for one, other in zip(ours, theirs, strict=True):
        assert (one.due, [one.empty, one.ghosts]) == (other["due"], other["ghost"])
        assert one.off_mm == pytest.approx(other["abs"], abs=1e-9)
        turned = np.abs(inner_deg(one.tracked_m) - inner_deg(one.true_m))
        assert turned == pytest.approx(other["ang"], abs=1e-6)
    assert [len(one.rows) for one in ours] == [len(other["abs"]) for other in theirs]
    told, due = summary(ours), yardstick.summary(theirs)
    for name in ("abs_mm", "root_mm", "pa_mm"):
        assert told[name] == pytest.approx(due[name], abs=0.0501)
    assert told["angle_deg"] == pytest.approx(due["angle_deg"], abs=0.00501)
    for name in ("clips", "frames", "coverage", "lost", "ghost"):
        assert told[name] == pytest.approx(due[name], abs=0.0000501)
    each = {name: off["mean"] for name, off in per_joint(ours).items()}
    assert each == pytest.approx(due["abs_mm_per_joint"], abs=0.0501)


def test_each_figure_takes_away_what_its_name_says() -> None:
    """A body of 0.9 times the size that stands 0.4 m aside: each joint is off by the shift and a
    tenth of its distance from where all shrinks to; seen from the hips by the tenth alone; aligned
    by nothing. The reverse alignment would count the larger body's millimetres."""
    rng = np.random.default_rng(4)
    wobble = rng.normal(0.0, 0.02, PERSON.shape)
    true = PERSON[None] + (1.0, 0.0, 2.0)
    hips = true[0, [INDEX["l_hip"], INDEX["r_hip"]]].mean(axis=0)
    told = 0.9 * (true - hips) + hips + (0.4, 0.0, 0.0)
    arrays = truth_of([True])
    one = compare(poses_of([0], told), {**arrays, "joints3d": true})
    figures = summary([one])
    from_hips = np.linalg.norm(true[0] - hips, axis=1)
    assert figures["root_mm"]["mean"] == pytest.approx(100 * from_hips.mean())
    assert figures["pa_mm"]["mean"] == pytest.approx(0.0, abs=1e-6)
    rough = compare(poses_of([0], told + 0.9 * wobble), {**arrays, "joints3d": true})
    q, p = true[0] - true[0].mean(axis=0), told[0] + 0.9 * wobble
    p = p - p.mean(axis=0)
    turn, _ = Rotation.align_vectors(q, p)
    scale = (q * turn.apply(p)).sum() / (p * p).sum()
    due = np.linalg.norm(scale * turn.apply(p) - q, axis=1)
    assert summary([rough])["pa_mm"]["mean"] == pytest.approx(1e3 * due.mean(), rel=1e-6)


def test_a_frame_is_lost_where_a_joint_is_beyond_the_limit_or_there_is_no_pose() -> None:
    """Of five frames due: one 10 mm within the limit, one 10 mm beyond, one without a pose."""
    limit_m = LOST_MM / 1e3
    off_m = (0.0, limit_m - 0.01, limit_m + 0.01)
    frames = np.stack([shifted("l_wrist", each) for each in off_m])
    told = summary([compare(poses_of([0, 1, 3], frames), truth_of([True] * 5 + [False]))])
    assert (told["frames"], told["coverage"], told["lost"]) == (5, pytest.approx(0.6), 3 / 5)
    assert told["clips"] == 1
    assert told["ghost"] == 0.0
