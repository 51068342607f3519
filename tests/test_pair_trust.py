"""Which camera of several is to blame, by rigs of which one camera was turned or moved."""

from typing import Any

import msgspec
import numpy as np
import pytest
from many_views import around, shown

from calibration.gate import pair_trust
from calibration.gate.pair_trust import PairTrust, advice_of, least_believed
from calibration.gate.rig_trust import Trust
from calibration.tracks.camera_clocks import Clocks
from calibration.tracks.lateness import Clock
from calibration.tracks.rig_guess import rotation
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre

PERIOD_S = 1 / 15
ON_TIME: Clocks = (Clock(0.0),) * 3
RIG = around(4)
SHOWN = shown(RIG, 11, "walk_toward")


def turned(camera: Camera) -> Camera:
    """About the vertical by seven degrees, on its spot."""
    own = as_matrix(np.array(camera.R) @ rotation(0.0, 0.0, 0.0) @ rotation(0.12, 0.0, 0.0).T)
    return msgspec.structs.replace(camera, R=own, t=as_row(-np.array(own) @ centre(camera)))


def moved(camera: Camera) -> Camera:
    """By half a metre to the side."""
    return msgspec.structs.replace(camera, t=(camera.t[0] + 0.5, *camera.t[1:]))


def test_a_good_rig_is_believed_by_all_pairs() -> None:
    found = least_believed(RIG, SHOWN, PERIOD_S, ON_TIME)
    assert found is not None
    assert found.trust.believed
    assert advice_of(found, RIG, SHOWN, PERIOD_S, ON_TIME, 0.0) == ""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "fault"),
    [(0, turned), (1, moved), (2, turned), (3, moved)],
    ids=["turned 1", "moved 2", "turned 3", "moved 4"],
)
def test_the_camera_that_is_wrong_is_named(wrong: int, fault: Any) -> None:
    cameras = [*RIG.cameras]
    cameras[wrong] = fault(cameras[wrong])
    rig = msgspec.structs.replace(RIG, cameras=tuple(cameras))
    found = least_believed(rig, SHOWN, PERIOD_S, ON_TIME)
    assert found is not None
    assert not found.trust.believed
    assert found.second == wrong
    said = advice_of(found, rig, SHOWN, PERIOD_S, ON_TIME, 0.0)
    assert said.startswith(f"cam{wrong + 1} seems ")
    assert "camera" not in said.split(":")[0]


TRUST = Trust(True, 20.0, 1.0, 0.0, 0.0, 1.7, 3.0, 10.0, 80)


def judged_so(monkeypatch: pytest.MonkeyPatch, apart_mm: dict[tuple[str, str], float]) -> None:
    """Pairs that are so far apart; of more than 60 mm none is believed."""

    def trust_of(rig: Rig, *_: Any) -> Trust | None:
        off_mm = apart_mm.get((rig.cameras[0].name, rig.cameras[1].name))
        believed = off_mm is not None and off_mm < 60.0
        if off_mm is None:
            return None
        return msgspec.structs.replace(TRUST, apart_mm=off_mm, believed=believed)

    monkeypatch.setattr(pair_trust, "trust_of", trust_of)


def test_of_two_cameras_in_as_many_bad_pairs_the_one_is_to_blame_whose_pairs_are_further_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    judged_so(monkeypatch, {("cam1", "cam2"): 50.0, ("cam1", "cam3"): 90.0, ("cam2", "cam3"): 20.0})
    found = least_believed(around(3), SHOWN, PERIOD_S, ON_TIME)
    assert found is not None
    assert (found.first, found.second) == (2, 0)
    assert found.trust.apart_mm == 90.0


def test_a_pair_of_four_cameras_that_errs_by_itself_is_no_reason_for_doubt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One of three of each of its cameras' pairs; two of three are one."""
    good = {(f"cam{n}", f"cam{m}"): 10.0 * m for n in range(1, 5) for m in range(n + 1, 5)}
    judged_so(monkeypatch, {**good, ("cam2", "cam3"): 90.0})
    found = least_believed(RIG, SHOWN, PERIOD_S, ON_TIME)
    assert found is not None
    assert found.trust.believed
    assert found.trust.apart_mm == 40.0
    judged_so(monkeypatch, {**good, ("cam2", "cam3"): 90.0, ("cam1", "cam3"): 70.0})
    found = least_believed(RIG, SHOWN, PERIOD_S, ON_TIME)
    assert found is not None
    assert (found.first, found.second) == (1, 2)


def test_where_no_pair_sees_enough_nothing_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    judged_so(monkeypatch, {})
    assert least_believed(RIG, SHOWN, PERIOD_S, ON_TIME) is None


def test_a_camera_that_is_late_is_told_how_to_be_set_back() -> None:
    late = msgspec.structs.replace(TRUST, believed=False, odd=("late",), late_frames=3.0)
    said = advice_of(PairTrust(0, 2, late), RIG, SHOWN, PERIOD_S, ON_TIME, 0.1)
    assert said.startswith("cam3 is +3.0 frames late: set cameras.cam3.offset_s = 0.30 in the")
