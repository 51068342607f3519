"""Universal BDPs, held against a person whose true ones are known (section 4.2)."""

import math

import msgspec
import numpy as np
import pytest
from posing import box_around
from staging import NAVEL_M, PERSON, RIG, observation, opening, silhouettes

from common.body.body import Bdp, Elliptic
from common.body.observation import Measure, Observation
from common.body.proportions import stature, thesis_bdp
from common.method import DEFAULT, PAPER
from common.rig.camera import Camera, Rig, as_matrix, as_row, paper_rig
from integrator.measuring import opening_posture as stage
from integrator.measuring.known_body import Known, Measured, Opening, Unknown, Unmeasured
from integrator.measuring.opening_posture import LEG_KEPT, universal_bdp
from viewer.paper.measure import measure_front, measure_side

Seen = tuple[Observation | None, Observation | None]


def measured(rig: Rig = RIG, place_m: tuple[float, float] = (0.0, 0.0)) -> Seen:
    """Both viewers' reports of the opening posture."""
    first, second = silhouettes(opening(place_m), rig=rig)
    front, side = measure_front(first, box_around(first)), measure_side(second, box_around(second))
    return (
        observation(first, root_px=front.centre_px, measure=front),
        observation(second, root_px=side.centre_px, measure=side),
    )


def looking_from(deg: float, rise_m: float = 0.0) -> Rig:
    """Cameras 4 m from the person, the second so far round them to camera 1's left, looking down
    from so much above their navel."""
    cameras = []
    for n, way in enumerate((0.0, math.radians(deg))):
        centre = np.array([-4.0 * math.sin(way), 1.0 + rise_m, 4.0 * math.cos(way)])
        ahead = np.array([0.0, 1.0, 0.0]) - centre
        ahead /= np.linalg.norm(ahead)
        right = np.array([math.cos(way), 0.0, math.sin(way)])
        R = np.stack([right, np.cross(ahead, right), ahead])
        K = RIG.cameras[n].K
        cameras.append(Camera(f"cam{n + 1}", K, as_matrix(R), as_row(-R @ centre)))
    return msgspec.structs.replace(RIG, cameras=tuple(cameras))


def settled(seen: Seen, rig: Rig = RIG, due: int = 1) -> Bdp:
    known: Opening = Unknown()
    for _ in range(due):
        known, _ = stage.step(known, rig, seen, due, DEFAULT)
    assert isinstance(known, Measured)
    return known.bdp


def test_the_same_person_has_the_same_body_wherever_camera_2_stands() -> None:
    """P46: r_t = t2 / t1 takes the trunk's depth into viewer 1's scale, within a pixel."""
    bodies = []
    for distance_2_m in (4.0, 2.4, 8.0):
        rig = paper_rig((160, 120), (200.0, 160.0), (4.0, distance_2_m))
        bodies.append(settled(measured(rig), rig))
    pixel_m = 4.0 / 200.0
    for body in bodies:
        assert body.torso.short_radius == pytest.approx(bodies[0].torso.short_radius, abs=pixel_m)
        assert body.torso.short_radius == pytest.approx(PERSON.torso.short_radius, abs=2 * pixel_m)
        assert body.torso.long_radius == pytest.approx(PERSON.torso.long_radius, abs=pixel_m)
        assert stature(body) == pytest.approx(stature(PERSON), abs=3 * pixel_m)


@pytest.mark.parametrize("place_m", [(0.0, 0.0), (0.3, 0.4), (-0.3, -0.5)])
def test_the_same_person_has_the_same_body_wherever_it_stands(
    place_m: tuple[float, float],
) -> None:
    """P44-P46: metres, not pixels, come of it."""
    body = settled(measured(place_m=place_m))
    assert stature(body) == pytest.approx(stature(PERSON), rel=0.05)
    arm = body.r_upper_arm.height + body.r_lower_arm.height
    assert arm == pytest.approx(0.6 + 0.05, abs=0.08)  # 25 + 35 of 175, and the round end


