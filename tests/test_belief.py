"""Whether a body is believed, held against bodies that stand, face or fit otherwise."""

import msgspec
import numpy as np
import pytest
from staging import PERIOD_S, RIG, standing

from common.body.body import Vector
from common.body.kinematics import joints
from common.body.observation import Box, Landmarks, Observation
from common.body.proportions import body_vector, thesis_bdp
from common.bus.instant import Instant, TwoSeen
from common.bus.messages import View
from common.rig.camera import project
from integrator.belief import (
    ASTRAY,
    FACES,
    NOWHERE,
    _astray,
    _is_turned_about,
    is_believed,
    is_possible,
    status_of,
    weighed,
)
from integrator.measuring.known_body import Unmeasured
from integrator.person import Following, Posed, Sighting
from integrator.pose import smoothing
from integrator.single.reflection import yaw_deg

BODY = np.asarray(joints(body_vector(thesis_bdp(1.75)), standing()))
FITS = (0.7, 0.7)


def report(n: int, joints_m: np.ndarray, confidence: float = 0.8) -> Observation:
    """What a view tells whose picture shows these joints."""
    camera = RIG.cameras[n]
    seen = Landmarks(
        tuple((float(x), float(y)) for x, y in project(camera, joints_m)),
        (confidence,) * 15,
        yaw_deg(camera, joints_m),
        0.95,
    )
    box = Box(left=60, right=100, top=20, bottom=110)
    return Observation(width=160, height=120, silhouette=b"", box=box, area_px=0, landmarks=seen)


def following(pose: Vector) -> Following:
    """A person of 1.75 m in a pose."""
    smooth = smoothing.init(17, PERIOD_S)
    return Following(Unmeasured(thesis_bdp(1.75)), Posed(pose, ("facade", "flank")), smooth)


def sighting(*seen: Observation | None) -> Sighting:
    views = [
        View(viewer=n, frame=0, captured_s=0.0, clock_s=0.0, width=160, height=120, people=(each,))
        for n, each in enumerate(seen, 1)
        if each is not None
    ]
    return Sighting(Instant(tuple(views)), RIG, RIG, seen, (0, 1), 0.1)


def pair(joints_m: np.ndarray, confidence: float = 0.8) -> TwoSeen:
    return (report(0, joints_m, confidence), report(1, joints_m, confidence))


def moved(x_m: float, z_m: float) -> np.ndarray:
    """The same body elsewhere."""
    return np.asarray(BODY + np.array([x_m, 0.0, z_m]))


def turned() -> np.ndarray:
    """The same body, turned about in its place."""
    return np.asarray((BODY - BODY[0]) * (-1.0, 1.0, -1.0) + BODY[0])


def test_who_stands_before_camera_1_faces_it_and_shows_camera_2_the_flank() -> None:
    assert yaw_deg(RIG.cameras[0], BODY) == pytest.approx(0.0, abs=1.0)
    assert abs(yaw_deg(RIG.cameras[1], BODY)) == pytest.approx(90.0, abs=1.0)
    assert abs(yaw_deg(RIG.cameras[0], turned())) == pytest.approx(180.0, abs=1.0)


def test_a_body_on_its_landmarks_is_believed() -> None:
    assert is_believed(BODY, RIG, pair(BODY), FITS)


def test_a_body_beside_its_landmarks_is_not() -> None:
    """However well it fits an outline: that may be a door's."""
    assert not is_believed(moved(0.6, 0.0), RIG, pair(BODY), (0.9, 0.9))


def test_of_three_views_one_that_sees_it_elsewhere_is_not_enough_two_are() -> None:
    three = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    here, there = report(0, BODY), report(0, moved(0.6, 0.0))
    assert is_believed(BODY, three, (here, report(1, BODY), there), (*FITS, 0.7))
    assert not is_believed(BODY, three, (here, report(1, moved(0.0, 0.6)), there), (*FITS, 0.7))


def test_one_view_that_sees_it_elsewhere_is_enough() -> None:
    seen = (report(0, BODY), report(1, moved(0.0, 0.6)))
    assert not is_believed(BODY, RIG, seen, FITS)


def test_a_body_that_is_turned_about_is_not_believed() -> None:
    """Both outlines fit it as well."""
    assert not is_believed(turned(), RIG, pair(BODY), FITS)


def test_where_landmarks_are_unsure_both_views_must_fit() -> None:
    unsure = pair(moved(0.6, 0.0), 0.35)
    assert is_believed(BODY, RIG, unsure, FITS)
    assert not is_believed(BODY, RIG, unsure, (0.7, 0.4))


def test_without_landmarks_the_better_view_speaks() -> None:
    first, second = (msgspec.structs.replace(report(n, BODY), landmarks=None) for n in (0, 1))
    assert is_believed(BODY, RIG, (first, second), (0.4, 0.1))
    assert not is_believed(BODY, RIG, (first, second), (0.3, 0.3))


def test_a_body_that_both_views_landmarks_bear_out_needs_no_outline() -> None:
    """Clothes of the wall's colour leave rags of it; one view's word alone is not enough."""
    rags = (0.25, 0.25)
    assert is_believed(BODY, RIG, pair(BODY), rags)
    assert not is_believed(BODY, RIG, (report(0, BODY), report(1, BODY, 0.4)), rags)
    assert not is_believed(moved(0.6, 0.0), RIG, pair(BODY), rags)


