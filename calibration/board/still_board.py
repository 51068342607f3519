"""Rests of a board: when it is held still, and what several cameras show of it then."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

Chosen = NDArray[np.bool_]
Numbers = NDArray[np.intp]

MOVED: Final = 0.0025
"""Share of the picture's width: a board that moves less since the start of a rest is still."""
SHORTEST_S: Final = 0.35
"""Shortest rest, seconds: a shorter one may be the turning point of a movement."""
SHARED: Final = 0.5
"""Share of the shorter of two cameras' rests that must overlap: a board held for two seconds is
found in videos that began up to a second apart."""


class BoardVideo(NamedTuple):
    """The board's corners in one video."""

    name: str
    size_px: tuple[int, int]
    time_s: Vector
    """(m,) times of the examined frames that show the board."""
    px: Vector
    """(m, n, 2) its corners, NaN where hidden."""


class Rest(NamedTuple):
    """A stretch in which one camera shows the board at rest."""

    begin_s: float
    end_s: float
    px: Vector
    """(n, 2), NaN where hidden."""


class Moments(NamedTuple):
    """Rests of the board, in all cameras."""

    begin_s: Vector
    """(m,) times."""
    end_s: Vector
    px: Vector
    """(m, cameras, n, 2), NaN where hidden."""


def rests_of(film: BoardVideo) -> list[Rest]:
    """All stretches in which the board is at rest, in order."""
    far_px = MOVED * film.size_px[0]
    groups: list[list[int]] = []
    for index in range(len(film.time_s)):
        if groups and _moved_px(film, groups[-1][0], index) <= far_px:
            groups[-1].append(index)
        else:
            groups.append([index])
    return [rest for group in groups if (rest := _rest(film, group)) is not None]


def _moved_px(film: BoardVideo, before: int, after: int) -> float:
    """Displacement of the corners that both frames show; infinite where these are few."""
    steps = np.linalg.norm(film.px[after] - film.px[before], axis=-1)
    seen = np.isfinite(steps)
    return float(np.sqrt(np.mean(steps[seen] ** 2))) if np.count_nonzero(seen) >= 4 else np.inf


def _rest(film: BoardVideo, group: Sequence[int]) -> Rest | None:
    begin_s, end_s = float(film.time_s[group[0]]), float(film.time_s[group[-1]])
    if end_s - begin_s < SHORTEST_S:
        return None
    px = film.px[group]
    often = np.isfinite(px[..., 0]).mean(axis=0) >= 0.5
    middle = np.full(px.shape[1:], np.nan)
    middle[often] = np.nanmedian(px[:, often], axis=0)
    return Rest(begin_s, end_s, middle) if np.count_nonzero(often) >= 6 else None


def moments_of(rests: Sequence[Sequence[Rest]]) -> Moments:
    """The rests of several cameras, matched by time.

    A rest of another camera is matched to the rest of camera 1 with the longest overlap.
    """
    kept: list[tuple[Rest, dict[int, Vector]]] = [(rest, {0: rest.px}) for rest in rests[0]]
    alone: list[tuple[Rest, dict[int, Vector]]] = []
    for camera in range(1, len(rests)):
        for rest in rests[camera]:
            shared_s = [_shared_s(rest, other) for other, _ in kept]
            best = int(np.argmax(shared_s)) if shared_s else 0
            if shared_s and shared_s[best] > 0 and camera not in kept[best][1]:
                kept[best][1][camera] = rest.px
            else:
                alone.append((rest, {camera: rest.px}))
    told = sorted(kept + alone, key=lambda one: one[0].begin_s)
    corners = len(told[0][0].px) if told else 0
    px = np.full((len(told), len(rests), corners, 2), np.nan)
    for row, (_, seen) in enumerate(told):
        for camera, places in seen.items():
            px[row, camera] = places
    begins = np.array([rest.begin_s for rest, _ in told])
    return Moments(begins, np.array([rest.end_s for rest, _ in told]), px)


def _shared_s(one: Rest, other: Rest) -> float:
    """Overlap of two rests; 0 where it is too short for either."""
    shared_s = min(one.end_s, other.end_s) - max(one.begin_s, other.begin_s)
    shorter_s = min(one.end_s - one.begin_s, other.end_s - other.begin_s)
    return shared_s if shared_s >= SHARED * shorter_s else 0.0


def spread_moments(moments: Moments, most: int, needed: Chosen) -> Moments:
    """At most this many of the rests, as different as possible; half of them shown by several
    cameras.

    Args:
        moments: All rests.
        most: Number of rests to keep.
        needed: (m,) True for rests that are kept in addition.
    """
    seen = seen_by(moments)
    shared = seen.sum(axis=1) > 1
    looks = np.stack([_look(one) for one in moments.px])
    kept = set(np.flatnonzero(needed).tolist())
    for some in (np.flatnonzero(shared), np.flatnonzero(~shared)):
        kept |= set(_farthest(looks[some], some, most // 2))
    return only(moments, np.sort([*kept]))


def seen_by(moments: Moments) -> Chosen:
    """(m, cameras) whether a camera shows the board."""
    return np.asarray(np.isfinite(moments.px[..., 0]).any(axis=2))


def only(moments: Moments, chosen: Numbers) -> Moments:
    """Some of the rests, by index."""
    return Moments(moments.begin_s[chosen], moments.end_s[chosen], moments.px[chosen])


def _look(px: Vector) -> Vector:
    """Appearance of each rest: for each camera the corners' mean place and spread, 0 where
    hidden."""
    looks = []
    for places in px:
        seen = places[np.isfinite(places[:, 0])]
        spread = np.cov(seen.T).ravel() if len(seen) else np.zeros(4)
        middle = seen.mean(axis=0) if len(seen) else np.zeros(2)
        looks.append([*middle, *(np.sign(spread) * np.sqrt(np.abs(spread)) * 3)])
    return np.ravel(looks)


def _farthest(looks: Vector, names: Numbers, most: int) -> list[int]:
    """Indices of rests far from each other, chosen one after the other."""
    if len(names) <= most:
        return [int(name) for name in names]
    chosen = [0]
    away = np.linalg.norm(looks - looks[0], axis=1)
    while len(chosen) < most:
        chosen.append(int(away.argmax()))
        away = np.minimum(away, np.linalg.norm(looks - looks[chosen[-1]], axis=1))
    return [int(names[one]) for one in chosen]
