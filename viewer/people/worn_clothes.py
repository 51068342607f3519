"""Who wears whose clothes in a view: people taken for each other get their numbers back."""

from collections.abc import Sequence
from itertools import combinations
from typing import Final

import msgspec
import numpy as np

from common.body.clothes import TAKEN, exchange_gain
from common.body.observation import Box, Observation
from viewer.people.known_people import Clothes, People, Track

NEW_SHARE: Final = 0.02
"""Least weight of a frame in the mean of the colours: light changes within seconds."""

Seen = tuple[Observation, ...]


def step(people: People, seen: Seen) -> tuple[People, Seen]:
    """The people and their observations, each with the number of who wears the clothes; and the
    clothes, learnt where no other person is near.

    Of two who cross, one is hidden, and the other is where both are expected: numbers go by places
    alone until colours are known, which needs silhouettes.

    Args:
        people: After a frame.
        seen: The observations in it, with colours.
    """
    worn = {each.number: each.colours for each in people.clothes}
    shown = {one.track: one.colours for one in seen}
    known = [track.number for track in people.tracks if track.number in worn]
    for one, other in combinations(known, 2):
        colours = shown.get(one, ()), shown.get(other, ())
        if exchange_gain(worn[one], worn[other], *colours) > TAKEN:
            people, seen = _exchanged(people, seen, {one: other, other: one})
            break
    return people._replace(clothes=_learnt(people, seen)), seen


def _exchanged(people: People, seen: Seen, numbers: dict[int, int]) -> tuple[People, Seen]:
    """The people and their observations with some numbers exchanged, the followed person's first as
    before."""
    tracks = (each._replace(number=numbers.get(each.number, each.number)) for each in people.tracks)
    renamed = [
        msgspec.structs.replace(one, track=numbers.get(one.track, one.track)) for one in seen
    ]
    renamed.sort(key=lambda one: one.track != people.followed)
    return people._replace(tracks=tuple(sorted(tracks, key=_number))), tuple(renamed)


def _learnt(people: People, seen: Seen) -> tuple[Clothes, ...]:
    """The clothes of all known people, with those of a frame that shows all of them apart."""
    numbers = {track.number for track in people.tracks}
    worn = {each.number: each for each in people.clothes if each.number in numbers}
    is_apart = len(seen) == len(people.tracks) and _are_apart([one.box for one in seen])
    for one in seen if is_apart else ():
        if one.colours:
            before = worn.get(one.track, Clothes(one.track, one.colours, 0))
            share = max(1.0 / (before.frames + 1), NEW_SHARE)
            mean = np.array(before.colours)
            mean += share * (np.array(one.colours) - mean)
            worn[one.track] = Clothes(one.track, tuple(mean.tolist()), before.frames + 1)
    return tuple(sorted(worn.values()))


def _are_apart(boxes: Sequence[Box]) -> bool:
    """Whether no two boxes overlap."""
    return all(
        one.right < other.left
        or other.right < one.left
        or one.bottom < other.top
        or other.bottom < one.top
        for one, other in combinations(boxes, 2)
    )


def _number(track: Track) -> int:
    return track.number
