"""A viewer's landmarks, frame by frame: where the network looks, when, and at whom."""

import math
from collections.abc import Mapping
from operator import itemgetter
from typing import Final, NamedTuple

import cv2
import numpy as np

from common.body.body import Floats
from common.body.observation import Landmarks, Pixel
from common.config.settings import Settings
from common.video.pictures import Image
from viewer.captured_frame import CapturedFrame
from viewer.landmarks.landmark_looks import network_of, opened
from viewer.landmarks.outside_source import nearest_landmarks
from viewer.landmarks.own_landmarks import (
    SURE,
    LandmarkModel,
    look_in,
    own_landmarks,
    window_of_joints,
)
from viewer.landmarks.person_mask import LandmarkResult, Shown
from viewer.people import known_people, looks_in_turn
from viewer.people.close_people import (
    are_together,
    beside,
    close_part_px,
    looked_at_alone,
    without,
)
from viewer.people.detected_again import looked_again
from viewer.people.known_people import Look, People, is_person
from viewer.people.looks_in_turn import LastLook
from viewer.people.people_detector import NETWORK, Detection, people_in
from viewer.room.body_region import Bytes
from viewer.silhouette.silhouette import Seen, seen_of

SEARCH_S: Final = 0.5
"""Time between two searches of the whole picture for people, in seconds, beside the looks at known
people."""
URGENT_S: Final = 0.25
"""The same where the followed person is not surely seen, or another known one is out of sight."""
NUMBER: Final = itemgetter(0)


class Unsearched(NamedTuple):
    """A picture that is still to be searched for people."""

    picture: Image
    part_px: Floats | None = None
    """(2, 2) top left and bottom right of the part that is searched; None: all of it."""


class State(NamedTuple):
    """What one frame hands to the next."""

    people: People = People()
    searched_s: float = -math.inf
    """Capture time of the last frame whose whole picture was searched for people."""
    unsearched: Unsearched | None = None
    """The picture that is still to be searched: of that frame, or a part of a later one."""
    detected: tuple[Detection, ...] | None = None
    """The people in it, for the next frame; None: it was not searched, or they have served."""
    looks: tuple[LastLook, ...] = ()
    """The last look at each person; empty where there is one at most."""

    @property
    def known(self) -> Landmarks | None:
        """The followed person, as last seen; None where no person is known."""
        return known_people.last(self.people)


def step(
    state: State,
    frame: CapturedFrame,
    seen: Seen,
    settings: Settings,
    *,
    alone: bool,
    root_px: Pixel | None = None,
    due: int | None = None,
) -> tuple[State, Shown]:
    """The landmarks of a frame: our own network's, or those that an outside source sent with it.

    A frame that comes late is skipped, and keeps what is known, where a background shows the
    person; several people, whom nothing else keeps apart, are carried on in it, or looked at where
    that cannot be. Where people are looked at in turn, a search of the whole picture, which takes
    two looks' time, takes a turn too: all are carried on in its frame; and between those searches
    only the part of the picture where people are close is searched. A single view has no other
    to rely on: its landmarks are computed even then, with one look instead of two. An outside
    source is asked for one person.

    Args:
        state: From the frame before.
        frame: The picture, and the landmarks of an outside source.
        seen: The followed person's silhouette in it.
        settings: They name the network or the source.
        alone: The viewer is the only one of its run.
        root_px: Where the integrator predicts the pelvis of the person that it follows; None: it
            does not.
        due: The number of the person whose turn it is; None: everyone is looked at.
    """
    if not settings.looks_itself:
        result = LandmarkResult(nearest_landmarks(frame.landmarks, seen.box))
        return State(known_people.of_one(result.landmarks, frame.captured_s)), Shown(result)
    is_skipped = frame.hurried and not alone and settings.silhouette.background != "none"
    if is_skipped and not state.looks:
        return state, Shown(LandmarkResult(None), state.people.followed)
    state = searched(state)
    people = known_people.expected_at(state.people, root_px)
    model = LandmarkModel(network_of(settings.landmarks), alone and not frame.hurried)
    close_px = None if frame.hurried else close_part_px(people)
    if due is not None:
        is_calm = people.are_seen and close_px is None
        state = _due(state, frame, SEARCH_S if is_calm else URGENT_S)
    rests = is_skipped or state.unsearched is not None
    carried = looks_in_turn.carried(state.looks, due, frame.captured_s, rests=rests)
    if close_px is None:
        state, looks, new = _looked_apart(state, frame, seen, people, model, carried, due)
    else:
        looks, new = looked_at_alone(frame.picture, people, model, state.detected or (), carried)
        # One person alone leaves time for it, and must not be taken for who crosses.
        often = settings.people == 1 or are_together(people)
        if due is None:
            state = _due(state, frame, 0.0 if often else URGENT_S)
        elif often and not rests:
            state = state._replace(unsearched=Unsearched(frame.picture, close_px))
    followed = looks[people.followed]
    after, shown = _identified(people, frame.captured_s, looks, new)
    if not shown and not is_person(followed.landmarks):
        shown = {after.followed: followed}
    last = looks_in_turn.step(state.looks, shown, frame.captured_s) if len(shown) > 1 else ()
    return state._replace(people=after, detected=None, looks=last), _shown(after, shown)


