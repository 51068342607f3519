"""The people in a frame, as a message says them: the followed one first."""

from typing import Final

import msgspec

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks, Observation
from common.raster.silhouette_report import pack
from common.video.pictures import Image
from viewer.landmarks.person_mask import LIKELY, LandmarkResult, PersonMask, Shown, likeliest
from viewer.people.clothes_colours import clothes_colours
from viewer.room.silhouette_correction import corrected
from viewer.silhouette import silhouette
from viewer.silhouette.silhouette import Seen, seen_of

PELVIS: Final = JOINT_NAMES.index("pelvis")


def observed(seen: Seen, shown: Shown, least_share: float) -> tuple[Observation, ...]:
    """The people of a frame: none where the followed one is not seen, as the first is followed.

    Others have the silhouette that the network of landmarks gives them, less what is more probably
    another person's; one that is too low is left out.

    Args:
        seen: The followed person's silhouette.
        shown: What the network sees.
        least_share: Of the picture's height; a lower silhouette is no person's.
    """
    first = _observation(seen, shown.followed.landmarks, shown.number)
    if first is None or (shown.others and shown.followed.landmarks is None):
        return ()
    followed = shown.followed.person
    rest = (
        _other(number, result, _rivals(shown, number, followed), seen, least_share)
        for number, result in shown.others
    )
    return (first, *(each for each in rest if each is not None))


def everyone(
    room: silhouette.State, picture: Image, seen: Seen, shown: Shown, least_share: float
) -> tuple[Observation, ...]:
    """All who are seen in a frame, each with a silhouette as the followed person's is found, and
    the colours of their clothes.

    Args:
        room: The background, in the light of the frame.
        picture: (H, W, 3).
        seen: The followed person's silhouette.
        shown: What the network sees.
        least_share: Of the picture's height; a lower silhouette is no person's.
    """
    people = [] if shown.followed.landmarks is None else [(shown.number, seen, shown.followed)]
    for number, result in shown.others:
        if result.landmarks is not None:
            first = silhouette.at(room, picture, result.landmarks.joints_px[PELVIS])
            rivals = _rivals(shown, number, shown.followed.person)
            people.append((number, corrected(first, result, least_share, rivals).seen, result))
    each = (_observation(own, result.landmarks, number) for number, own, result in people)
    return tuple(
        msgspec.structs.replace(one, colours=clothes_colours(picture, one))
        for one in each
        if one is not None
    )


def _rivals(shown: Shown, number: int, followed: PersonMask | None) -> list[PersonMask]:
    """Where the people other than one of the others are."""
    masks = (followed, *(each.person for other, each in shown.others if other != number))
    return [mask for mask in masks if mask is not None]


def _other(
    number: int, result: LandmarkResult, rivals: list[PersonMask], seen: Seen, least_share: float
) -> Observation | None:
    """One of the others; None where they are too low."""
    if result.person is None:
        return None
    (mask,) = result.person.over(seen.mask.shape, LIKELY)
    if rivals:
        mask[likeliest(rivals, result.person, mask.shape) > 0] = 0
    mask[seen.mask] = 0
    return _observation(seen_of(mask, 1, least_share), result.landmarks, number)


def _observation(seen: Seen, landmarks: Landmarks | None, track: int) -> Observation | None:
    """A person with a silhouette; None without one."""
    if seen.box is None:
        return None
    height, width = seen.mask.shape
    return Observation(
        track=track,
        width=width,
        height=height,
        silhouette=pack(seen.mask),
        box=seen.box,
        area_px=seen.area_px,
        cut=seen.cut,
        landmarks=landmarks,
    )
