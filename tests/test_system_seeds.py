"""What a seed makes, held against what it made when the shipped networks were trained on it.

A set that can be made again from its seeds is a promise: the networks' cards name seeds, no data.
Each thing is told by three numbers of all its values: a sum in which every value has a weight of
its own, how they spread, and how much neighbours differ. Whoever changes what seeds make trains
the networks again, and writes the numbers of the new sets here.
"""

from collections.abc import Callable, Iterator
from itertools import islice
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lab.training.lifting_examples import lifting_examples
from lab.training.proposal_examples import example_of
from synth.motion import falling, footing, idling, moves, roaming
from synth.motion.idling import IDLE, RETURNS
from synth.motion.motions import POSTURES, Motion, performance, stance
from synth.motion.streaming import streamed
from synth.person import portrait, rings, skeleton, tailor
from synth.person.mesh import body_mesh
from synth.person.people import measure_vector, person, take_style
from synth.person.wardrobe import dressed
from synth.picture import (
    backdrops,
    composites,
    picture_examples,
    raster,
    silhouette_examples,
)
from synth.picture.composites import composite
from synth.picture.example_poses import poses_deg
from synth.picture.exposure import blurred, default_rig, exposures
from synth.picture.mask_flaws import flaw, spoilt
from synth.picture.random_rig import random_rig, rig_about
from synth.picture.render import render
from synth.picture.shown_joints import shown_joints
from synth.picture.synth_room import furnished, lamp_pixels, lit_from
from synth.things.textures import finish, painted

MAKERS = (falling, footing, moves, roaming, portrait, rings, skeleton, tailor, raster)
"""What the others call: a change in one of these is a change of what seeds make, too."""


def numbers_of(thing: Any) -> Iterator[NDArray[np.float64]]:
    """All numbers in it, in order; of a word the codes of its letters."""
    if isinstance(thing, str):
        yield np.frombuffer(thing.encode(), np.uint8).astype(np.float64)
    elif isinstance(thing, dict):
        yield from numbers_of([*thing.items()])
    elif hasattr(thing, "__struct_fields__"):
        yield from numbers_of([getattr(thing, name) for name in thing.__struct_fields__])
    elif isinstance(thing, np.ndarray | int | float | np.number) or thing is None:
        yield np.nan_to_num(np.ravel(np.asarray(-1.0 if thing is None else thing, np.float64)))
    else:
        for one in thing:
            yield from numbers_of(one)


def told(thing: Any) -> tuple[float, float, float]:
    values = np.concatenate([*numbers_of(thing), np.zeros(1)])
    weights = 1.0 + np.modf(np.arange(len(values)) * 0.6180339887)[0]
    steps = np.abs(np.diff(values))
    return (
        float(weights @ values / len(values)),
        float(values.std()),
        float(steps.mean()),
    )


def moved(motion: Motion) -> list[Any]:
    return [motion.joints_m, motion.bones, motion.angles_deg, motion.root_m, motion.phase]


def acts() -> list[Any]:
    """Every posture, and what is none."""
    return [moved(performance(person(1), name, 2)) for name in (*POSTURES, "free", "fall")]


def idle() -> list[Any]:
    someone, rng = person(6), np.random.default_rng(6)
    t = np.linspace(-0.3, 2.9, 33)
    still = stance(someone.style, t)
    ways = [IDLE[name](rng) for name in IDLE] + [idling.stepping_back(name) for name in RETURNS]
    return [way(t, someone.style, still) for way in (*ways, idling.scratching("r"))]


def people() -> list[Any]:
    rng = np.random.default_rng(7)
    everybody = [person(seed) for seed in range(12)]
    takes = [take_style(someone.style, rng) for someone in everybody]
    return [everybody, takes, [measure_vector(someone) for someone in everybody]]


def meshes() -> list[Any]:
    """Of every hair, sleeve and leg."""
    rng = np.random.default_rng(8)
    everybody = [person(3), *(dressed(person(seed), rng) for seed in range(16))]
    assert {someone.look.hair for someone in everybody} == {*portrait.HAIR}
    return [[someone.look, *body_mesh(someone)] for someone in everybody]


