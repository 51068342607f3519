"""A scene of a seed: its people and their motions, which never collide."""

from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.bus.messages import MOST_PEOPLE
from common.rig.camera import Rig
from synth.motion.motions import EMPTY, MOTION, Motion
from synth.person.people import Person, person
from synth.person.skeleton import JOINTS
from synth.picture.actors import Part, Thing
from synth.picture.render import room_of
from synth.scene.beats import BEATS, perform_each
from synth.scene.carried import carried
from synth.scene.floor import Ground, ground, inside, least_aside_m, way_out
from synth.scene.plot import Clash, Contact, Plot, touching
from synth.scene.script import Floor, Script, places
from synth.scene.walking import OPENED_S, acted, opening_phase

LEADS: Final = ("mingle", "orbit", "perform", "hug", "hand over", "leave")
"""First beats, in turn by take."""
LEAVING_TAKE: Final = LEADS.index("leave") + 1
"""The first take of several people in which one of them leaves first of all."""
ALONE: Final = ("mingle", "perform", "leave")
"""Those for one person."""
LATE_SHARE: Final = 0.25
"""Share of the scenes in which one person comes in after the opening."""
ROWS_M: Final = 0.4
"""Smallest distance along z of two people in the T-pose, whose arms spread along x."""
BEHIND_M: Final = 0.4
"""Distance behind a wall at which a person is hidden whole."""
CLEAR_M, TOUCHING_M = 0.12, 0.18
"""Smallest distance of any joints of two people; of their trunks while they touch."""
TRUNK: Final = tuple(JOINTS.index(name) for name in ("pelvis", "navel", "neck"))
TRIES: Final = 100
"""Number of scenes tried until bodies keep clear of each other."""
PLACE_TRIES: Final = 50
"""Number of placements of which the one is taken in which people hide each other least."""
BEAT_TRIES: Final = 4
"""Number of tries of one beat until another is taken."""


class SceneSeed(NamedTuple):
    """What a scene is made from: the same seed gives the same scene."""

    people: int
    lasts_s: float
    seed: int
    take: int
    room_seed: int
    opening: bool = True
    """Whether it begins with the empty room and T-poses; False: people are there and move from
    the first frame."""
    postures: tuple[str, ...] = ()
    """What everybody performs again and again at their place, by person, in turn; empty: a random
    plot."""


class Scene(NamedTuple):
    """People in a room."""

    parts: tuple[Part, ...]
    """By person."""
    contacts: tuple[Contact, ...]
    """Who touches whom, and when."""
    things: tuple[Thing, ...]
    """What they carry."""


def scene(wanted: SceneSeed, rig: Rig, fps: float) -> Scene:
    """The people of a scene and their motions.

    Args:
        wanted: Its seed.
        rig: The cameras.
        fps: Frames per second.

    Raises:
        ValueError: When the people do not find room before the cameras.
    """
    people, _, seed, take, room_seed, *_ = wanted
    place = ground(rig, room_of(room_seed, rig))
    cast = [person(100 * seed + MOST_PEOPLE * (take - 1) + n) for n in range(people)]
    for attempt in range(TRIES):
        rng = np.random.default_rng([seed, take, people, attempt, *b"scene"])
        try:
            plot = _plotted(wanted, place, rng)
            return _played(cast, plot, place, wanted, fps)
        except Clash:
            continue
    raise ValueError(f"{people} people find no room before these cameras: ask for fewer")


def _plotted(wanted: SceneSeed, place: Ground, rng: np.random.Generator) -> Plot:
    """The scripts of a scene, beat after beat.

    Raises:
        Clash: When a beat does not work out.
    """
    plot = _opened(wanted, place, rng)
    if not wanted.opening:
        plot = plot._replace(now_s=0.0)
    if wanted.postures:
        return _performing(plot, wanted)
    leads = LEADS if wanted.people > 1 else ALONE
    lead = leads[(wanted.take - 1) % len(leads)]
    while plot.now_s < wanted.lasts_s:
        if plot.out:
            plot = _continued(plot, ["come in"], place, rng)
            continue
        plot = _continued(plot, [lead, *rng.permutation(leads)], place, rng)
        lead = str(rng.choice([name for name in leads if name != lead]))
    return plot


def _performing(plot: Plot, wanted: SceneSeed) -> Plot:
    """The plot in which everybody performs again and again.

    Raises:
        Clash: When people are missing.
    """
    if plot.out:
        raise Clash("not everybody is there")
    while plot.now_s < wanted.lasts_s:
        plot = perform_each(plot, wanted.postures)
    return plot


