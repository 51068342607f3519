"""The beats of a scene: who walks where, who does what, and who meets whom."""

from collections.abc import Callable, Sequence
from itertools import cycle
from typing import Final

import numpy as np

from synth.motion.idling import IDLE, RETURNS
from synth.motion.moves import MOTION_S, MOVES
from synth.scene.contact_moves import embrace, handing
from synth.scene.floor import Ground, way_out
from synth.scene.plot import (
    APART_M,
    TRIES,
    Clash,
    Contact,
    Plot,
    gestured,
    later,
    refuse_astray,
    refuse_clashes,
    spots,
    turned_to,
    walk_through,
    walked,
)
from synth.scene.script import Floor, Walk, towards_deg

Random = np.random.Generator
Beat = Callable[[Plot, Ground, Random], Plot]
"""Continues a plot by some seconds; raises Clash where its random choices do not work out."""

CROWD: Final = 4
"""Number of people from which on there is no room for much at the same time."""
CALM: Final = tuple(name for name in IDLE if name != "anything")
"""Gestures near the body."""
BENT_M: Final = 0.35
"""Standard deviation of the middle of a way from the straight line."""
WAITS_S: Final = 0.4
"""Longest time until a walk begins."""
EMBRACED_M, BEFORE_M, HANDED_M = 0.3, 0.95, 1.0
"""Distances of the pelvises in an embrace, before it, and while a thing is handed over."""
ASIDE_M: Final = 0.18
"""Distance of each from the common line at which two right hands meet."""
STEP_S, HELD_S, TURNED_S = 0.9, 2.6, 0.5
"""Durations of a step into an embrace, of a gesture together, and of a turn."""
PAUSE_S: Final = 0.2
"""Time after a performance."""
NEAR_M: Final = 0.05
"""Distance of a place to which no walk is needed."""
ROUND_DEG: Final = (170.0, 330.0)
"""Angle by which two people walk around each other."""
RADIUS_M: Final = 0.5
"""Smallest radius of that."""
FACING_DEG: Final = 40.0
"""Largest angle between the heading of a posture and camera 1."""
POSTURE_SHARE: Final = 0.7
"""Share of the performances that are one of the postures; the others are gestures."""
STAYING: Final = tuple(name for name in MOVES if name not in RETURNS)
"""Postures that do not lead away."""


def mingle(plot: Plot, ground: Ground, rng: Random) -> Plot:
    """People walk to other places, half of the time to each other's."""
    most = int(rng.integers(1, 3)) if len(plot.there) >= CROWD else len(plot.there)
    there = [int(who) for who in rng.permutation(plot.there)[:most]]
    if len(there) > 1 and rng.random() < 0.5:
        ends = [plot.scripts[who].end_m for who in there]
        targets = dict(zip(there, [*ends[1:], ends[0]], strict=True))
    else:
        targets = spots(plot, there, ground.places_m, APART_M, rng)
    return _while(plot, _reformed(plot, targets, rng), there, rng)


def orbit(plot: Plot, ground: Ground, rng: Random) -> Plot:
    """Two people walk around each other."""
    pair, _ = _pair(plot, rng)
    first, second = (plot.scripts[who].end_m for who in pair)
    middle, half = (first + second) / 2, (first - second) / 2
    radius, sweep = float(np.linalg.norm(half)), rng.uniform(*ROUND_DEG) * rng.choice([-1.0, 1.0])
    share = np.linspace(0.0, 1.0, 9)[:, None]
    angle = np.arctan2(half[1], half[0]) + np.radians(sweep) * share
    reach = radius + np.minimum(3.0 * share, 1.0) * (max(RADIUS_M, 0.8 * radius) - radius)
    circle = reach * np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    refuse_astray(ground, np.concatenate([middle + circle, middle - circle]))
    walk = walk_through(plot.now_s, middle + circle, rng)
    after = walked(plot, pair[0], walk)
    after = walked(after, pair[1], walk._replace(points_m=middle - circle))
    return _while(plot, later(after, walk.to_s - plot.now_s), pair, rng)


def perform(plot: Plot, _ground: Ground, rng: Random) -> Plot:
    """Everybody does something else at their place."""
    ready = plot
    for who in plot.there:
        ready = turned_to(ready, who, rng.uniform(-FACING_DEG, FACING_DEG))
    ready = later(ready, TURNED_S)
    after = ready
    postures = rng.permutation(STAYING).tolist()
    share = POSTURE_SHARE if len(plot.there) < CROWD else 1.0 / len(plot.there)
    for who in plot.there:
        if rng.random() < share:
            name = postures.pop()
            after = gestured(after, who, name, MOVES[name], MOTION_S)
        else:
            after = _idle(after, who, MOTION_S, rng)
    return later(after, MOTION_S + PAUSE_S)


def perform_each(plot: Plot, postures: Sequence[str]) -> Plot:
    """Everybody performs a given posture at their place, once.

    Args:
        plot: Who is there.
        postures: Of the first person, the second and so on; fewer are given in turn.
    """
    after = plot
    for who, name in zip(plot.there, cycle(postures), strict=False):
        after = gestured(after, who, name, MOVES[name], MOTION_S)
    return later(after, MOTION_S + PAUSE_S)


