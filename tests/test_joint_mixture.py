"""Where a joint most probably is, held against places that are known."""

from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from integrator.landmarks import joint_mixture
from integrator.landmarks.joint_mixture import (
    HELD,
    OUTLIER_PENALTY,
    PROPOSED,
    ROUNDS,
    SHOWN,
    Evidence,
    Spread,
    most_probable,
)

CENTRES_M = np.array([[0.0, 1.0, 4.0], [-4.0, 1.0, 0.0]])
TRUE_M = np.array([0.1, 1.2, -0.2])
places = st.tuples(st.floats(-1, 1), st.floats(0, 2), st.floats(-1, 1)).map(np.array)


def rays_through(*places_m: np.ndarray) -> np.ndarray:
    along = np.stack(places_m) - CENTRES_M
    return np.asarray(along / np.linalg.norm(along, axis=1, keepdims=True))


def told(
    proposed_m: np.ndarray,
    directions: np.ndarray,
    inlier_probability: float = 0.8,
    inliers: tuple[float, float] = (0.8, 0.8),
    wider_m: float = 0.0,
    others: tuple[np.ndarray, float] | None = None,
    often: float = PROPOSED.often,
) -> Evidence:
    """What is said; `others`: rays to where else the views may see it, and how probably."""
    elsewhere, other = (np.zeros((2, 3)), 0.0) if others is None else others
    return Evidence(
        proposed_m,
        inlier_probability,
        CENTRES_M,
        np.stack([directions, elsewhere], axis=1),
        np.stack([inliers, (other, other)], axis=1),
        np.array([0.02 + wider_m, 0.03, 0.03]),
        PROPOSED.roughly + wider_m,
        often,
        1.75,
    )


def place_of(witnesses: Evidence) -> tuple[np.ndarray, float, np.ndarray]:
    place_m, precision = np.empty(3), np.empty(6)
    return place_m, most_probable(witnesses, place_m, precision), precision


@given(places)
def test_witnesses_who_agree_are_believed(true_m: np.ndarray) -> None:
    place_m, _, _ = place_of(told(true_m, rays_through(true_m, true_m)))
    assert np.linalg.norm(place_m - true_m) < 1e-6


def test_two_rays_that_meet_outvote_a_proposal_that_is_far_away() -> None:
    place_m, _, _ = place_of(told(TRUE_M + 0.4, rays_through(TRUE_M, TRUE_M)))
    assert np.linalg.norm(place_m - TRUE_M) < 0.02


def test_a_doubted_proposal_with_one_ray_is_outvoted_by_two_rays_that_meet() -> None:
    """A wrist 0.4 m away, through which the other ray of one view leads too: an exchanged side."""
    wrong_m = TRUE_M + np.array([0.3, 0.05, 0.25])
    others = rays_through(wrong_m, wrong_m)
    along = rays_through(TRUE_M, TRUE_M)
    exchanged = np.stack([along[0], others[1]])
    for often, believed in ((PROPOSED.often, False), (0.05, True)):
        _, own, _ = place_of(told(wrong_m, along, 0.01, often=often))
        _, other, _ = place_of(told(wrong_m, exchanged, 0.01, often=often))
        assert (own > other) == believed


def test_a_ray_that_leads_elsewhere_does_not_pull() -> None:
    elsewhere = TRUE_M - np.array([0.0, 0.5, 0.0])
    place_m, _, _ = place_of(told(TRUE_M, rays_through(TRUE_M, elsewhere)))
    assert np.linalg.norm(place_m - TRUE_M) < 0.005


def test_where_a_view_may_see_it_too_is_believed_if_all_else_agrees() -> None:
    """One view shows the other arm first; its second place, the other view and outlines agree."""
    true = rays_through(TRUE_M, TRUE_M)
    wrong = rays_through(TRUE_M, TRUE_M + np.array([0.0, 0.4, 0.1]))
    proposed_m = TRUE_M + np.array([0.06, 0.1, 0.06])
    first, others = np.stack([true[0], wrong[1]]), np.stack([wrong[0], true[1]])
    found, plain = (
        np.linalg.norm(
            place_of(told(proposed_m, first, 0.3, (0.6, 0.6), others=(others, sure)))[0] - TRUE_M
        )
        for sure in (0.2, 0.0)
    )
    assert found < 0.02
    assert found < 0.5 * plain


