"""What a run says of its calibration."""

from typing import Any

import pytest

from tritrack.offline.rig_check import doubts

TRUST = {
    "apart_mm": 61.4,
    "apart_px": 2.6,
    "soles_mm": -80.2,
    "stature_m": 1.86,
    "late_frames": 0.2,
    "facing_deg": 3.2,
    "motion_mm": 21.4,
    "advice": "camera 2 seems turned by 8 degrees against camera 1: calibrate again",
}


@pytest.mark.parametrize("facts", [{}, {"trust": {**TRUST, "advice": ""}}])
def test_a_run_that_is_believable_or_cannot_tell_says_nothing(facts: dict[str, Any]) -> None:
    assert doubts(facts) == []


def test_a_run_that_is_not_believable_says_what_is_wrong_and_what_to_do_in_one_line() -> None:
    (told,) = doubts({"trust": TRUST})
    assert "views 61 mm (2.6 px) apart, soles -80 mm over the floor" in told
    assert "facings 3 degrees apart, motions 21 mm" in told
    assert "camera 2 seems turned by 8 degrees against camera 1: calibrate again" in told
