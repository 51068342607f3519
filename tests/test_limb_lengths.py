"""Lengths of limbs, held against a body whose lengths are known."""

import numpy as np
import pytest
from test_accuracy import PERSON

from common.body.proportions import thesis_bdp
from lab.accuracy.accuracy import INDEX, Compared
from lab.accuracy.limb_lengths import SEGMENTS, body_joints_m, length_errors, segments_m


def compared(tracked_m: np.ndarray, true_m: np.ndarray) -> Compared:
    n = len(true_m)
    return Compared(np.arange(n), np.arange(n), tracked_m, true_m, np.ones((n, 12)), n, 0, 0)


def test_segments_of_a_person_drawn_by_hand() -> None:
    found = {name: sides[0].tolist() for name, sides in segments_m(PERSON[None]).items()}
    both = {"upper arm": 0.3, "forearm": 0.3, "thigh": 0.4, "shank": 0.4}
    assert {name: pytest.approx([length] * 2) for name, length in both.items()} == {
        name: found[name] for name in both
    }
    assert found["trunk"] == pytest.approx([0.5])
    assert found["shoulder width"] == pytest.approx([0.4])
    assert found["hip width"] == pytest.approx([0.2])


def test_an_arm_too_long_is_told_of_the_arm_alone() -> None:
    """One wrist 20 mm too far along one forearm: 10 mm off over both sides, and 10 mm too long."""
    longer = PERSON.copy()
    longer[INDEX["l_wrist"], 1] -= 0.02
    told = length_errors([compared(longer[None], PERSON[None])], [None])
    assert told["joints"]["forearm"] == pytest.approx({"off_mm": 10.0, "bias_mm": 10.0})
    assert told["joints"]["all"]["off_mm"] == pytest.approx(10.0 / len(SEGMENTS))
    assert np.isnan(told["body"]["forearm"]["off_mm"])


def test_a_body_is_held_to_the_middle_of_the_clip() -> None:
    """Where truth stretches in one frame of three, the measured body is still exact."""
    bdp = thesis_bdp(1.75)
    own = body_joints_m(bdp)
    true = np.concatenate([own, own, 1.1 * own])
    told = length_errors([compared(true, true)], [bdp])
    assert told["body"]["all"]["off_mm"] == pytest.approx(0.0, abs=1e-9)
    bigger = length_errors([compared(true, true)], [bdp.scaled(1.1)])
    thigh_m = segments_m(own)["thigh"][0, 0]
    assert bigger["body"]["thigh"]["bias_mm"] == pytest.approx(100.0 * thigh_m)


def test_too_long_and_too_short_do_not_make_right() -> None:
    narrow, wide = PERSON.copy(), PERSON.copy()
    narrow[INDEX["l_hip"], 0] -= 0.03
    wide[INDEX["l_hip"], 0] += 0.03
    told = length_errors([compared(np.array([narrow, wide]), np.array([PERSON] * 2))], [None])
    assert told["joints"]["hip width"]["off_mm"] == pytest.approx(30.0)
    assert told["joints"]["hip width"]["bias_mm"] == pytest.approx(0.0, abs=1e-9)


def test_a_length_that_wavers_about_the_true_one_has_it_as_its_median() -> None:
    narrow, wide = PERSON.copy(), PERSON.copy()
    narrow[INDEX["l_hip"], 0] -= 0.03
    wide[INDEX["l_hip"], 0] += 0.03
    tracked = np.array([narrow, PERSON, wide])
    told = length_errors([compared(tracked, np.array([PERSON] * 3))], [None])
    assert told["joints"]["hip width"]["off_mm"] == pytest.approx(20.0)
    assert told["medians"]["hip width"]["off_mm"] == pytest.approx(0.0, abs=1e-9)
