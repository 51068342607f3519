"""Universal BDPs, held against a person whose true ones are known (section 4.2)."""

import msgspec
import numpy as np
import pytest
from posing import box_around, posed
from rolling import BODY, ROLLED, outlines, told
from staging import PERSON, RIG, opening, report, silhouettes, standing

from common.body.body import Bdp, Vector
from common.body.proportions import stature, thesis_bdp
from common.bus.messages import Measure, Report
from common.rig.camera import Rig, paper_rig
from integrator import opening_posture as stage
from integrator.opening_posture import Opening, prior
from viewer.paper.measure import measure_front, measure_side

Seen = tuple[Report | None, Report | None]


def measured(rig: Rig = RIG, place_m: tuple[float, float] = (0.0, 0.0)) -> Seen:
    """Both viewers' reports of the opening posture."""
    first, second = silhouettes(opening(place_m), rig=rig)
    front, side = measure_front(first, box_around(first)), measure_side(second, box_around(second))
    return (
        report(1, first, root_px=front.centre_px, measure=front),
        report(2, second, root_px=side.centre_px, measure=side),
    )


def settled(seen: Seen, rig: Rig = RIG, due: int = 1) -> Bdp:
    known = Opening()
    for _ in range(due):
        known, _ = stage.step(known, rig, seen, due)
    assert known.measured
    assert known.bdp is not None
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


def test_the_median_of_the_due_frames_is_taken() -> None:
    """P46: one frame gone wrong of five does not count."""
    good, known = measured(), Opening()
    assert good[0] is not None
    assert good[0].measure is not None
    assert good[0].measure.bdp_px is not None
    odd = msgspec.structs.replace(good[0].measure, bdp_px=good[0].measure.bdp_px.scaled(2.0))
    wrong: Seen = (msgspec.structs.replace(good[0], measure=odd), good[1])
    for i, seen in enumerate([good, wrong, good, good, good]):
        assert not known.measured
        known, place = stage.step(known, RIG, seen, 5)
        assert (place is not None) == (i == 4)
    assert known.bdp == settled(good)


def test_frames_without_both_measures_tell_nothing() -> None:
    """P46: the body is the prior meanwhile."""
    good = measured()
    bare: Seen = tuple(  # type: ignore[assignment]
        None if each is None else msgspec.structs.replace(each, measure=None) for each in good
    )
    known = Opening()
    for seen in [bare, (good[0], None), (None, good[1])]:
        known, place = stage.step(known, RIG, seen, 1)
        assert place is None
    assert not known.measured
    assert not known.under_way
    assert known.bdp is not None
    assert stature(known.bdp) == pytest.approx(1.75, abs=0.1)


def test_a_posture_that_is_broken_off_begins_afresh() -> None:
    """P10, P46: five frames are due; four between do not break it off, five do."""
    good, nothing = measured(), (None, None)
    for between, kept in ((4, True), (5, False)):
        known, _ = stage.step(Opening(), RIG, good, 5)
        assert known.under_way
        for _ in range(between):
            known, _ = stage.step(known, RIG, nothing, 5)
        assert known.under_way == kept


def test_once_measured_it_stays() -> None:
    good = measured()
    known, _ = stage.step(Opening(), RIG, good, 1)
    taller = measured(paper_rig((160, 120), (230.0, 230.0), (4.0, 4.0)))
    assert stage.step(known, RIG, taller, 1) == (known, None)


def test_the_place_of_the_opening_posture_is_where_it_was_taken() -> None:
    """P45: the reference of the scaling factors."""
    known, place = stage.step(Opening(), RIG, measured(place_m=(0.3, -0.4)), 1)
    assert place is not None
    assert known.measured_at_m[::2] == pytest.approx((0.3, -0.4), abs=0.06)
    assert known.measured_at_m == pytest.approx(tuple(place))


@pytest.mark.parametrize("views", [(0, 1), (0,), (1,)], ids=["both", "1", "2"])
@pytest.mark.parametrize("stature_m", [1.5, 1.9])
def test_the_prior_is_as_high_as_the_silhouettes(views: tuple[int, ...], stature_m: float) -> None:
    """T4: the thesis's proportions."""
    pose = standing()
    pose[1] *= stature_m / 1.75
    both = silhouettes(pose, thesis_bdp(stature_m))
    roots = [(80.0, 60.0 + (1.0 - pose[1]) * 50.0)] * 2
    seen = [report(n + 1, both[n], root_px=roots[n]) if n in views else None for n in (0, 1)]  # type: ignore[arg-type]
    body = prior(RIG, (seen[0], seen[1]))
    assert stature(body) == pytest.approx(stature_m, abs=0.06)
    assert body.torso.height / stature(body) == pytest.approx(52 / 175)


@pytest.mark.parametrize(("rows", "stature_m"), [(20, 0.8), (118, 2.3)])
def test_a_prior_is_somebody(rows: int, stature_m: float) -> None:
    """0.8 to 2.3 m: what is beyond is not the whole person."""
    mask = np.zeros((120, 160), np.bool_)
    mask[1 : 1 + rows, 70:90] = True
    body = prior(RIG, (report(1, mask, root_px=(80.0, 60.0)), None))
    assert stature(body) == pytest.approx(stature_m)


def test_legs_reach_the_floor() -> None:
    """A silhouette's lowest row is the toes, some 50 mm below the soles in the picture."""
    good = measured()
    body, place = settled(good), stage.step(Opening(), RIG, good, 1)[1]
    assert place is not None
    assert body.r_upper_leg.height + body.r_lower_leg.height == pytest.approx(float(place[1]))
    assert isinstance(good[0] and good[0].measure, Measure)


@pytest.mark.parametrize("to_the_border", [(), (0,), (0, 1)], ids=["no view", "1", "both"])
def test_the_crown_tells_the_stature_where_the_outline_goes_on_below_the_feet(
    to_the_border: tuple[int, ...],
) -> None:
    """A slab on the floor before the person, seen from above by rolled cameras."""
    spoilt = []
    for n, mask in enumerate(outlines(_stretched())):
        rows, columns = np.nonzero(mask)
        lowest, middle = rows.max(), int(np.median(columns))
        end = len(mask) if n in to_the_border else lowest + 14
        mask[lowest - 10 : end, middle - 15 : middle + 15] = True
        spoilt.append(mask)
    found = prior(ROLLED, (told(1, spoilt[0]), told(2, spoilt[1])))
    assert stature(found) == pytest.approx(stature(BODY), abs=0.05)


def test_what_goes_on_above_a_picture_is_no_crown() -> None:
    """A lamp hangs over the person in view 1: view 2 alone tells how high they are."""
    first, second = outlines(_stretched())
    columns = np.flatnonzero(first[: first.any(axis=1).argmax() + 5].any(axis=0))
    first[: first.any(axis=1).argmax() + 5, columns[0] : columns[-1]] = True
    found = prior(ROLLED, (told(1, first), told(2, second)))
    assert stature(found) == pytest.approx(stature(BODY), abs=0.08)


def _stretched() -> Vector:
    pose = posed(r_shoulder_z=90.0, l_shoulder_z=270.0)
    pose[1] = BODY.r_upper_leg.height + BODY.r_lower_leg.height
    return pose
