"""From any number of views of a person to a calibration: pairs, then all of them at once."""

from itertools import combinations
from typing import Final

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from calibration.person.independent_moments import measured_worth
from calibration.person.many_fit import ManyFit, Pairs, many_fitted, many_misfits, many_sides
from calibration.person.many_guess import Layout, Pair, chained, pinholes_of
from calibration.person.many_quality import quality_of, seen_by
from calibration.person.person_calibration import calibrated_by_person
from calibration.person.rig_evidence import Evidence, Known, gathered, own_moments
from calibration.person.rig_quality import PersonCalibration
from calibration.person.rig_starts import known_of, with_clocks
from calibration.person.world_axes import origin_of
from calibration.tracks import person_prior as prior
from calibration.tracks.camera_clocks import Clocks, clock_between
from calibration.tracks.joint_tracks import Sightings
from calibration.tracks.lateness import UNSEEN, Clock
from calibration.tracks.rig_guess import BODY, rig_of
from common.body.body import Vector
from common.rig.rig_file import CalibrationError

MOST_PAIRED: Final = 4
"""Cameras up to which each two are calibrated as a pair; of more, each with the NEIGHBOURS ones
that follow it in the order of the cameras."""
NEIGHBOURS: Final = 3
AT_FIRST: Final = 15
"""Number of moments used to place the person at first."""
FEW: Final = 24
"""Number of moments of each pair used to choose the start."""

Found = dict[Pair, PersonCalibration]


def calibrated_by_all(
    films: tuple[Sightings, ...],
    stature_m: float,
    fov_deg: float | None,
    clocks: tuple[Clocks, ...],
) -> PersonCalibration:
    """Find all cameras from clips of one rig and one person.

    Args:
        films: All views of each clip.
        stature_m: The person's stature: it gives the scale.
        fov_deg: Field of view of the cameras, where it is known.
        clocks: In each clip, the clock of each view after the first.

    Raises:
        CalibrationError: When too little of a person is seen, or the views fit no rig.
    """
    count = len(films[0].tracks)
    if count == 2:
        pairs = tuple(film.pair(0, 1) for film in films)
        return calibrated_by_person(pairs, stature_m, fov_deg, tuple(own[0] for own in clocks))
    found = _by_pairs(films, stature_m, fov_deg, clocks)
    layout = Layout(count, len(films))
    known = known_of(films[0].size_px[0], stature_m, len(films), fov_deg)
    data = {pair: _evidence(films, pair, known, one) for pair, one in found.items()}
    freed = many_fitted(_start(layout, found, data), layout, _by_time(data), 2, 12)
    worth = {
        pair: evidence._replace(worth=measured_worth(seen_by(layout, freed, pair, data)))
        for pair, evidence in data.items()
    }
    fit = many_fitted(freed.guess, layout, worth, 2, 12)
    return _published(layout, fit, worth, films, clocks)


def _by_pairs(
    films: tuple[Sightings, ...],
    stature_m: float,
    fov_deg: float | None,
    clocks: tuple[Clocks, ...],
) -> Found:
    """The calibrations of pairs, of which each camera has one at least.

    Raises:
        CalibrationError: When a camera has none that leads to camera 1.
    """
    found: Found = {}
    why: dict[int, str] = {}
    for one, other in _pairs(len(films[0].tracks)):
        between = tuple(clock_between(own, one, other) or UNSEEN for own in clocks)
        pair = tuple(film.pair(one, other) for film in films)
        try:
            found[one, other] = calibrated_by_person(pair, stature_m, fov_deg, between)
        except CalibrationError as error:
            why |= {one: str(error), other: str(error)}
    for number, way in enumerate(_ways(found, len(films[0].tracks), 0)[1:], start=1):
        if way is None:
            raise CalibrationError(f"camera {number + 1}: {why.get(number, 'it shows too little')}")
    return found