def hug(plot: Plot, ground: Ground, rng: Random) -> Plot:
    """Two people meet, embrace and part."""
    pair, along = _pair(plot, rng)
    met, middle = _met(plot, pair, along * BEFORE_M / 2, ground, rng)
    start = met.now_s
    near, far = along * EMBRACED_M / 2, along * BEFORE_M / 2
    after = met
    ends_s = start + STEP_S + HELD_S
    for who, sign, high in zip(pair, (-1.0, 1.0), rng.permutation(["l", "r"]), strict=True):
        close, away = middle + sign * near, middle + sign * far
        facing = towards_deg(close, middle)
        step = Walk(start, start + STEP_S, np.array([away, close]), facing)
        back = Walk(ends_s - 0.3, ends_s + STEP_S - 0.3, np.array([close, away]), facing)
        after = walked(walked(after, who, step), who, back)
        arms = later(after, STEP_S - 0.5)
        arms = gestured(arms, who, "hug", embrace(HELD_S, str(high)), HELD_S)
        after = arms._replace(now_s=start)
    contact = Contact("hug", pair, start, ends_s + STEP_S)
    after = after._replace(contacts=(*after.contacts, contact))
    return _while(met, later(after, contact.to_s - start), pair, rng)


def hand_over(plot: Plot, ground: Ground, rng: Random) -> Plot:
    """One person gives another a thing."""
    pair, along = _pair(plot, rng)
    right = np.array([-along[1], along[0]])
    met, _ = _met(plot, pair, along * HANDED_M / 2 + right * ASIDE_M, ground, rng)
    after = met
    for who, sign in zip(pair, (1.0, -1.0), strict=True):
        after = turned_to(after, who, towards_deg(np.zeros(2), sign * along))
    after = later(after, TURNED_S)
    for who in pair:
        after = gestured(after, who, "hand over", handing(HELD_S), HELD_S)
    contact = Contact("hand over", pair, after.now_s, after.now_s + HELD_S)
    after = after._replace(contacts=(*after.contacts, contact))
    return _while(met, later(after, HELD_S), pair, rng)


def leave(plot: Plot, ground: Ground, rng: Random) -> Plot:
    """One person goes out, the others do something meanwhile."""
    if len(plot.there) < 2 and len(plot.scripts) > 1:
        raise Clash("the room would be empty")
    who = int(rng.choice(plot.there))
    start = plot.scripts[who].end_m
    walk = walk_through(plot.now_s, np.array([start, way_out(ground, start)]), rng)
    after = later(walked(plot, who, walk), walk.to_s - plot.now_s)
    after = _while(plot, after, (who,), rng)
    return after._replace(out=plot.out | {who})


def come_in(plot: Plot, ground: Ground, rng: Random) -> Plot:
    """One of those who are out comes in, the others do something meanwhile."""
    if not plot.out:
        raise Clash("everybody is there")
    who = min(plot.out)
    targets = spots(plot, [who], ground.places_m, APART_M, rng)
    more = plot._replace(out=plot.out - {who})
    return _while(more, _reformed(more, targets, rng), [who], rng)


BEATS: Final[dict[str, Beat]] = {
    "mingle": mingle,
    "orbit": orbit,
    "perform": perform,
    "hug": hug,
    "hand over": hand_over,
    "leave": leave,
    "come in": come_in,
}


def _pair(plot: Plot, rng: Random) -> tuple[tuple[int, int], Floor]:
    """Two people of those there, and the direction from the first to the second."""
    if len(plot.there) < 2:
        raise Clash("nobody to meet")
    first, second = (int(who) for who in rng.permutation(plot.there)[:2])
    way = plot.scripts[second].end_m - plot.scripts[first].end_m
    return (first, second), way / np.linalg.norm(way)


def _met(
    plot: Plot, pair: tuple[int, int], off_m: Floor, ground: Ground, rng: Random
) -> tuple[Plot, Floor]:
    """Two people walk to places on both sides of their middle; also that middle."""
    middle = (plot.scripts[pair[0]].end_m + plot.scripts[pair[1]].end_m) / 2
    ends = {pair[0]: middle - off_m, pair[1]: middle + off_m}
    refuse_astray(ground, np.array([*ends.values()]))
    return _reformed(plot, ends, rng), middle


def _reformed(plot: Plot, targets: dict[int, Floor], rng: Random) -> Plot:
    """People walk to places on bent ways on which they keep clear of each other."""
    for _ in range(TRIES):
        after, end_s = plot, plot.now_s
        for who, target in targets.items():
            if np.linalg.norm(target - plot.scripts[who].end_m) < NEAR_M:
                continue
            from_s = plot.now_s + rng.uniform(0.0, WAITS_S)
            walk = walk_through(from_s, _bent(plot.scripts[who].end_m, target, rng), rng)
            after, end_s = walked(after, who, walk), max(end_s, walk.to_s)
        after = after._replace(now_s=end_s)
        try:
            refuse_clashes(plot, after)
        except Clash:
            continue
        return after
    raise Clash("no clear ways")


def _bent(from_m: Floor, to_m: Floor, rng: Random) -> Floor:
    """Start, a point beside the middle, and end of a way, (3, 2)."""
    x, z = to_m - from_m
    aside = np.array([-z, x]) / max(np.hypot(x, z), 0.1)
    bent = min(BENT_M, 0.3 * float(np.hypot(x, z)))
    return np.array([from_m, (from_m + to_m) / 2 + aside * bent * rng.normal(), to_m])


def _while(plot: Plot, after: Plot, busy: tuple[int, ...] | list[int], rng: Random) -> Plot:
    """What those who stand do while others are busy between two plots.

    Raises:
        Clash: When people come too close.
    """
    found = after._replace(now_s=plot.now_s)
    for who in plot.there:
        if who not in busy:
            found = _idle(found, who, after.now_s - plot.now_s, rng)
    found = found._replace(now_s=after.now_s)
    refuse_clashes(plot, found)
    return found


def _idle(plot: Plot, who: int, lasts_s: float, rng: Random) -> Plot:
    """The plot with a gesture of a person who stands."""
    name = str(rng.choice(CALM if len(plot.there) >= CROWD else list(IDLE)))
    return gestured(plot, who, name, IDLE[name](rng), lasts_s)
