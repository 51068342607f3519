"""The people whom a viewer knows: which look is of whom, and which of them is followed."""

from collections.abc import Sequence
from typing import Final, NamedTuple, TypeGuard

import numpy as np

from common.body.body import JOINT_NAMES, Floats
from common.body.observation import Landmarks, Pixel
from common.bus.messages import MOST_PEOPLE
from viewer.landmarks.own_landmarks import COUNTS, LEAST

PEOPLE: Final = MOST_PEOPLE
"""Upper bound of the number of people that a viewer knows at once: each takes a look of the network
of landmarks in each frame."""
GRACE_S: Final = 1.0
"""Time after which a person who is not seen is no longer known, seconds."""
NEAR: Final = 0.15
"""Median distance of joints below which two looks are of one person, in the longer side of what
holds the joints."""
SHARED: Final = 5
"""Looks that have fewer sure joints in common cannot be compared by them."""
KEEPS: Final = 0.1
"""A look that two people claim is the followed person's unless it is nearer to the other by so
much, in the same unit."""
REACH, REACH_PER_S = 0.3, 1.0
"""Distance at which a person who was out of sight is found again, and what each second adds, in the
same unit: a walker covers 0.8 statures in a second."""
ALIKE: Final = 1.6
"""Ratio of sizes from which a person is not the one who was out of sight."""
AT_ROOT: Final = 0.25
"""The integrator's person is another than the followed one where the other's pelvis is within this
distance of the place that it predicts, and the followed one's is so much farther, same unit."""
_PELVIS: Final = JOINT_NAMES.index("pelvis")


class Track(NamedTuple):
    """A person."""

    number: int
    """Never another person's."""
    landmarks: Landmarks
    """As last seen."""
    seen_s: float
    """Capture time of that."""


class Clothes(NamedTuple):
    """The colours of a person's clothes."""

    number: int
    colours: tuple[float, ...]
    """Running mean of `Observation.colours`."""
    frames: int
    """Number of frames in it."""


class People(NamedTuple):
    """What one frame hands to the next."""

    tracks: tuple[Track, ...] = ()
    followed: int = 0
    """The number of the followed person; where no person is known, of the next one."""
    fresh: int = 1
    """The next number that no person has had."""
    clothes: tuple[Clothes, ...] = ()
    """Of the people whose clothes were seen, by number."""

    @property
    def person(self) -> Track | None:
        """The followed person; None where no person is known."""
        return next((track for track in self.tracks if track.number == self.followed), None)

    @property
    def are_seen(self) -> bool:
        """Whether all were seen in the frame before."""
        return len({track.seen_s for track in self.tracks}) <= 1

    @property
    def others(self) -> tuple[Track, ...]:
        """All but the followed person."""
        return tuple(track for track in self.tracks if track.number != self.followed)


class Look(NamedTuple):
    """What the network of landmarks saw in one window."""

    number: int | None
    """Whose window it was; None: that of no known person."""
    landmarks: Landmarks


def of_one(landmarks: Landmarks | None, seen_s: float = 0.0) -> People:
    """The people where one at most is known.

    Args:
        landmarks: Of the followed person; None: no person is known.
        seen_s: Capture time.
    """
    return People() if landmarks is None else People((Track(0, landmarks, seen_s),))


def last(people: People) -> Landmarks | None:
    """The followed person, as last seen; None where no person is known."""
    return None if people.person is None else people.person.landmarks


def forgotten(people: People) -> People:
    """No person is known any more; numbers go on."""
    return People((), people.fresh, people.fresh + 1) if people.tracks else people


def step(
    people: People, at_s: float, looks: Sequence[Look]
) -> tuple[People, tuple[int | None, ...]]:
    """The people after a frame, and whose each look is: the number, or None where it shows a person
    whom another look shows too, or one too many.

    Two people in one place are seen as the one in front: the other is out of sight, and keeps the
    number for GRACE_S. No other person takes the followed one's place in that time.

    Args:
        people: After the frame before.
        at_s: Capture time.
        looks: In any order. Those with the number of a person are in a window of theirs.
    """
    seen: dict[int, Landmarks] = {}
    numbers: list[int | None] = [None] * len(looks)
    fresh = people.fresh
    order = range(len(looks))
    for place in sorted(order, key=lambda at: _rank(people, looks[at])) if order[1:] else order:
        number, landmarks = looks[place]
        if any(is_same(landmarks, known) for known in seen.values()):
            continue
        if number is None or number in seen:
            number = _found_again(people, landmarks, at_s, seen)
        if number is None and not people.tracks and people.followed not in seen:
            number = people.followed
        if number is None and len(set(seen) | {track.number for track in people.tracks}) < PEOPLE:
            number, fresh = fresh, fresh + 1
        if number is not None:
            seen[number], numbers[place] = landmarks, number
    tracks = tuple(Track(number, landmarks, at_s) for number, landmarks in seen.items())
    out_of_sight = (track for track in people.tracks if track.number not in seen)
    tracks += tuple(track for track in out_of_sight if at_s - track.seen_s <= GRACE_S)
    after = people._replace(tracks=tuple(sorted(tracks)), fresh=fresh)
    return _with_followed(after, bool(people.tracks)), tuple(numbers)