def _pairs(count: int) -> list[Pair]:
    """The pairs to be calibrated."""
    near = count if count <= MOST_PAIRED else NEIGHBOURS
    every = combinations(range(count), 2)
    return [pair for pair in every if min(pair[1] - pair[0], count - pair[1] + pair[0]) <= near]


def _ways(found: Found, count: int, root: int) -> list[list[Pair] | None]:
    """For each camera the surest pairs that lead to it from a root; None where none do."""
    errors = np.zeros((count, count))
    for (one, other), calibration in found.items():
        errors[one, other] = errors[other, one] = _error(calibration)
    _, before = dijkstra(csr_array(errors), indices=root, return_predecessors=True)
    ways: list[list[Pair] | None] = []
    for number in range(count):
        way, at = [], number
        while at != root and before[at] >= 0:
            way.append((int(before[at]), at))
            at = int(before[at])
        ways.append(way[::-1] if at == root else None)
    return ways


def _error(calibration: PersonCalibration) -> float:
    """Variance of a pair's turn, square degrees."""
    return 1e-6 + sum(
        error_deg**2
        for camera in calibration.quality.cameras
        for error_deg in camera.turn_error_deg
    )


def _evidence(
    films: tuple[Sightings, ...], pair: Pair, known: Known, found: PersonCalibration
) -> Evidence:
    clocks = tuple(Clock(late_s) for late_s in found.late_s)
    return gathered(tuple(film.pair(*pair) for film in films), with_clocks(known, clocks))


def _start(layout: Layout, found: Found, pairs: Pairs) -> Vector:
    """The chain of pairs that explains all best: one from each camera, by its surest ways."""
    few = {pair: evidence.thinned(FEW) for pair, evidence in pairs.items()}
    rigs = {pair: (one.rig, one.late_s) for pair, one in found.items()}
    body = next(iter(pairs.values())).known.mean[BODY]
    trees = [_tree(found, layout.cameras, root) for root in range(layout.cameras)]
    starts = [chained(layout, tree, rigs, body) for tree in trees]
    return min(starts, key=lambda guess: _cost(layout, guess, few))


def _cost(layout: Layout, guess: Vector, pairs: Pairs) -> float:
    sides = many_sides(guess, layout, pairs)
    return float((many_misfits(guess, layout, pairs, sides) ** 2).sum())


def _tree(found: Found, count: int, root: int) -> list[Pair]:
    """The pairs of the ways from a root, in the order from camera 1."""
    edges = {
        tuple(sorted(edge)) for way in _ways(found, count, root) if way is not None for edge in way
    }
    tree: list[Pair] = []
    known = {0}
    while len(known) < count:
        for one, other in sorted(edges):
            if (one in known) != (other in known):
                tree.append((one, other) if one in known else (other, one))
                known |= {one, other}
    return tree


def _by_time(pairs: Pairs) -> Pairs:
    """As if landmarks had no systematic errors."""
    return {
        pair: one._replace(worth=sum(own_moments(clip) for clip in one.clips))
        for pair, one in pairs.items()
    }


def _published(
    layout: Layout,
    fit: ManyFit,
    pairs: Pairs,
    films: tuple[Sightings, ...],
    clocks: tuple[Clocks, ...],
) -> PersonCalibration:
    """The rig in its own world, as that of two cameras, by cameras 1 and 2, and its quality."""
    first = next(pair for pair in sorted(pairs) if pair[0] == 0)
    places = seen_by(layout, fit, first, pairs)[0].met.points_m[:AT_FIRST, prior.PELVIS]
    cameras = pinholes_of(layout, fit.guess)
    origin_m = origin_of((cameras[0], cameras[1]), np.median(places, axis=0))
    rig = rig_of(cameras, films[0].size_px, origin_m)
    late_s = tuple(layout.late(fit.guess)[:, 1:].ravel().tolist())
    told = tuple(clock for own in clocks for clock in own)
    return PersonCalibration(rig, late_s, told, quality_of(layout, fit, pairs, rig))
