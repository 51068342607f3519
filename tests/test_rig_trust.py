"""The gate: rigs that are right pass, rigs that are wrong are named."""

import math
import re
from collections.abc import Callable

import msgspec
import numpy as np
import pytest
from test_person_calibration import PAPER, filmed_by_the_papers_rig

from common.body.body import JOINT_NAMES
from common.rig.camera import Rig, as_matrix, as_row, centre
from integrator.rig_gate.known_rig import guess_of
from integrator.rig_gate.rig_fault import advice_on, exchanged_rig
from integrator.rig_gate.rig_trust import Trust, trust_of
from integrator.selfcalibration.joint_tracks import JointTrack
from integrator.selfcalibration.rig_guess import RIG, pinholes, rotation

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
