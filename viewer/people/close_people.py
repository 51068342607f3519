"""People who are close to each other in a picture: each is looked at with the others made grey."""

from collections.abc import Mapping, Sequence
from itertools import combinations, permutations
from typing import Final

import cv2
import numpy as np

from common.body.body import Floats
from common.body.observation import Landmarks
from common.video.pictures import Image
from viewer.landmarks.landmark_window import GREY, Window
from viewer.landmarks.own_landmarks import LandmarkModel, look_in, window_of_joints
from viewer.landmarks.person_mask import LandmarkResult
from viewer.people.known_people import PEOPLE, People, corners_of, distance
from viewer.people.people_detector import Detection
from viewer.room.body_region import Bytes, body_region

BEYOND: Final = 0.04
"""How far others' pixels reach beyond their bodies, statures: hair, clothes, and what they move
between two frames."""
IS_NEAR: Final = 0.4
"""Median distance of a detection's joints from a known person's last ones, in the longer side of
what holds them, from which on they are of another."""
AROUND: Final = 0.15
"""How far beyond people's joints the picture is searched for them, in the longer side of what holds
the largest one's: heads, feet, and what they move between two frames."""
APART: Final = 0.1
"""Distance of two people's boxes up to which they meet, in the longer side of either."""


def cheapest(costs: Sequence[Sequence[float]], most: float) -> list[int | None]:
    """For each row of a small matrix its column, each column once, with the least sum; None where
    there is none of at most a given cost.

    Few people are tried in every order: scipy's assignment would cost a quarter of a second to
    import.

    Args:
        costs: Of each row, for the same columns.
        most: Cost of a row without a column.
    """
    columns = len(costs[0]) if costs else 0
    found: list[int | None] = [None] * len(costs)
    padded = [[*row[:columns]] for row in costs]
    padded += [[most] * columns for _ in range(columns - len(costs))]
    best = min(
        permutations(range(len(padded)), columns),
        key=lambda rows: sum(min(padded[row][n], most) for n, row in enumerate(rows)),
        default=(),
    )
    for column, row in enumerate(best):
        if row < len(costs) and costs[row][column] <= most:
            found[row] = column
    return found


def close_part_px(people: People) -> Floats | None:
    """What holds all known people who reach into another's window, or into whose another does: (2,
    2) top left and bottom right; None where there are none."""
    windows = [(each.landmarks, window_of_joints(each.landmarks)) for each in people.tracks]
    close = [
        corners_of(each)
        for (own, window), (other, _) in permutations(windows, 2)
        if window is not None and is_in(window, other)
        for each in (own, other)
    ]
    if not close:
        return None
    low, high = np.min([each[0] for each in close], axis=0), np.max(close, axis=(0, 1))
    beyond = AROUND * (np.array(close)[:, 1] - np.array(close)[:, 0]).max()
    return np.stack((low - beyond, high + beyond))


def are_together(people: People) -> bool:
    """Whether the boxes of any two known people meet: one may be taken for the other."""
    boxes = [corners_of(each.landmarks) for each in people.tracks]
    return any(
        bool((one[0] <= other[1] + APART * (other[1] - other[0]).max()).all())
        and bool((other[0] <= one[1] + APART * (one[1] - one[0]).max()).all())
        for one, other in combinations(boxes, 2)
    )


def looked_at_alone(
    picture: Image,
    people: People,
    model: LandmarkModel,
    detected: Sequence[Detection],
    carried: Mapping[int, LandmarkResult],
) -> tuple[dict[int, LandmarkResult], list[LandmarkResult]]:
    """The looks at people who are close to each other, by number, and at new ones.

    Args:
        picture: (H, W, 3)
        people: After the frame before.
        model: How the followed person, and new ones, are looked at.
        detected: The people in the frame before; who is not among them is where they were.
        carried: Those who are not looked at, by number.
    """
    costs = [
        [distance(each.landmarks, track.landmarks) for track in people.tracks] for each in detected
    ]
    owners = cheapest(costs, IS_NEAR)
    seen = [
        (None if n is None else people.tracks[n].number, each.landmarks, each.window)
        for n, each in zip(owners, detected, strict=True)
    ]
    for n, track in enumerate(people.tracks):
        window = window_of_joints(track.landmarks)
        if n not in owners and window is not None:
            seen.append((track.number, track.landmarks, window))
    places = {place: landmarks for place, (_, landmarks, _) in enumerate(seen)}
    looks, new = {people.followed: LandmarkResult(None), **carried}, list[LandmarkResult]()
    for place, (number, _, window) in enumerate(seen):
        if number in carried:
            continue
        alone = without(picture, beside(picture, place, places, window))
        often = number in {None, people.followed}
        look = look_in(alone, window, model if often else model._replace(twice=False))
        if number is None:
            new.append(look)
        else:
            looks[number] = look
    return looks, new[:PEOPLE]


def beside(
    picture: Image, number: int, people: Mapping[int, Landmarks], window: Window | None = None
) -> Bytes | None:
    """(H, W) 1 where others in a person's window are and the person is not; None: they are apart.

    The network of landmarks joins limbs of two people whom it sees in one window: in made-up scenes
    of two .75 of the joints are within a twentieth of the stature, .91 where the other is grey
    (docs/measurements.md).

    Args:
        picture: (H, W, 3)
        number: The person's, among the people.
        people: By any numbers.
        window: The person's; None: about the joints.
    """
    if len(people) < 2:
        return None
    own = people[number]
    window = window or window_of_joints(own)
    if window is None:
        return None
    near = [each for other, each in people.items() if other != number and is_in(window, each)]
    if not near:
        return None
    theirs = np.maximum.reduce([body_region(each, picture.shape, BEYOND) for each in near])
    return np.asarray(cv2.subtract(theirs, body_region(own, picture.shape, 0.0)))


def is_in(window: Window, other: Landmarks) -> bool:
    """Whether another person reaches into a window, turned or not."""
    low, high = corners_of(other)
    start = np.array((window.left, window.top))
    return bool((high > start).all() and (low < start + window.side).all())


def without(picture: Image, theirs: Bytes | None) -> Image:
    """The picture (H, W, 3) with pixels (H, W) made grey; itself without any."""
    if theirs is None:
        return picture
    alone = picture.copy()
    alone[theirs > 0] = GREY
    return alone