@pytest.mark.parametrize("deg", [65.0, 95.0, 115.0])
@pytest.mark.parametrize("rise_m", [0.0, 1.0])
def test_a_rig_of_another_kind_tells_the_same_body_and_where_its_navel_is(
    deg: float, rise_m: float
) -> None:
    """Camera 2 tells no row of the navel: the top of its silhouette is none."""
    rig = looking_from(deg, rise_m)
    known, place = stage.step(Unknown(), rig, measured(rig), 1, DEFAULT)
    assert place is not None
    assert stature(known.bdp) == pytest.approx(stature(PERSON), rel=0.05)
    assert place.tolist() == pytest.approx([0.0, NAVEL_M, 0.0], abs=0.12)


@pytest.mark.parametrize("deg", [0.5, 15.0, 45.0, 165.0, 180.0])
def test_where_camera_2_sees_no_flank_nothing_is_measured(deg: float) -> None:
    rig = looking_from(deg)
    known, place = stage.step(Unknown(), rig, measured(rig), 1, DEFAULT)
    assert (type(known), known.under_way, place) == (Unmeasured, False, None)


def test_the_median_of_the_due_frames_is_taken() -> None:
    """P46: one frame gone wrong of five does not count."""
    good = measured()
    known: Opening = Unknown()
    assert good[0] is not None
    assert good[0].measure is not None
    assert good[0].measure.bdp_px is not None
    odd = msgspec.structs.replace(good[0].measure, bdp_px=good[0].measure.bdp_px.scaled(2.0))
    wrong: Seen = (msgspec.structs.replace(good[0], measure=odd), good[1])
    for i, seen in enumerate([good, wrong, good, good, good]):
        assert not isinstance(known, Measured)
        known, place = stage.step(known, RIG, seen, 5, DEFAULT)
        assert (place is not None) == (i == 4)
    assert known.bdp == settled(good)


def test_frames_without_both_measures_tell_nothing() -> None:
    """P46: the body is the prior meanwhile."""
    good = measured()
    bare: Seen = tuple(  # type: ignore[assignment]
        None if each is None else msgspec.structs.replace(each, measure=None) for each in good
    )
    known: Known = Unmeasured(stage.step(Unknown(), RIG, bare, 1, DEFAULT)[0].bdp)
    for seen in [(good[0], None), (None, good[1])]:
        known, place = stage.step(known, RIG, seen, 1, DEFAULT)
        assert place is None
    assert isinstance(known, Unmeasured)
    assert not known.under_way
    assert stature(known.bdp) == pytest.approx(1.75, abs=0.1)


def test_a_posture_that_is_broken_off_begins_afresh() -> None:
    """P10, P46: five frames are due; four between do not break it off, five do."""
    good, nothing = measured(), (None, None)
    for between, kept in ((4, True), (5, False)):
        known, _ = stage.step(Unknown(), RIG, good, 5, DEFAULT)
        assert known.under_way
        for _ in range(between):
            known, _ = stage.step(known, RIG, nothing, 5, DEFAULT)
        assert known.under_way == kept


def test_once_measured_it_stays() -> None:
    good = measured()
    known, _ = stage.step(Unknown(), RIG, good, 1, DEFAULT)
    taller = measured(paper_rig((160, 120), (230.0, 230.0), (4.0, 4.0)))
    assert stage.step(known, RIG, taller, 1, DEFAULT) == (known, None)


def test_the_place_of_the_opening_posture_is_where_it_was_taken() -> None:
    """P45: the reference of the scaling factors."""
    known, place = stage.step(Unknown(), RIG, measured(place_m=(0.3, -0.4)), 1, DEFAULT)
    assert place is not None
    assert isinstance(known, Measured)
    assert known.measured_at_m[::2] == pytest.approx((0.3, -0.4), abs=0.06)
    assert known.measured_at_m == pytest.approx(tuple(place))


def test_legs_reach_the_floor() -> None:
    """A silhouette's lowest row is the toes, some 50 mm below the soles in the picture."""
    good = measured()
    body, place = settled(good), stage.step(Unknown(), RIG, good, 1, DEFAULT)[1]
    assert place is not None
    assert body.r_upper_leg.height + body.r_lower_leg.height == pytest.approx(float(place[1]))
    assert isinstance(good[0] and good[0].measure, Measure)


def test_as_printed_legs_end_where_the_silhouette_does() -> None:
    """P16: legs are 0.6 of what is below the shoulders, wherever the floor is."""
    body = stage.step(Unknown(), RIG, measured(), 1, PAPER)[0].bdp
    legs_m = body.r_upper_leg.height + body.r_lower_leg.height
    assert legs_m == pytest.approx(1.5 * body.torso.height, rel=1e-6)


