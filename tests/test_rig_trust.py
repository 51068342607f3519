"""The gate: rigs that are right pass, rigs that are wrong are named."""

import math
import re
from collections.abc import Callable

import msgspec
import numpy as np
import pytest
from test_person_calibration import PAPER, filmed_by_the_papers_rig

from calibration.gate.rig_fault import advice_on, exchanged_rig
from calibration.gate.rig_trust import (
    Trust,
    _odd,
    _stature_m,
    apart,
    case_of,
    soles_m,
    trust_of,
    with_lateness,
)
from calibration.person.rig_evidence import ClipEvidence, Evidence
from calibration.person.rig_fit import Fit
from calibration.person.rig_residuals import Explained
from calibration.person.rig_starts import known_of
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import JointTrack
from calibration.tracks.lateness import Clock
from calibration.tracks.rig_guess import LATE, RIG, guess_of, pinholes, rotation
from calibration.tracks.sight_lines import Meeting
from common.body.body import JOINT_NAMES
from common.rig.camera import Rig, as_matrix, as_row, centre

PERIOD_S = 1 / 15
POSTURE = "raise_both_forward_up"
SHOWN = filmed_by_the_papers_rig(6, "walk_toward").sighting


def turned(deg: float) -> Rig:
    first, second = PAPER.cameras
    R = rotation(math.radians(deg - 90.0), 0.0, 0.0)
    wrong = msgspec.structs.replace(second, R=as_matrix(R), t=as_row(-R @ centre(second)))
    return msgspec.structs.replace(PAPER, cameras=(first, wrong))


def enlarged(times: float) -> Rig:
    cameras = tuple(
        msgspec.structs.replace(one, K=as_matrix(np.diag([times, times, 1.0]) @ np.array(one.K)))
        for one in PAPER.cameras
    )
    return msgspec.structs.replace(PAPER, cameras=cameras)


def judged(rig: Rig, late_frames: float = 0.0) -> tuple[Trust, str]:
    second = SHOWN.second._replace(times_s=SHOWN.second.times_s + late_frames * PERIOD_S)
    shown = SHOWN._replace(second=second)
    trust = trust_of(rig, shown, PERIOD_S)
    assert trust is not None
    return trust, advice_on(rig, shown, PERIOD_S, trust)


def test_a_rig_that_is_right_is_believed() -> None:
    trust, advice = judged(PAPER)
    assert (trust.believed, trust.odd, advice) == (True, (), "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "late_frames", "named"),
    [
        (lambda: turned(8.0), 0.0, r"camera 2 seems turned by \d+ degrees against camera 1"),
        (lambda: exchanged_rig(PAPER), 0.0, "the cameras are exchanged"),
        (lambda: enlarged(2.0), 0.0, "for pictures 2 times as large"),
        (lambda: PAPER, 5.0, r"view 2 is \+[45]\.\d frames late"),
    ],
    ids=["turned", "exchanged", "another size", "late"],
)
def test_a_rig_that_is_wrong_is_named_and_says_what_to_do(
    wrong: Callable[[], Rig], late_frames: float, named: str
) -> None:
    trust, advice = judged(wrong(), late_frames)
    assert not trust.believed
    assert re.search(named, advice)


@pytest.mark.parametrize("copied", [SHOWN.first, SHOWN.second], ids=["front", "side"])
def test_a_view_and_its_copy_are_named_whichever_it_is(copied: JointTrack) -> None:
    """They are as far apart in facing as the rig has its cameras: 90 degrees."""
    twice = SHOWN._replace(first=copied, second=copied)
    trust = trust_of(PAPER, twice, PERIOD_S)
    assert trust is not None
    assert trust.facing_deg == pytest.approx(90.0, abs=2.0)
    assert "facing" in trust.odd
    assert not trust.believed
    assert "both views show the person from one side" in advice_on(PAPER, twice, PERIOD_S, trust)


def test_views_of_two_takes_of_one_person_are_named() -> None:
    """The same person at the same place; the trunk's sight lines meet."""
    one, other = (filmed_by_the_papers_rig(6, name).sighting for name in ("squat", POSTURE))
    mixed = one._replace(second=other.second)
    trust = trust_of(PAPER, mixed, PERIOD_S)
    assert trust is not None
    assert trust.motion_mm > 60.0
    assert "motion" in trust.odd
    assert "the views do not show one motion" in advice_on(PAPER, mixed, PERIOD_S, trust)
    for sighting in (one, other):
        trust = trust_of(PAPER, sighting, PERIOD_S)
        assert trust is not None
        assert trust.motion_mm < 35.0
        assert trust.believed


