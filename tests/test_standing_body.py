"""Who stands in the median picture of a clip, held against rendered people whose mask is known."""

import msgspec
import numpy as np
from test_judged_background import film
from test_own_landmarks import RIG

from synth.motion.motions import MOTION, performance
from synth.person.people import person
from synth.picture.render import render
from viewer.background.image_stack import median
from viewer.room.room_people import Look, looked_at
from viewer.room.standing_body import standing


def test_somebody_who_stays_is_found_whole() -> None:
    """Better than the surest landmarks alone draw them."""
    someone = person(4321)
    motion = performance(someone, "raise_both_lateral", 3)
    shots = list(render(someone, motion, RIG, 77, 3))
    shown = [s for s, phase in zip(shots, motion.phase, strict=True) if phase == MOTION][::4]
    frames, masks = [s.frame1 for s in shown], np.stack([s.mask1 for s in shown])
    looks = looked_at(frames)
    found, true = standing(median(frames), looks), masks.mean(axis=0) > 0.5
    surest = max(looks, key=lambda look: sum(look.landmarks.confidence))
    assert iou(found, true) > max(0.75, iou(surest.region(true.shape, 0.0) > 0, true))


def test_nobody_stands_where_nobody_is() -> None:
    empty, frames, _ = film()
    nobody = [Look(look.landmarks, is_somebody=False) for look in looked_at(frames)]
    assert not standing(empty.astype(np.float32), nobody).any()


def test_what_is_larger_than_anybody_is_nobody() -> None:
    """Landmarks of a picture that shows nobody may lie anywhere."""
    empty, frames, _ = film()
    high, wide = empty.shape[:2]
    looks = []
    for look in looked_at(frames):
        places = np.array(look.landmarks.joints_px)
        places = (places - places.mean(axis=0)) * 3.0 + (wide / 2, high / 2)
        joints_px = tuple((float(x), float(y)) for x, y in places)
        landmarks = msgspec.structs.replace(look.landmarks, joints_px=joints_px)
        looks.append(Look(landmarks, is_somebody=True))
    assert not standing(median(frames), looks).any()


def iou(one: np.ndarray, other: np.ndarray) -> float:
    return float((one & other).sum() / (one | other).sum())