@pytest.mark.parametrize("distance_2_m", [4.0, 2.0, 7.0])
def test_the_same_person_has_the_same_bdps_wherever_camera_2_stands(distance_2_m: float) -> None:
    """P46: camera 2 at half the distance, whole pixels read: depth within a pixel."""
    truth = thesis_bdp(1.75)
    scale_1, scale_2 = 150.0 / 4.0, 150.0 / distance_2_m
    first = truth.scaled(scale_1)
    unknown = msgspec.structs.replace(first.torso, short_radius=9.9)
    front = Measure(
        height_px=round(1.75 * scale_1),
        centre_px=(80.0, 60.0),
        depth_px=first.torso.long_radius,
        bdp_px=msgspec.structs.replace(first, torso=unknown),
    )
    side = Measure(
        height_px=round(1.75 * scale_2),
        centre_px=(80.0, 60.0),
        depth_px=round(2 * truth.torso.short_radius * scale_2) / 2,
    )
    got = universal_bdp(front, side, scale_1)
    assert np.array(got.lengths()) == pytest.approx(np.array(truth.lengths()), abs=1 / scale_1)
    assert isinstance(got.torso, Elliptic)
    assert got.torso.short_radius != pytest.approx(9.9 / scale_1)


def test_bdps_without_a_facade_are_refused() -> None:
    side = Measure(height_px=66.0, centre_px=(80.0, 60.0), depth_px=5.0)
    with pytest.raises(ValueError, match="did not see the facade"):
        universal_bdp(side, side, 37.5)


@pytest.mark.parametrize("to_floor", [True, False])
@pytest.mark.parametrize("share", [LEG_KEPT[0] + 0.01, LEG_KEPT[1] - 0.01, LEG_KEPT[1] + 0.01, 0.4])
def test_legs_reach_from_the_navel_to_the_floor_where_legs_could(
    to_floor: bool, share: float
) -> None:
    """Both halves of both alike; the paper leaves them as the silhouette has them."""
    navel_m = 2 * share * PERSON.r_upper_leg.height
    known = Unmeasured(PERSON, bodies=(PERSON,) * 3, places_m=((0.1, navel_m, -0.2),) * 3)
    method = msgspec.structs.replace(DEFAULT, legs_to_floor=to_floor)
    found, place = stage._settled(known, 3, method)
    assert place == pytest.approx([0.1, navel_m, -0.2])
    assert isinstance(found, Measured)
    assert found.measured_at_m == pytest.approx((0.1, navel_m, -0.2))
    fits = to_floor and LEG_KEPT[0] <= share <= LEG_KEPT[1]
    for leg in ("r_upper_leg", "l_upper_leg", "r_lower_leg", "l_lower_leg"):
        own = getattr(PERSON, leg).height
        assert getattr(found.bdp, leg).height == pytest.approx(navel_m / 2 if fits else own)
        assert getattr(found.bdp, leg).long_radius == getattr(PERSON, leg).long_radius
    assert stage._settled(known, 4, method) == (known, None)


def test_a_body_is_measured_anew_by_a_rig_that_is_known_only_now() -> None:
    """The same pictures by cameras twice as far away are of a body twice as large; what a rig
    cannot have seen is left out, and a body that was known before the run is kept."""
    seen = measured()
    known: Opening = Unknown()
    for _ in range(3):
        known, _ = stage.step(known, RIG, seen, 3, PAPER)
    assert isinstance(known, Measured)
    far = paper_rig((160, 120), (200.0, 200.0), (8.0, 8.0))
    found = stage.elsewhere(known, far, 3, PAPER, 1.6)
    assert isinstance(found, Measured)
    assert stature(found.bdp) == pytest.approx(2 * stature(known.bdp), rel=0.02)
    assert isinstance(stage.elsewhere(known, far, 4, PAPER, 1.6), Unmeasured)
    alike = looking_from(10.0)
    assert stage.elsewhere(known, alike, 1, PAPER, 1.6) == Unmeasured(thesis_bdp(1.6))
    before = stage.init(PERSON)
    assert stage.elsewhere(before, far, 3, PAPER, 1.6) == before