def expected_at(people: People, root_px: Pixel | None) -> People:
    """The people, with the one followed whom the integrator follows.

    Args:
        people: After the frame before.
        root_px: Where the integrator predicts its person's pelvis; None: it does not.
    """
    own = people.person
    if root_px is None or own is None or len(people.tracks) == 1:
        return people
    off = {track.number: _off_root(track, root_px) for track in people.tracks}
    nearest = min(off, key=off.__getitem__)
    is_other = off[nearest] < AT_ROOT and off[people.followed] > off[nearest] + AT_ROOT
    return people._replace(followed=nearest) if is_other else people


def is_same(first: Landmarks, second: Landmarks) -> bool:
    """Whether two looks are of one person: their joints are in the same places."""
    return distance(first, second) < NEAR


def is_person(landmarks: Landmarks | None) -> TypeGuard[Landmarks]:
    """Whether a look is sure enough that it shows a person."""
    return landmarks is not None and float(np.mean(landmarks.confidence)) >= LEAST


def _rank(people: People, look: Look) -> tuple[bool, float]:
    """Which look comes first: how far a person would have moved, of new ones the largest."""
    track = next((track for track in people.tracks if track.number == look.number), None)
    if track is None:
        return look.number is None, -_size(look.landmarks)
    return False, distance(look.landmarks, track.landmarks) - KEEPS * (
        track.number == people.followed
    )


def _found_again(
    people: People, landmarks: Landmarks, at_s: float, seen: dict[int, Landmarks]
) -> int | None:
    """The number of the person out of sight who this may be; None: they are new."""
    best, nearest = None, np.inf
    for track in people.tracks:
        off = _apart(landmarks, track.landmarks)
        ratio = _size(landmarks) / max(_size(track.landmarks), 1.0)
        is_alike = 1.0 / ALIKE < ratio < ALIKE
        reach = REACH + REACH_PER_S * (at_s - track.seen_s)
        if track.number not in seen and is_alike and off < min(reach, nearest):
            best, nearest = track.number, off
    return best


def _with_followed(people: People, was_known: bool) -> People:
    """The people after the followed one may have been forgotten: then the largest is followed."""
    if people.person is not None or not (people.tracks or was_known):
        return people
    if not people.tracks:
        return People((), people.fresh, people.fresh + 1)
    largest = max(people.tracks, key=lambda track: _size(track.landmarks))
    return people._replace(followed=largest.number)


def _off_root(track: Track, root_px: Pixel) -> float:
    """How far a person's pelvis is from a place, in the size of what holds their joints."""
    off_px = np.subtract(track.landmarks.joints_px[_PELVIS], root_px)
    return float(np.hypot(*off_px)) / _size(track.landmarks)


def distance(first: Landmarks, second: Landmarks) -> float:
    """Median distance of the joints that both are sure of, in the larger size; of few joints, that
    of the middles."""
    sure = np.minimum(first.confidence, second.confidence) > COUNTS
    if sure.sum() < SHARED:
        return _apart(first, second)
    off_px = np.subtract(first.joints_px, second.joints_px)[sure]
    return float(np.median(np.hypot(*off_px.T))) / max(_size(first), _size(second))


def _apart(first: Landmarks, second: Landmarks) -> float:
    """Distance of the middles of two people, in the larger size."""
    off_px = corners_of(first).mean(axis=0) - corners_of(second).mean(axis=0)
    return float(np.hypot(*off_px)) / max(_size(first), _size(second))


def _size(landmarks: Landmarks) -> float:
    """Longer side of what holds the joints that count, pixels."""
    low, high = corners_of(landmarks)
    return max(1.0, float((high - low).max()))


def corners_of(landmarks: Landmarks) -> Floats:
    """(2, 2) top left and bottom right of the joints that count, of all where none does."""
    places, counts = np.array(landmarks.joints_px), np.array(landmarks.confidence) > COUNTS
    held = places[counts] if counts.any() else places
    return np.stack((held.min(axis=0), held.max(axis=0)))