def test_where_a_view_may_see_it_too_counts_for_nothing_beside_those_who_agree() -> None:
    rays = rays_through(TRUE_M, TRUE_M)
    others = rays_through(TRUE_M + 0.3, TRUE_M + 0.3), 0.15
    place_m, _, _ = place_of(told(TRUE_M, rays, others=others))
    assert np.linalg.norm(place_m - TRUE_M) < 0.005


def test_a_proposal_that_is_unsure_gives_way_across_a_sure_ray_and_keeps_its_depth() -> None:
    proposed_m = TRUE_M + np.array([0.15, 0.0, 0.0])
    rays = rays_through(TRUE_M, TRUE_M)
    place_m, _, _ = place_of(told(proposed_m, rays, inlier_probability=0.2, inliers=(0.9, 0.0)))
    off = place_m - proposed_m
    assert off @ rays[0] < 0.05
    assert np.linalg.norm(np.cross(place_m - CENTRES_M[0], rays[0])) < 0.03


def test_a_proposal_that_is_held_more_loosely_gives_way_further() -> None:
    proposed_m = TRUE_M + np.array([0.15, 0.0, 0.0])
    rays = rays_through(TRUE_M, TRUE_M)
    off_m = []
    for wider_m in (0.0, 0.2):
        place_m, _, _ = place_of(told(proposed_m, rays, 0.2, (0.6, 0.0), wider_m))
        off_m.append(np.linalg.norm(np.cross(place_m - CENTRES_M[0], rays[0])))
    assert off_m[1] < 0.6 * off_m[0]


def test_agreement_is_more_probable_and_held_more_tightly() -> None:
    _, agreed, tight = place_of(told(TRUE_M, rays_through(TRUE_M, TRUE_M)))
    apart = rays_through(TRUE_M + 0.3, TRUE_M - 0.3)
    _, disputed, loose = place_of(told(TRUE_M, apart))
    assert agreed > disputed
    assert tight[[0, 3, 5]].sum() > loose[[0, 3, 5]].sum()


@given(places, places, places)
def test_the_place_is_never_beyond_what_was_said(
    proposed_m: np.ndarray, first_m: np.ndarray, second_m: np.ndarray
) -> None:
    """Finite whatever is said, and in the room in which it was said."""
    place_m, value, precision = place_of(told(proposed_m, rays_through(first_m, second_m)))
    assert np.isfinite(place_m).all()
    assert np.isfinite(value)
    assert np.isfinite(precision).all()
    assert np.abs(place_m).max() < 4.0


def bell(square: float, spread_m: float, axes: int) -> float:
    return float(np.exp(-square / (2 * spread_m**2)) / spread_m**axes)


def anywhere(roughly_m: float, unlikely: float, often: float, kind: Spread, axes: int) -> float:
    beyond = unlikely * (1 - often) / (kind.far * roughly_m) ** axes
    return float(beyond * np.exp(-OUTLIER_PENALTY * often / kind.often)) + 1e-30