def test_nobody_says_nothing_of_a_rig() -> None:
    blind = SHOWN.second._replace(confidence=np.zeros_like(SHOWN.second.confidence))
    assert trust_of(PAPER, SHOWN._replace(second=blind), PERIOD_S) is None


@pytest.mark.parametrize("unseen", ["ankle", "knee"])
def test_who_is_never_seen_whole_is_judged_by_plain_numbers_as_summaries_take_them(
    unseen: str,
) -> None:
    below = [n for n, name in enumerate(JOINT_NAMES) if name.endswith((unseen, "ankle"))]
    confidence = SHOWN.second.confidence.copy()
    confidence[:, below] = 0.0
    cut = SHOWN._replace(second=SHOWN.second._replace(confidence=confidence))
    trust = trust_of(PAPER, cut, PERIOD_S)
    assert trust is not None
    assert msgspec.to_builtins(trust)["stature_m"] == pytest.approx(1.75, abs=0.25)


def test_a_given_rig_is_the_vector_that_makes_it_again() -> None:
    rig = turned(12.0)
    guess = np.concatenate([guess_of(rig), np.zeros(9)])
    assert len(guess_of(rig)) == RIG
    for one, camera in zip(pinholes(guess), rig.cameras, strict=True):
        assert pytest.approx(np.array(camera.R), abs=1e-9) == one.R
    apart = np.linalg.norm(centre(rig.cameras[0]) - centre(rig.cameras[1]))
    assert np.linalg.norm(pinholes(guess)[1].centre_m - pinholes(guess)[0].centre_m) == (
        pytest.approx(apart)
    )


def placed(gaps_m: np.ndarray, sure: np.ndarray) -> tuple[Explained, Evidence]:
    """Sight lines that miss by so much, (n, 15), of landmarks that view 1 is so sure of."""
    n = len(gaps_m)
    nothing, used = np.zeros(n), np.ones((n, 15), bool)
    first = JointTrack(nothing, np.zeros((n, 15, 2)), sure, nothing, nothing)
    second = first._replace(confidence=np.full((n, 15), 0.9))
    points = np.zeros((n, 15, 3))
    met = Meeting(points, np.zeros((3, n, 15, 3)), np.zeros((3, n, 15)), gaps_m, gaps_m, used)
    one = Explained(met, used, np.zeros((n, 12)), np.ones((n, 12), bool), second)
    known = known_of(320, 1.75, 1)
    return one, Evidence((ClipEvidence(first, second, (80.0, 60.0)),), (320, 240), known, 5.0)


def test_views_are_apart_by_the_medians_of_joints_that_are_surely_seen_often() -> None:
    """Worked by hand: of the steady joints one is 0.03 m off, one 0.04 the other way, the rest
    are not; a wrist, an unsure knee and one that is seen in five frames do not count."""
    gaps_m, sure = np.zeros((9, 15)), np.full((9, 15), 0.8)
    at = {name: n for n, name in enumerate(JOINT_NAMES)}
    gaps_m[:, at["neck"]], gaps_m[:, at["l_hip"]] = 0.03, -0.04
    gaps_m[:3, at["neck"]], gaps_m[:2, at["l_hip"]] = 0.9, -0.9
    gaps_m[:, [at["l_wrist"], at["r_elbow"], at["r_knee"], at["l_ankle"]]] = 0.7
    sure[:, at["r_knee"]], sure[5:, at["l_ankle"]] = 0.59, 0.59
    one, evidence = placed(gaps_m, sure)
    assert apart(one, evidence) == pytest.approx(math.sqrt((0.03**2 + 0.04**2) / 9))
    sure[5, at["l_ankle"]] = 0.6
    one, evidence = placed(gaps_m, sure)
    assert apart(one, evidence) == pytest.approx(math.sqrt((0.03**2 + 0.04**2 + 0.7**2) / 10))
    assert apart(*placed(gaps_m, 0 * sure)) == 0.0


def test_soles_are_those_of_the_lower_foot_mostly() -> None:
    """Worked by hand: five frames, in one of which no ankle is seen and in one only the upper."""
    one, _ = placed(np.zeros((5, 15)), np.full((5, 15), 0.8))
    left, right = prior.ANKLES
    one.met.points_m[:, left, 1] = [0.10, 0.12, 0.40, 0.50, 0.0]
    one.met.points_m[:, right, 1] = [0.30, 0.30, 0.11, 0.13, 0.0]
    one.used[3, right] = False
    one.used[4, [left, right]] = False
    assert soles_m(one, 1.8) == pytest.approx(0.115 - 0.05 * 1.8)
    one.used[:] = False
    assert soles_m(one, 1.8) == 0.0