def _continued(plot: Plot, names: list[str], place: Ground, rng: np.random.Generator) -> Plot:
    """The plot with the first of some beats that works out.

    Raises:
        Clash: When none does.
    """
    for name in [name for name in names for _ in range(BEAT_TRIES)]:
        try:
            return BEATS[name](plot, place, rng)
        except Clash:
            continue
    raise Clash("no beat works out")


def _opened(wanted: SceneSeed, place: Ground, rng: np.random.Generator) -> Plot:
    """Everybody in a row of their own for the T-pose, whose arms spread along the rows; who finds
    no row, and sometimes one more, comes in later. Who performs again and again stays there, so
    that they hide each other as little as can be."""
    if not wanted.postures:
        return _rowed(wanted.people, LATE_SHARE, place, rng)
    found = [_rowed(wanted.people, 0.0, place, rng) for _ in range(PLACE_TRIES)]
    return max(found, key=lambda plot: least_aside_m(place, _starts(plot)))


def _starts(plot: Plot) -> Floor:
    """(n, 2) first places of those who are there."""
    return np.array([plot.scripts[who].start_m for who in plot.there])


def _rowed(people: int, late_share: float, place: Ground, rng: np.random.Generator) -> Plot:
    """Everybody in a random row; a share of the scenes lacks one person."""
    depths_m = np.unique(place.opening_m[:, 1])
    rows = int(np.ptp(depths_m) / ROWS_M) + 1
    early = min(rows, people - int(people > 1 and rng.random() < late_share))
    spare_m = np.ptp(depths_m) - ROWS_M * (early - 1)
    at_m = depths_m[0] + ROWS_M * np.arange(early) + np.sort(rng.uniform(0.0, spare_m, early))
    starts = []
    for row_m in rng.permutation(at_m):
        nearest = depths_m[np.abs(depths_m - row_m).argmin()]
        starts.append(rng.choice(place.opening_m[place.opening_m[:, 1] == nearest]))
    door = way_out(place, place.places_m.mean(axis=0))
    starts += [door] * (people - early)
    out = frozenset(range(early, people))
    return Plot(tuple(Script(start) for start in starts), OPENED_S, out)


def _played(cast: list[Person], plot: Plot, place: Ground, wanted: SceneSeed, fps: float) -> Scene:
    """The motions of a plot.

    Raises:
        Clash: When bodies come too close.
    """
    parts = []
    for someone, script in zip(cast, plot.scripts, strict=True):
        phase = _phases(script, place, wanted, fps)
        parts.append(Part(someone, acted(someone, script, phase, fps, wanted.take)))
    time_s = np.arange(len(parts[0].motion.phase)) / fps
    for one, other in combinations(range(len(parts)), 2):
        near = touching(plot, (one, other), time_s)
        refuse_collisions(parts[one].motion, parts[other].motion, near)
    things = carried(parts, plot.contacts, fps)
    return Scene(tuple(parts), plot.contacts, things)


def _phases(script: Script, place: Ground, wanted: SceneSeed, fps: float) -> NDArray[np.uint8]:
    """Phase of each frame, (n,); EMPTY while the person is out of the room."""
    count = round(wanted.lasts_s * fps)
    there = inside(place.room, places(script, np.arange(count) / fps), BEHIND_M)
    opens = wanted.opening and bool(there[0])
    phase = opening_phase(count, fps) if opens else np.full(count, MOTION, np.uint8)
    return np.where(there, phase, np.uint8(EMPTY))


def refuse_collisions(one: Motion, other: Motion, near: NDArray[np.bool_]) -> None:
    """Raise where two bodies come too close.

    Args:
        one: A person's motion.
        other: Another's.
        near: (n,) whether they touch on purpose in a frame.

    Raises:
        Clash: Then.
    """
    both = one.present & other.present
    apart = both & ~near
    if least_m(one.joints_m[apart], other.joints_m[apart]) < CLEAR_M:
        raise Clash("limbs collide")
    held = both & near
    if least_m(one.joints_m[held][:, TRUNK], other.joints_m[held][:, TRUNK]) < TOUCHING_M:
        raise Clash("trunks collide")


def least_m(one_m: NDArray[np.float64], other_m: NDArray[np.float64]) -> float:
    """Smallest distance of any two joints in the same frame, (n, joints, 3) each; infinite without
    frames."""
    gaps = np.linalg.norm(one_m[:, :, None] - other_m[:, None], axis=3)
    return float(gaps.min()) if gaps.size else np.inf