def weighed(w: Evidence, here: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Log probability of a place, and normal equations, by matrices."""
    square, unlikely = float(np.square(here - w.proposed_m).sum()), 1 - w.inlier_probability
    right = w.inlier_probability * bell(square, w.spreads_m[0], 3)
    rough = unlikely * w.often * bell(square, w.roughly_m, 3)
    total = right + rough + anywhere(w.roughly_m, unlikely, w.often, PROPOSED, 3)
    weight = (right / w.spreads_m[0] ** 2 + rough / w.roughly_m**2) / total + HELD
    normal, side, log = weight * np.eye(3), weight * w.proposed_m, np.log(total)
    for view in range(2):
        sure, other = w.inliers[view]
        if sure <= 0.0:
            continue
        spread_m, roughly_m = w.spreads_m[1 + view], SHOWN.roughly * w.stature_m
        across = [np.eye(3) - np.outer(along, along) for along in w.directions[view]]
        centre_m = w.centres_m[view]
        first, second = (float((here - centre_m) @ each @ (here - centre_m)) for each in across)
        unlikely = 1 - sure - other
        right = sure * bell(first, spread_m, 2)
        rough = unlikely * SHOWN.often * bell(first, roughly_m, 2)
        elsewhere = other * bell(second, spread_m, 2)
        total = right + rough + elsewhere + anywhere(roughly_m, unlikely, SHOWN.often, SHOWN, 2)
        weights = (right / spread_m**2 + rough / roughly_m**2, elsewhere / spread_m**2)
        for each, pull in zip(across, weights, strict=True):
            normal = normal + pull / total * each
            side = side + pull / total * each @ centre_m
        log += np.log(total)
    return float(log), normal, side


def starts(w: Evidence) -> Iterator[np.ndarray]:
    """The proposed place, those nearest to it on each ray, and where rays of both views meet."""
    yield w.proposed_m
    rays = [[(w.centres_m[v], w.directions[v, r]) for r in range(2) if w.inliers[v, r] > 0]
            for v in range(2)]  # fmt: skip
    for centre_m, along in (*rays[0], *rays[1]):
        yield centre_m + (w.proposed_m - centre_m) @ along * along
    for (one_m, one), (two_m, two) in product(*rays):
        along = np.linalg.lstsq(np.stack([one, -two], axis=1), two_m - one_m, rcond=None)[0]
        yield (one_m + along[0] * one + two_m + along[1] * two) / 2


def expected_place(w: Evidence) -> tuple[np.ndarray, float, np.ndarray]:
    found = []
    for start in starts(w):
        here = start
        for _ in range(ROUNDS):
            _, normal, side = weighed(w, here)
            here = np.linalg.solve(normal, side)
        log, normal, _ = weighed(w, here)
        found.append((log, here, normal[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]))
    log, here, precision = max(found, key=lambda each: each[0])
    return here, log, precision


@pytest.mark.parametrize("seed", range(12))
def test_the_place_is_the_highest_peak_that_climbing_from_all_witnesses_finds(seed: int) -> None:
    """Plain numpy, for witnesses that are some centimetres to decimetres off each other."""
    rng = np.random.default_rng(seed)
    spread_m = (0.01, 0.05, 0.3)[seed % 3]
    shown = rays_through(*(TRUE_M + rng.normal(0.0, spread_m, (2, 3))))
    elsewhere = rays_through(*(TRUE_M + rng.normal(0.0, 2 * spread_m, (2, 3))))
    inliers = ((0.7, 0.5), (0.7, 0.0), (0.0, 0.6), (0.1, 0.2))[seed % 4]
    w = told(
        TRUE_M + rng.normal(0.0, spread_m, 3), shown, rng.uniform(0.01, 0.9), inliers,
        wider_m=rng.uniform(0.0, 0.02), others=(elsewhere, 0.15 * (seed % 2)),
        often=(0.05, 0.95)[seed % 5 > 1],
    )  # fmt: skip
    w = w._replace(inliers=w.inliers * (w.inliers[:, :1] > 0))
    found, expected = place_of(w), expected_place(w)
    for one, other in zip(found, expected, strict=True):
        assert one == pytest.approx(other, rel=1e-6, abs=1e-7)


def test_views_that_look_along_one_line_do_not_meet() -> None:
    """The second camera stands behind the first: where both rays are one, no place is between."""
    along = (TRUE_M - CENTRES_M[0]) / np.linalg.norm(TRUE_M - CENTRES_M[0])
    w = told(TRUE_M, np.stack([along, along]))._replace(
        centres_m=np.stack([CENTRES_M[0], CENTRES_M[0] - along])
    )
    place_m, log, _ = place_of(w)
    assert np.isfinite(log)
    assert place_m == pytest.approx(TRUE_M)


def test_the_surer_a_witness_the_narrower_is_its_spread() -> None:
    spread = Spread(right=0.01, unsure=0.05, roughly=0.1, often=0.5, far=8)
    assert spread.right_of(np.array([1.0, 0.5, 0.0])) == pytest.approx([0.01, 0.035, 0.06])


@pytest.mark.parametrize(("views", "starts"), [(1, 3), (2, 9), (3, 19), (4, 13), (8, 25)], ids=str)
def test_starts_are_as_many_as_the_views_and_not_as_their_pairs(views: int, starts: int) -> None:
    """The proposal, each ray, and two rays: of up to three views any, of more neighbours' first."""
    taken = np.full(views, joint_mixture.NONE)
    found = [tuple(taken.tolist())]
    while joint_mixture._next(taken):
        found.append(tuple(taken.tolist()))
    assert len(found) == len({*found}) == starts
    assert found == sorted(found), "the last view's ray changes first"
    two = [one for one in found if sum(ray != joint_mixture.NONE for ray in one) == 2]
    neighbours = [
        tuple(0 if n in (view, (view + 1) % views) else -1 for n in range(views))
        for view in range(views)
    ]
    assert views <= joint_mixture.EACH_TWO or sorted(two) == sorted(neighbours)