def rigs() -> list[Any]:
    rng = np.random.default_rng(9)
    given = [random_rig(rng, 0.5, (2.3, 5.6)) for _ in range(20)]
    return [given, [rig_about(rng, np.array([0.3, 0.9, -0.2])) for _ in range(20)]]


def flaws() -> list[Any]:
    rng, mask = np.random.default_rng(10), np.zeros((120, 160), np.uint8)
    mask[20:110, 60:90] = mask[60:66, 40:120] = 1
    found = [flaw(30, rng) for _ in range(40)]
    return [found, [spoilt(mask, one, i) for one in found for i in (0, 9, 19, 29)]]


def papered() -> list[Any]:
    rng, made = np.random.default_rng(11), []
    low, high = np.array([-1.0, 0.0, -2.0]), np.array([1.5, 2.5, 1.0])
    points = rng.uniform(low, high, (400, 3))
    for n in range(400):
        axis, end = n % 3, (low, high)[n // 3 % 2]
        points[n, axis] = end[axis]
    for kind in (*["room"] * 8, "shelf", "chest", "picture", "curtain", "door"):
        look = finish(kind, rng)
        made += [look, painted(look, points, low, high)]
    return made


def rooms() -> list[Any]:
    """Two rooms, each with its two pictures and its lamps."""
    made: list[Any] = []
    for seed in (3, 4):
        room = furnished(seed, default_rig(40, 30))
        points = np.random.default_rng(seed).uniform((-1.0, 0.0, -1.0), (1.0, 2.0, 1.0), (20, 3))
        made += [room.pictures, room.shadows_px]
        made += [[lit_from(lamp), lamp_pixels(lamp, points)] for lamp in room.lamps]
    return made


def shots() -> list[Any]:
    """A walk that is quick enough to smear, and the room before it."""
    motion = performance(person(2), "walk_toward", 3)
    names = ("joints_m", "bones", "angles_deg", "root_m", "phase")
    some = motion._replace(**{name: getattr(motion, name)[[0, 30, 45, 46]] for name in names})
    return [
        [*shot.frames, *shot.masks] for shot in render(person(2), some, default_rig(40, 30), 5, 6)
    ]


def outlines() -> list[Any]:
    made: list[Any] = []
    for seed, manner in ((2, silhouette_examples.ORDINARY), (3, silhouette_examples.AT_LARGE)):
        made += islice(silhouette_examples.silhouette_examples(seed, manner), 30)
    return made


def pictures() -> list[Any]:
    given = [*islice(picture_examples.picture_examples(1), 4)]
    rng = np.random.default_rng(12)
    mixed = [
        composite(one, lambda: given[0], lambda: backdrops.backdrop(5), rng) for one in given * 6
    ]
    return [given, [without_mask(one) for one in mixed]]


def without_mask(one: composites.Composite) -> list[Any]:
    """All of a composite but its mask, which networks were not taught at first."""
    return [part for name, part in one._asdict().items() if name != "mask"]


def truths() -> list[Any]:
    """What pictures say of themselves, which is lost among their pixels: places, facings, sizes."""
    given = [one for seed in range(2) for one in picture_examples.picture_examples(seed)]
    rng = np.random.default_rng(15)
    mixed = [composite(one, lambda: given[0], lambda: BARE, rng) for one in given]
    return [
        [part for part in one if np.size(part) < 1000 and part is not None]
        for one in (*given, *mixed)
    ]


def ragged() -> list[Any]:
    """Outlines as networks are shown them, in all ways in which they are spoilt."""
    rng = np.random.default_rng(16)
    whole = np.zeros((picture_examples.SIDE_PX, picture_examples.SIDE_PX), np.uint8)
    whole[10:90, 30:60] = 1
    return [composites._told(whole, rng) for _ in range(150)]


def landmarks() -> list[Any]:
    """Of a walk before two cameras, in all ways in which they may be mistaken."""
    from common.body.body import JOINT_NAMES

    motion = performance(person(2), "walk_sideways", 3)
    order = [skeleton.JOINTS.index(name) for name in JOINT_NAMES]
    joints = motion.joints_m[motion.present][:, order]
    rng = np.random.default_rng(13)
    rig = default_rig(160, 120)
    return [shown_joints(joints, camera, (160, 120), 1.7, rng) for camera in rig.cameras * 6]


def exposed() -> list[Any]:
    motions = [performance(person(2), name, 3) for name in ("kick_right_forward", "squat")]
    return [[exposures(2, 75, seed, 15.0) for seed in range(6)], [blurred(one) for one in motions]]


def posed_anyhow() -> list[Any]:
    rng = np.random.default_rng(14)
    return [poses_deg(person(seed), 20, rng) for seed in range(6)]


BARE = np.full((backdrops.SIDE_PX, backdrops.SIDE_PX, 3), 90, np.uint8)
"""A backdrop that costs nothing."""
SCENES = (0, 1, 3, 4, 5, 7, 8)
"""Backdrops: one of a room, the others heaped."""


def taught() -> list[Any]:
    """What networks are trained on, as they see it."""
    lifted = [one for seed in range(10) for one in lifting_examples(seed)]
    manners = (silhouette_examples.ORDINARY, silhouette_examples.AT_LARGE)
    return [lifted, [example_of((seed, manner)) for seed, manner in enumerate(manners)]]


SMOOTH, DRAWN = 1e-7, 1e-5
"""How far numbers may be off, of their size: those of curves, and those of pictures, of which a
pixel may be rounded otherwise elsewhere."""
MADE: dict[str, tuple[Callable[[], Any], float, tuple[float, float, float]]] = {
    "people": (people, SMOOTH, (126.485230849, 44.0056763762, 22.7086352236)),
    "meshes": (meshes, SMOOTH, (768.065862203, 745.620680608, 6.97866795769)),
    "acts": (acts, SMOOTH, (1.18152475532, 18.1231823177, 3.15368063002)),
    "idle": (idle, SMOOTH, (57.1432859068, 45.6195687727, 8.39765889492)),
    "stream": (
        lambda: moved(streamed(person(5), 2)),
        SMOOTH,
        (1.22484153594, 7.96458079559, 2.03712919008),
    ),
    "rigs": (rigs, SMOOTH, (81.8695125819, 98.2404844805, 67.420629825)),
    "flaws": (flaws, DRAWN, (0.244215089, 0.895500447, 0.0124914938)),
    "exposures": (exposed, SMOOTH, (1.3714459461, 0.29939064768, 0.0170474912297)),
    "poses": (posed_anyhow, SMOOTH, (23.6679927813, 57.1154118569, 42.2054031318)),
    "papered": (papered, DRAWN, (203.368587, 43.4643653, 26.4514011)),
    "rooms": (rooms, DRAWN, (97.1476037, 71.6638106, 25.1522339)),
    "backdrops": (
        lambda: [*map(backdrops.backdrop, SCENES)],
        DRAWN,
        (166.794964, 78.3500639, 17.4781463),
    ),
    "shots": (shots, DRAWN, (134.030346, 58.3905818, 10.9113542)),
    "outlines": (outlines, DRAWN, (0.179516377, 3.5939525, 0.0742107292)),
    "pictures": (pictures, DRAWN, (127.878745, 74.4646827, 10.8702198)),
    "taught": (taught, DRAWN, (34.3506187, 69.21771, 8.98508423)),
    "truths": (truths, DRAWN, (70.3042309, 33.0772283, 24.8680518)),
    "ragged": (ragged, DRAWN, (93.4871581, 86.3516704, 1.91500244)),
    "landmarks": (landmarks, SMOOTH, (66.5828403987, 36.1427016792, 17.3950898554)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_a_seed_makes_what_it_made_when_networks_were_trained_on_it(name: str) -> None:
    make, off, before = MADE[name]
    assert told(make()) == pytest.approx(before, rel=off)