def test_a_persons_stature_is_what_stands_upon_each_other() -> None:
    """Trunk and neck, thigh and shank of both sides, by their medians; a length that is never
    seen is that of 1.75 m."""
    one, _ = placed(np.zeros((3, 15)), np.full((3, 15), 0.8))
    heights_m = {"pelvis": 0.9, "neck": 1.42, "head_top": 1.7}
    for name, height_m in heights_m.items():
        one.met.points_m[:, JOINT_NAMES.index(name), 1] = height_m
    for side, longer in (("l", 0.02), ("r", 0.0)):
        at = [JOINT_NAMES.index(f"{side}_{name}") for name in ("hip", "knee", "ankle")]
        one.met.points_m[:, at, 1] = [0.9 + longer, 0.48, 0.1 - longer]
    total_m = 0.52 + 0.28 + (0.42 + 0.01) + (0.38 + 0.01)
    assert _stature_m(one) == pytest.approx(total_m / 0.952)
    unseen = one._replace(lengths_used=np.zeros((3, 12), bool))
    upright = prior.SHARES[prior.UPRIGHT].sum() / 0.952
    assert _stature_m(unseen) == pytest.approx(1.75 * upright / 0.952)


ODD = {
    "apart": ({"apart_mm": 65.0}, {"apart_mm": 65.1}),
    "late": ({"late_frames": 0.75}, {"late_frames": -0.76}),
    "floor": ({"soles_mm": -35.0}, {"soles_mm": -35.1}),
    "floor ": ({"soles_mm": 85.0}, {"soles_mm": 85.1}),
    "stature": ({"stature_m": 0.9}, {"stature_m": 0.89}),
    "stature ": ({"stature_m": 2.3}, {"stature_m": 2.31}),
    "facing": ({"facing_deg": 45.0}, {"facing_deg": 45.1}),
    "motion": ({"motion_mm": 45.0}, {"motion_mm": 45.1}),
}


@pytest.mark.parametrize("word", ODD)
def test_what_is_odd_of_a_rig_begins_beyond_its_bound(word: str) -> None:
    usual = Trust(True, 20.0, 2.0, 0.1, 10.0, 1.75, 5.0, 10.0, 30)
    within, beyond = (msgspec.structs.replace(usual, **changed) for changed in ODD[word])
    assert _odd(within) == []
    assert _odd(beyond) == [word.strip()]


def test_a_view_that_is_late_and_a_gap_are_told_in_frames_and_pixels() -> None:
    """Three frames late; pixels are of the mean height in both pictures."""
    second = SHOWN.second._replace(times_s=SHOWN.second.times_s + 3.0 * PERIOD_S)
    trust = trust_of(PAPER, SHOWN._replace(second=second), PERIOD_S)
    assert trust is not None
    assert trust.late_frames == pytest.approx(3.0, abs=0.5)
    case = case_of(PAPER, SHOWN._replace(second=second))
    assert case is not None
    unit_px = sum(case.evidence.clips[0].units_px) / 2
    assert trust.apart_px == pytest.approx(
        trust.apart_mm / 1e3 / trust.stature_m * unit_px, rel=1e-6
    )
    assert trust.stature_m == pytest.approx(1.75, abs=0.1)
    assert abs(trust.soles_mm) < 60.0


@pytest.mark.parametrize(
    ("clock", "tried"),
    [
        (Clock(0.2), [0.2]),
        (Clock(0.2, (0.9,)), [0.0, 0.2]),
        (Clock(0.2, None), [0.2]),
    ],
    ids=["found", "rivals", "unknown"],
)
def test_the_times_as_they_are_are_tried_too_where_the_clock_is_not_sure(
    monkeypatch: pytest.MonkeyPatch, clock: Clock, tried: list[float]
) -> None:
    asked: list[float] = []

    def fit(start: np.ndarray, evidence: object, free: np.ndarray, *_: int) -> Fit:
        asked.append(float(start[LATE]))
        assert free.tolist() == [n == LATE for n in range(len(start))]
        return Fit(start, 5.0 - start[LATE], (), np.zeros((1, 1)))

    monkeypatch.setattr("calibration.gate.rig_trust.fitted", fit)
    case = case_of(PAPER, SHOWN, Clock(0.0))
    assert case is not None
    found = with_lateness(case._replace(clock=clock))
    assert sorted(asked) == tried
    assert found.guess[LATE] == max(tried), "the cheapest"
