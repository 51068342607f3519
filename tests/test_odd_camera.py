"""The camera that contradicts all others, by rigs of which one camera was turned."""

import math

import cv2
import msgspec
import numpy as np
import pytest
from many_views import around, shown

from calibration.gate import odd_camera
from calibration.gate.odd_camera import turned_back
from calibration.tracks.joint_tracks import Sightings
from calibration.tracks.lateness import Clock
from common.body.body import JOINT_NAMES
from common.rig.camera import Rig, as_row, centre
from common.rig.turned_camera import angle_deg, turned

RIG = around(4)
SHOWN = shown(RIG, 11, "walk_toward")
ON_TIME = (Clock(0.0),) * 3


def with_turns(turns_deg: dict[int, tuple[float, float, float]], rig: Rig = RIG) -> Rig:
    """The rig as a file has it whose cameras were turned since."""
    cameras = [*rig.cameras]
    for place, turn_deg in turns_deg.items():
        turn = np.asarray(cv2.Rodrigues(np.radians(turn_deg))[0], float)
        cameras[place] = turned(cameras[place], turn)
    return msgspec.structs.replace(rig, cameras=tuple(cameras))


def off_deg(one: Rig, other: Rig, place: int) -> float:
    return angle_deg(np.array(one.cameras[place].R) @ np.array(other.cameras[place].R).T)


def test_in_a_good_rig_no_camera_is_odd() -> None:
    assert odd_camera.odd_camera(RIG, [SHOWN], ON_TIME) is None


@pytest.mark.parametrize("place", range(4))
def test_a_turned_camera_is_found_and_turned_back(place: int) -> None:
    rig = with_turns({place: (1.0, -1.5, 0.0)})
    odd = odd_camera.odd_camera(rig, [SHOWN], ON_TIME)
    assert odd is not None
    assert odd.place == place
    assert np.degrees(odd.turn[:2]) == pytest.approx([-1.0, 1.5], abs=0.5)  # roll is hardly shown
    assert odd.then_m < odd_camera.AMONG * odd.apart_m
    better = turned_back(rig, odd)
    assert off_deg(rig, RIG, place) == pytest.approx(math.hypot(1.0, 1.5), abs=0.01)
    assert off_deg(better, RIG, place) < 0.5 * off_deg(rig, RIG, place)
    assert np.allclose(centre(better.cameras[place]), centre(RIG.cameras[place]))
    others = [n for n in range(4) if n != place]
    assert [better.cameras[n] for n in others] == [rig.cameras[n] for n in others]


def test_of_two_cameras_neither_is_to_blame_and_of_three_one_is() -> None:
    rig = with_turns({1: (1.5, 1.5, 0.0)})
    for count, found in ((2, None), (3, 1)):
        some = msgspec.structs.replace(rig, cameras=rig.cameras[:count])
        seen = Sightings(SHOWN.tracks[:count], SHOWN.size_px)
        odd = odd_camera.odd_camera(some, [seen], ON_TIME[1:count])
        assert (None if odd is None else odd.place) == found


def test_where_two_cameras_are_turned_none_is_turned_back() -> None:
    """The others contradict each other too: which of them is right is not known."""
    rig = with_turns({0: (1.5, 1.5, 0.0), 2: (-1.5, 1.5, 0.0)})
    assert odd_camera.odd_camera(rig, [SHOWN], ON_TIME) is None


def test_a_turn_that_sight_lines_hardly_show_stays() -> None:
    assert odd_camera.odd_camera(with_turns({3: (0.2, 0.0, 0.0)}), [SHOWN], ON_TIME) is None


def test_a_camera_that_a_turn_does_not_cure_stays() -> None:
    """Its pictures are twice as large as the calibration has it."""
    wide = RIG.cameras[2]
    K = np.array(wide.K)
    K[:2, :2] *= 0.5
    camera = msgspec.structs.replace(wide, K=tuple(map(tuple, K.tolist())))
    cameras = (*RIG.cameras[:2], camera, RIG.cameras[3])
    rig = msgspec.structs.replace(RIG, cameras=cameras)
    assert odd_camera.odd_camera(rig, [SHOWN], ON_TIME) is None


def exchanged_sides(seen: Sightings, place: int) -> Sightings:
    """A view that has left and right for each other."""
    names = [*JOINT_NAMES]
    other = {"l_": "r_", "r_": "l_"}
    order = [names.index(other.get(name[:2], name[:2]) + name[2:]) for name in names]
    tracks = [*seen.tracks]
    tracks[place] = tracks[place]._replace(joints_px=tracks[place].joints_px[:, order])
    return seen._replace(tracks=tuple(tracks))


def test_a_view_that_exchanges_left_and_right_is_not_odd() -> None:
    assert odd_camera.odd_camera(RIG, [exchanged_sides(SHOWN, 1)], ON_TIME) is None


def test_a_late_view_is_compared_by_its_clock() -> None:
    late = SHOWN.tracks[2]
    tracks = (*SHOWN.tracks[:2], late._replace(times_s=late.times_s + 0.5), SHOWN.tracks[3])
    seen = SHOWN._replace(tracks=tracks)
    clocks = (Clock(0.0), Clock(0.5), Clock(0.0))
    rig = with_turns({2: (1.0, -1.5, 0.0)})
    late_known, on_time = (
        odd_camera.odd_camera(rig, [one], delays)
        for one, delays in ((seen, clocks), (SHOWN, ON_TIME))
    )
    assert late_known is not None
    assert on_time is not None
    assert late_known.then_m == pytest.approx(on_time.then_m)


def test_people_who_are_hardly_seen_tell_nothing() -> None:
    rig = with_turns({1: (1.5, 1.5, 0.0)})
    unsure = tuple(each._replace(confidence=0.5 * each.confidence) for each in SHOWN.tracks)
    assert odd_camera.odd_camera(rig, [SHOWN._replace(tracks=unsure)], ON_TIME) is None
    assert odd_camera.odd_camera(rig, [], ON_TIME) is None


def nearer(rig: Rig, share: float) -> Rig:
    """The rig, smaller, so that all gaps are."""
    cameras = (
        msgspec.structs.replace(camera, t=as_row(share * np.array(camera.t)))
        for camera in rig.cameras
    )
    return msgspec.structs.replace(rig, cameras=tuple(cameras))


@pytest.mark.parametrize(("share", "is_odd"), [(0.5, True), (0.2, False)])
def test_gaps_that_good_rigs_have_too_turn_no_camera(share: float, is_odd: bool) -> None:
    rig = nearer(with_turns({2: (1.0, -1.5, 0.0)}), share)
    assert (odd_camera.odd_camera(rig, [SHOWN], ON_TIME) is not None) == is_odd


def test_two_views_from_one_side_are_not_compared() -> None:
    """Their sight lines hardly differ, so their normal is noise."""
    beside = msgspec.structs.replace(RIG.cameras[0], t=as_row(np.array(RIG.cameras[0].t) + 0.3))
    rig = msgspec.structs.replace(RIG, cameras=(RIG.cameras[0], beside, *RIG.cameras[2:]))
    seen = SHOWN._replace(tracks=(SHOWN.tracks[0], SHOWN.tracks[0], *SHOWN.tracks[2:]))
    shown_m = [odd_camera._directions(rig, seen, ON_TIME)]
    assert np.isnan(odd_camera._gaps_m(rig, shown_m, (0, 1))).all()
    assert np.isfinite(odd_camera._gaps_m(rig, shown_m, (0, 2))).any()