def open_networks(settings: Settings) -> None:
    """Read the networks of a run that looks itself, before its first frame asks for them."""
    if settings.looks_itself:
        opened(network_of(settings.landmarks))
        opened(NETWORK)


def searched(state: State) -> State:
    """The state with the people in the picture that is still to be searched for them.

    It takes twice a look's time: a person who is known is reported first. Whenever it is called
    before the next step, that gives the same.
    """
    if state.unsearched is None:
        return state
    return state._replace(unsearched=None, detected=tuple(people_in(*state.unsearched)))


def _due(state: State, frame: CapturedFrame, interval_s: float) -> State:
    """The state with a picture to search, where it is time to."""
    if frame.hurried or frame.captured_s < state.searched_s + interval_s:
        return state
    return state._replace(searched_s=frame.captured_s, unsearched=Unsearched(frame.picture))


def _looked_apart(
    state: State,
    frame: CapturedFrame,
    seen: Seen,
    people: People,
    model: LandmarkModel,
    carried: Mapping[int, LandmarkResult],
    due: int | None,
) -> tuple[State, dict[int, LandmarkResult], list[LandmarkResult]]:
    """The looks at people who are apart, by number, and at new ones."""
    looks, new = _looks(frame.picture, seen, people, model, carried), list[LandmarkResult]()
    is_first = state.searched_s == -math.inf
    if due is None:
        state = _due(state, frame, _interval_s(people, looks[people.followed], seen))
    if is_first or not people.tracks:
        state = searched(state)
    if state.detected is not None:
        looks, new = looked_again(frame.picture, looks, people, model, state.detected)
    return state, looks, new


def _looks(
    picture: Image,
    seen: Seen,
    people: People,
    model: LandmarkModel,
    carried: Mapping[int, LandmarkResult],
) -> dict[int, LandmarkResult]:
    """What the network sees where the people who are known were, by their numbers, with those who
    are carried on."""
    others = people.others
    known = {track.number: track.landmarks for track in people.tracks}
    own = known_people.last(people)
    looks = dict(carried)
    if people.followed not in carried:
        theirs = None if own is None else beside(picture, people.followed, known)
        alone, silhouette = without(picture, theirs), _less(seen, theirs)
        look = own_landmarks(alone, silhouette, own, model, crowded=bool(others))
        looks[people.followed] = look
    for track in others:
        if track.number in carried:
            continue
        window = window_of_joints(track.landmarks)
        if window is not None:
            alone = without(picture, beside(picture, track.number, known))
            looks[track.number] = look_in(alone, window, model._replace(twice=False))
    return looks


def _less(seen: Seen, theirs: Bytes | None) -> Seen:
    """A silhouette without others' pixels."""
    if theirs is None or seen.box is None:
        return seen
    mask = np.asarray(cv2.subtract(seen.mask.view(np.uint8), theirs))
    return seen_of(mask, seen.blobs, 0.0)


def _identified(
    people: People, at_s: float, looks: dict[int, LandmarkResult], new: list[LandmarkResult]
) -> tuple[People, dict[int, LandmarkResult]]:
    """The people after a frame, and what is seen of each, by number."""
    results = [*looks.items(), *((None, each) for each in new)]
    given = [
        (Look(number, each.landmarks), each)
        for number, each in results
        if each.landmarks is not None and is_person(each.landmarks)
    ]
    after, numbers = known_people.step(people, at_s, [look for look, _ in given])
    owned = zip(numbers, (each for _, each in given), strict=True)
    return after, {number: each for number, each in owned if number is not None}


def _shown(people: People, shown: dict[int, LandmarkResult]) -> Shown:
    """The people of a frame, the followed one apart: not seen where another look has the place."""
    followed = shown.pop(people.followed, LandmarkResult(None))
    return Shown(followed, people.followed, tuple(sorted(shown.items(), key=NUMBER)))


def _interval_s(people: People, followed: LandmarkResult, seen: Seen) -> float:
    """Time from the last search of the whole picture to the next: short where the followed person
    is not surely seen, or any was out of sight; none where a silhouette is of no known person, of
    whom there may be several."""
    if not people.tracks and seen.box is not None:
        return 0.0
    return SEARCH_S if people.are_seen and followed.surety >= SURE else URGENT_S
