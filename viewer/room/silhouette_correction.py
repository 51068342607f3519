"""A silhouette compared with the landmark network: what lies beside the person goes, what it lacks
is added."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats
from common.body.observation import Landmarks
from common.compiled import compiled
from viewer.landmarks.person_mask import LIKELY, LandmarkResult, PersonMask, likeliest
from viewer.room.body_region import (
    BONES,
    Bytes,
    body_region,
    bone_region,
    shown,
    stature_px,
)
from viewer.silhouette.silhouette import Seen, seen_of

TRUSTED: Final = 0.5
"""Landmarks that are surer than this on average are held against a silhouette."""
SURE: Final = 0.6
"""A bone both of whose ends are surer than this is in the silhouette, or is missing there."""
FAR: Final = 0.2
"""Statures from the body at which a silhouette is a thing's: a door's, a shadow's."""
TIGHT: Final = 0.06
"""Statures around the bones of an outside source that are left of a silhouette."""
POSSIBLE: Final = 0.2
"""Probability that a pixel shows the person from which on a silhouette's pixel stays; from LIKELY
on one is added."""
CERTAIN: Final = 0.8
"""Probability from which a pixel is added to a silhouette that is a guess: with POSSIBLE, the odds
of both together, where such a silhouette is right in four pixels of five."""
LACKING: Final = 0.35
"""Share of the likely person from which a silhouette that lacks it is completed; 0.23 at most in
720 frames of synthetic people whose silhouettes are whole (docs/measurements.md)."""
SEEN: Final = 0.3
"""Mean confidence of landmarks from which on the network is sure where the person is."""
REACH: Final = 0.1
"""Statures from a bone's axis to the farthest of the body: a hand, a hem."""
MUCH: Final = 0.15
"""Share of a silhouette beside the body, from which that part is an object. Less may be an arm that
the landmarks place elsewhere, and stays; it is 0.05 in 99 % of the same frames."""
COVERED: Final = 0.35
"""A bone with less of its axis in the silhouette is missing there."""
FEW: Final = 1
"""No more than this is missing of whole silhouettes: a shank or a forearm whose side was
mistaken."""
ALONG: Final = 9
"""Places along a bone where that is asked."""
STRIDE: Final = 3
"""Of a silhouette's rows and columns so many are passed over between two that are looked at."""
_ENDS: Final = np.array([(near, far) for near, far, _ in BONES])


class Corrected(NamedTuple):
    """A silhouette, as the landmarks let it stand."""

    seen: Seen
    things: Bytes | None
    """(H, W) 1 where the silhouette was not the body's; None where it all may be."""
    is_changed: bool


def corrected(
    seen: Seen, result: LandmarkResult, least_share: float, others: Sequence[PersonMask] = ()
) -> Corrected:
    """A silhouette without what is no body, and with what is missing of it.

    Args:
        seen: The silhouette of a frame.
        result: Landmarks of the same frame; None, or unsure: the silhouette stands. Our own network
            also shows where the person is; of an outside source's person the bones alone are known.
        least_share: Of the picture's height; a lower silhouette is no person's.
        others: Other people in the picture: pixels that are more probably theirs are not the
            person's.
    """
    landmarks, whole = result.landmarks, seen.mask.view(np.uint8)
    if landmarks is None:
        return Corrected(seen, None, is_changed=False)
    theirs = likeliest(others, result.person, whole.shape) if others else None
    mask = _less(whole, theirs)
    if result.person is not None and result.surety < SEEN:
        body, things = mask, None
    elif result.person is not None:
        shown = result.person.over(whole.shape, POSSIBLE, CERTAIN if seen.is_guess else LIKELY)
        possible, likely = (_less(each, theirs) for each in shown)
        body, things = _by_person(mask, possible, likely, seen.is_guess)
    else:
        body, things = _by_bones(mask, landmarks)
    if body is whole:
        return Corrected(seen, None, is_changed=False)
    found = seen_of(body, max(seen.blobs, 1), least_share)
    return Corrected(found, things, is_changed=True)


def _less(mask: Bytes, theirs: Bytes | None) -> Bytes:
    """A mask (H, W) without the pixels of other people; itself where it has none of them."""
    if theirs is None or not cv2.countNonZero(cv2.bitwise_and(mask, theirs)):
        return mask
    return np.asarray(cv2.subtract(mask, theirs))


