"""Known people who are looked at again where a search of the picture has detected them."""

from collections.abc import Sequence
from typing import Final

from common.video.pictures import Image
from viewer.landmarks.landmark_window import Window, same_place
from viewer.landmarks.own_landmarks import SURE, LandmarkModel, look_in
from viewer.landmarks.person_mask import LandmarkResult
from viewer.people.close_people import beside, cheapest, without
from viewer.people.known_people import PEOPLE, People, corners_of, is_person
from viewer.people.people_detector import Detection, overlap

WHOLE: Final = 0.05
"""By how much a look is surer than that in the window where the person is detected, to be kept:
its own window may hold a part of them."""
IS_OF: Final = 0.3
"""Intersection over union of a detection and a known person's joints from which it is of them."""


def looked_again(
    picture: Image,
    looks: dict[int, LandmarkResult],
    people: People,
    model: LandmarkModel,
    detected: Sequence[Detection],
) -> tuple[dict[int, LandmarkResult], list[LandmarkResult]]:
    """The looks, taken again where a person is detected elsewhere than in the window, and the looks
    at people who are detected and not known."""
    owners = owners_of(detected, people, looks[people.followed])
    looks, new = dict(looks), list[LandmarkResult]()
    places = {place: each.landmarks for place, each in enumerate(detected)}
    for place, (detection, number) in enumerate(zip(detected, owners, strict=True)):
        own = model if number in {None, people.followed} else model._replace(twice=False)
        look = None if number is None else looks.get(number)
        theirs = beside(picture, place, places)
        if number is None and len(new) < PEOPLE:
            new.append(look_in(without(picture, theirs), detection.window, own))
        elif number is not None and not is_sure_at(look, detection.window):
            again = look_in(without(picture, theirs), detection.window, own)
            looks[number] = again if look is None else _better(look, again, detection)
    return looks, new


def owners_of(
    detected: Sequence[Detection], people: People, followed: LandmarkResult
) -> list[int | None]:
    """Whom each detection shows, by where the known people were last; None: no one known."""
    places = {track.number: corners_of(track.landmarks) for track in people.tracks}
    if not places and is_person(followed.landmarks):
        places = {people.followed: corners_of(followed.landmarks)}
    costs = [
        [1.0 - overlap(each.corners_px, place) for place in places.values()] for each in detected
    ]
    numbers = list(places)
    return [None if n is None else numbers[n] for n in cheapest(costs, 1.0 - IS_OF)]


def is_sure_at(look: LandmarkResult | None, window: Window) -> bool:
    """Whether a look, or the one that is carried on, was sure, and in about the same window."""
    if look is None or look.person is None or not (look.carried or look.surety >= SURE):
        return False
    return same_place(look.person.window, window)


def _better(look: LandmarkResult, again: LandmarkResult, detection: Detection) -> LandmarkResult:
    """A look, or that at the detection where it is about as sure, or the first shows another."""
    if again.landmarks is None or look.landmarks is None:
        return look if again.landmarks is None else again
    if overlap(corners_of(look.landmarks), detection.corners_px) < IS_OF:
        return again
    return look if look.surety > again.surety + WHOLE else again
