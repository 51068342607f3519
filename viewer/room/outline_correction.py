"""A silhouette held against the landmarks: what is far from the body goes, bones are added."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats
from common.body.observation import Landmarks
from common.compiled import compiled
from viewer.landmarks.body_region import (
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
"""Statures around the body that are left of a silhouette that holds one."""
REACH: Final = 0.1
"""Statures from a bone's axis to the farthest of the body: a hand, a hem."""
MUCH: Final = 0.15
"""Share of a silhouette far from the body, from which that part is an object. Less may be an arm
that the landmarks place elsewhere, and stays."""
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
    seen: Seen, landmarks: Landmarks | None, least_share: float, *, contradicted: bool
) -> Corrected:
    """A silhouette without what the landmarks say is no body, and with what is missing of it.

    Args:
        seen: The silhouette of a frame.
        landmarks: Of the same frame; None, or unsure: the silhouette stands.
        least_share: Of the picture's height; a lower silhouette is no person's.
        contradicted: The silhouette is not the body's alone, however near: a shadow lies beside.
    """
    if not is_trusted(landmarks):
        return Corrected(seen, None, is_changed=False)
    assert landmarks is not None
    mask, things = _without_things(seen, landmarks, 0.0 if contradicted else MUCH)
    missing = _missing(mask, landmarks)
    if things is None and not missing:
        return Corrected(seen, None, is_changed=False)
    for bone in missing:
        mask = cv2.bitwise_or(mask, bone_region(landmarks, mask.shape, bone))
    blobs = max(seen.blobs, 1)
    return Corrected(seen_of(mask, blobs, least_share), things, is_changed=True)


def is_trusted(landmarks: Landmarks | None) -> bool:
    """Whether they may overrule a silhouette: they are sure, and show how large the body is."""
    if landmarks is None or sum(landmarks.confidence) <= TRUSTED * len(landmarks.confidence):
        return False
    return stature_px(landmarks) > 0.0


def _without_things(seen: Seen, landmarks: Landmarks, much: float) -> tuple[Bytes, Bytes | None]:
    """The silhouette (H, W) without what is far from the body, and that; None if it is less than
    that share."""
    bones = [ends for ends in _ENDS.tolist() if shown(landmarks, ends)]
    mask, ends = seen.mask.view(np.uint8), np.array(landmarks.joints_px)[bones]
    share = _far_share(mask, ends, (FAR + REACH) * stature_px(landmarks))
    if share < much:
        return mask, None
    near = cv2.bitwise_and(mask, body_region(landmarks, mask.shape, TIGHT))
    return np.asarray(near), np.asarray(cv2.subtract(mask, near))


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