def test_a_body_that_no_view_shows_anybody_of_is_not_believed_however_it_fits() -> None:
    assert not is_believed(BODY, RIG, pair(BODY, confidence=0.25), FITS)


def test_a_body_of_whom_one_view_shows_a_little_is_believed_where_it_fits() -> None:
    seen = (report(0, BODY, 0.15), report(1, BODY, 0.35))
    assert is_believed(BODY, RIG, seen, FITS)


@pytest.mark.parametrize("share", [0.95, 1.05])
def test_a_body_is_astray_by_how_tall_it_is_in_the_picture(share: float) -> None:
    """Half of the landmarks lie so many of its heights beside it, the others on it."""
    joints_px = project(RIG.cameras[0], BODY)
    tall_px = float(np.linalg.norm(np.ptp(joints_px, axis=0)))
    seen_px = joints_px.copy()
    seen_px[:8, 1] += share * ASTRAY * tall_px
    first, second = pair(BODY)
    assert first is not None
    assert first.landmarks is not None
    beside = msgspec.structs.replace(
        first,
        landmarks=msgspec.structs.replace(
            first.landmarks, joints_px=tuple(map(tuple, seen_px.tolist()))
        ),
    )
    assert beside.landmarks is not None
    found = _astray(BODY, RIG.cameras[0], beside.landmarks)
    assert found == pytest.approx(share * ASTRAY, rel=1e-6)
    assert is_believed(BODY, RIG, (beside, second), FITS) == (share < 1.0)


def test_an_outline_without_landmarks_says_nothing_of_how_somebody_faces() -> None:
    """Nor does a view that is not sure; of two the nearer counts."""
    told = [
        (each.landmarks, camera)
        for each, camera in zip(pair(BODY), RIG.cameras, strict=True)
        if each is not None and each.landmarks is not None
    ]
    assert not _is_turned_about(BODY, told)
    assert _is_turned_about(turned(), told)
    first, (second, camera_2) = told
    assert not _is_turned_about(turned(), [first])
    for confidence, is_turned in ((FACES + 0.01, True), (FACES - 0.01, False)):
        unsure = msgspec.structs.replace(second, facing_confidence=confidence)
        assert _is_turned_about(turned(), [first, (unsure, camera_2)]) == is_turned


def test_a_body_that_is_nowhere_in_a_silhouette_is_believed_where_landmarks_show_it() -> None:
    """A screen that lights up is taken for the person in view 2."""
    unsure = report(0, BODY), report(1, moved(0.6, 0.0), 0.1)
    assert is_believed(BODY, RIG, unsure, (0.7, NOWHERE + 0.01))
    assert not is_believed(BODY, RIG, unsure, (0.7, NOWHERE - 0.01))
    assert is_believed(BODY, RIG, pair(BODY), (0.7, 0.0))
    assert is_believed(BODY, RIG, (report(0, BODY), None), (0.7, 0.0))


def test_of_three_views_one_silhouette_that_is_a_things_takes_no_belief() -> None:
    three = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    thing = report(0, BODY, 0.4)
    assert is_believed(BODY, three, (*pair(BODY), thing), (*FITS, 0.0))
    assert not is_believed(BODY, three, (report(0, BODY), thing, thing), (FITS[0], 0.0, 0.0))


@pytest.mark.parametrize(
    ("on_floor", "sure", "believed"),
    [
        (True, 0.9, True),
        (True, 0.1, False),
        (False, 0.1, True),
    ],
)
def test_a_body_in_the_air_is_possible_where_two_views_show_it_or_no_floor_is_known(
    on_floor: bool, sure: float, believed: bool
) -> None:
    """Someone on a stage, and the ghost of a body of half the size, half way to the camera."""
    pose = standing()
    pose[1] += 1.2
    up_m = BODY + np.array([0.0, 1.2, 0.0])
    seen = report(0, up_m), report(1, up_m, sure)
    assert is_possible(following(pose), sighting(*seen), on_floor=on_floor) == believed


def test_a_body_on_the_floor_is_possible_and_one_with_limbs_of_a_giant_is_not() -> None:
    now = sighting(*pair(BODY))
    assert is_possible(following(standing()), now, on_floor=True)
    giant = following(standing())
    giant = giant._replace(found=giant.found._replace(joints_m=2.2 * BODY))
    assert not is_possible(giant, now, on_floor=True)


def test_instead_of_a_pose_that_no_body_takes_the_one_before_is_carried_on() -> None:
    now, known = sighting(*pair(BODY)), following(standing())
    giant = known._replace(found=known.found._replace(joints_m=2.2 * BODY), ever_confirmed=True)
    after = weighed(giant, now, FITS, PERIOD_S, before=known)
    assert (status_of(after, PERIOD_S), after.found) == ("predicted", known.found)
    first = weighed(giant, now, FITS, PERIOD_S)
    assert status_of(first, PERIOD_S) == "lost"
    again = weighed(first._replace(found=known.found), now, FITS, PERIOD_S, before=first)
    assert status_of(again, PERIOD_S) == "tracking"
