"""The body before it is measured, held against people whose stature is known (T4)."""

import numpy as np
import pytest
from posing import posed
from rolling import BODY, ROLLED, outlines, person_in
from staging import PERSON, RIG, observation, silhouettes, standing

from common.body.body import Vector
from common.body.proportions import stature, thesis_bdp
from integrator.measuring.prior_body import _crown_m, prior


@pytest.mark.parametrize("views", [(0, 1), (0,), (1,)], ids=["both", "1", "2"])
@pytest.mark.parametrize("stature_m", [1.5, 1.9])
def test_the_prior_is_as_high_as_the_silhouettes(views: tuple[int, ...], stature_m: float) -> None:
    """T4: the thesis's proportions."""
    pose = standing()
    pose[1] *= stature_m / 1.75
    both = silhouettes(pose, thesis_bdp(stature_m))
    roots = [(80.0, 60.0 + (1.0 - pose[1]) * 50.0)] * 2
    seen = [observation(both[n], root_px=roots[n]) if n in views else None for n in (0, 1)]
    body = prior(RIG, (seen[0], seen[1]))
    assert stature(body) == pytest.approx(stature_m, abs=0.06)
    assert body.torso.height / stature(body) == pytest.approx(52 / 175)


@pytest.mark.parametrize("place_m", [(0.8, 0.5), (-0.5, -1.0), (0.0, -1.2)])
@pytest.mark.parametrize("view", [0, 1])
def test_one_view_alone_measures_whoever_stands_nearer_or_farther_alike(
    view: int, place_m: tuple[float, float]
) -> None:
    """T4: the floor, which the camera knows, tells how far away they are."""
    mask = silhouettes(standing(place_m))[view]
    told_of = observation(mask, root_px=(80.0, 60.0))
    found = prior(RIG, (told_of, None) if view == 0 else (None, told_of))
    assert stature(found) == pytest.approx(stature(PERSON), abs=0.06)


@pytest.mark.parametrize(("rows", "stature_m"), [(20, 0.8), (100, 2.3)])
def test_a_prior_is_somebody(rows: int, stature_m: float) -> None:
    """0.8 to 2.3 m: what is beyond is not the whole person."""
    mask = np.zeros((120, 160), np.bool_)
    mask[100 - rows : 100, 70:90] = True
    body = prior(RIG, (observation(mask, root_px=(80.0, 60.0)), None))
    assert stature(body) == pytest.approx(stature_m)


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
    found = prior(ROLLED, (person_in(spoilt[0]), person_in(spoilt[1])))
    assert stature(found) == pytest.approx(stature(BODY), abs=0.05)


def test_what_goes_on_above_a_picture_is_no_crown() -> None:
    """A lamp hangs over the person in view 1: view 2 alone tells how high they are."""
    first, second = outlines(_stretched())
    columns = np.flatnonzero(first[: first.any(axis=1).argmax() + 5].any(axis=0))
    first[: first.any(axis=1).argmax() + 5, columns[0] : columns[-1]] = True
    found = prior(ROLLED, (person_in(first), person_in(second)))
    assert stature(found) == pytest.approx(stature(BODY), abs=0.08)


def _stretched() -> Vector:
    pose = posed(r_shoulder_z=90.0, l_shoulder_z=270.0)
    pose[1] = BODY.r_upper_leg.height + BODY.r_lower_leg.height
    return pose


@pytest.mark.parametrize(
    ("place", "is_known"),
    [
        ((1, 40), True),
        ((158, 40), True),
        ((80, 1), True),
        ((0, 40), False),
        ((159, 40), False),
        ((80, 0), False),
    ],
)
def test_a_crown_at_the_border_of_a_picture_may_go_on_beyond_it(
    place: tuple[int, int], is_known: bool
) -> None:
    """160 x 120: the highest pixel of view 1 is at a column and row; below it there are more."""
    column, row = place
    one, other = np.zeros((120, 160), bool), np.zeros((120, 160), bool)
    one[row, column] = one[100, 80] = True
    other[30:100, 70:80] = True
    other[30, 71:80] = False
    seen = person_in(one), person_in(other)
    crown_m = _crown_m(RIG, seen, np.array([0.0, 1.0, 0.0]))
    assert np.isfinite(crown_m) == is_known