def _by_person(
    mask: Bytes, possible: Bytes, likely: Bytes, is_guess: bool
) -> tuple[Bytes, Bytes | None]:
    """The body (H, W) where the network sees the person, and what else was in the silhouette; None
    if that is little. The silhouette itself where it is no guess, and both agree."""
    near, known = cv2.bitwise_and(mask, possible), cv2.bitwise_and(mask, likely)
    beside = cv2.countNonZero(mask) - cv2.countNonZero(near)
    lacking = cv2.countNonZero(likely) - cv2.countNonZero(known)
    is_cut = beside >= MUCH * max(1, cv2.countNonZero(mask))
    is_whole = lacking < LACKING * max(1, cv2.countNonZero(likely))
    if is_whole and not is_cut and not is_guess:
        return mask, None
    body = np.asarray(cv2.bitwise_or(near, likely))
    return body, np.asarray(cv2.subtract(mask, body)) if is_cut else None


def _by_bones(mask: Bytes, landmarks: Landmarks) -> tuple[Bytes, Bytes | None]:
    """The same by bones alone."""
    if not is_trusted(landmarks):
        return mask, None
    body, things = mask, None
    if _far_share_of(mask, landmarks) >= MUCH:
        body = np.asarray(cv2.bitwise_and(mask, body_region(landmarks, mask.shape, TIGHT)))
        things = np.asarray(cv2.subtract(mask, body))
    for bone in _missing(body, landmarks):
        body = np.asarray(cv2.bitwise_or(body, bone_region(landmarks, mask.shape, bone)))
    return body, things


def is_trusted(landmarks: Landmarks | None) -> bool:
    """Whether they may overrule a silhouette: they are sure, and show how large the body is."""
    if landmarks is None or sum(landmarks.confidence) <= TRUSTED * len(landmarks.confidence):
        return False
    return stature_px(landmarks) > 0.0


def _far_share_of(mask: Bytes, landmarks: Landmarks) -> float:
    """Share of a silhouette (H, W) that is far from all bones."""
    bones = [ends for ends in _ENDS.tolist() if shown(landmarks, ends)]
    ends = np.array(landmarks.joints_px)[bones]
    return _far_share(mask, ends, (FAR + REACH) * stature_px(landmarks))


@compiled
def _far_share(mask: NDArray[np.uint8], ends: Floats, reach_px: float) -> float:
    """Share of a silhouette (H, W) farther than that from all of the bones (n, 2, 2)."""
    all_of, far = 0, 0
    for y in range(0, mask.shape[0], STRIDE):
        for x in range(0, mask.shape[1], STRIDE):
            if not mask[y, x]:
                continue
            all_of += 1
            near = False
            for n in range(len(ends)):
                if _distance_2(x + 0.5, y + 0.5, ends[n]) <= reach_px * reach_px:
                    near = True
                    break
            far += not near
    return far / max(1, all_of)


@compiled
def _distance_2(x: float, y: float, ends: Floats) -> float:
    """Squared distance of a place from a bone (2, 2)."""
    along_x, along_y = ends[1, 0] - ends[0, 0], ends[1, 1] - ends[0, 1]
    from_x, from_y = x - ends[0, 0], y - ends[0, 1]
    length_2 = max(along_x * along_x + along_y * along_y, 1e-9)
    share = min(max((from_x * along_x + from_y * along_y) / length_2, 0.0), 1.0)
    off_x, off_y = from_x - share * along_x, from_y - share * along_y
    return off_x * off_x + off_y * off_y


def _missing(mask: Bytes, landmarks: Landmarks) -> list[int]:
    """Which of BONES are surely there, and not in the silhouette; none where they are FEW."""
    confidence = np.array(landmarks.confidence)[_ENDS].min(axis=1)
    covered = _covered(mask, np.array(landmarks.joints_px)[_ENDS])
    missing: list[int] = np.flatnonzero((confidence > SURE) & (covered < COVERED)).tolist()
    return missing if len(missing) > FEW else []


@compiled
def _covered(mask: NDArray[np.uint8], ends: Floats) -> Floats:
    """Share of the axis of each bone (n, 2, 2) that a silhouette covers; 1 outside of the
    picture."""
    out = np.ones(len(ends))
    for n in range(len(ends)):
        shown, inside = 0, 0
        for k in range(ALONG):
            share = (k + 1.0) / (ALONG + 1.0)
            x = int(ends[n, 0, 0] + share * (ends[n, 1, 0] - ends[n, 0, 0]))
            y = int(ends[n, 0, 1] + share * (ends[n, 1, 1] - ends[n, 0, 1]))
            if 0 <= x < mask.shape[1] and 0 <= y < mask.shape[0]:
                shown += 1
                inside += mask[y, x] > 0
        if shown:
            out[n] = inside / shown
    return out
