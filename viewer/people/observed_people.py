"""The people in a frame, as a message reports them: the followed one first."""

from typing import Final

import msgspec
import numpy as np

from common.body.body import JOINT_NAMES
from common.body.observation import Observation
from common.raster.silhouette_report import pack
from common.video.pictures import Image
from viewer.landmarks.person_mask import LandmarkResult, PersonMask, Shown
from viewer.people.clothes_colours import clothes_colours
from viewer.room.silhouette_correction import corrected
from viewer.silhouette import silhouette
from viewer.silhouette.silhouette import Seen, seen_of

PELVIS: Final = JOINT_NAMES.index("pelvis")


def everyone(
    room: silhouette.State, picture: Image, seen: Seen, shown: Shown, least_share: float
) -> tuple[Observation, ...]:
    """All who are seen in a frame, the followed person first, each with a silhouette as theirs is
    found; who has landmarks with the colours of their clothes. Where no landmarks show any person,
    the silhouette alone is the followed one.

    Args:
        room: The background, in the light of the frame.
        picture: (H, W, 3).
        seen: The followed person's silhouette.
        shown: What the network sees.
        least_share: Of the picture's height; a lower silhouette is no person's.
    """
    is_seen = shown.followed.landmarks is not None or not shown.others
    people = [(shown.number, seen, shown.followed)] if is_seen else []
    for number, result in shown.others:
        if result.landmarks is not None:
            first = silhouette.at(room, picture, result.landmarks.joints_px[PELVIS])
            rivals = _rivals(shown, number, shown.followed.person)
            own = corrected(first, result, least_share, rivals).seen
            own = _less(own, seen, least_share) if is_seen else own
            people.append((number, own, result))
    each = (_observation(own, result, number) for number, own, result in people)
    return tuple(_coloured(picture, one) for one in each if one is not None)


def _less(own: Seen, followed: Seen, least_share: float) -> Seen:
    """A silhouette without the followed person's pixels."""
    shared = own.mask & followed.mask
    if not shared.any():
        return own
    return seen_of((own.mask & ~shared).view(np.uint8), own.blobs, least_share)


def _coloured(picture: Image, one: Observation) -> Observation:
    if one.landmarks is None:
        return one
    return msgspec.structs.replace(one, colours=clothes_colours(picture, one))


def _rivals(shown: Shown, number: int, followed: PersonMask | None) -> list[PersonMask]:
    """Where the people other than one of the others are."""
    masks = (followed, *(each.person for other, each in shown.others if other != number))
    return [mask for mask in masks if mask is not None]


def _observation(seen: Seen, shown: LandmarkResult, track: int) -> Observation | None:
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
        landmarks=shown.landmarks,
        carried=shown.carried,
    )
