"""Outlines held against landmarks: doors go, legs of the floor's colour come, whole ones stay."""

import msgspec
import numpy as np
from test_body_region import true_landmarks, without
from test_own_landmarks import acted, nobody, seen

from common.bus.messages import Landmarks
from common.raster.similarity import Mask
from viewer.room.outline_correction import corrected


def iou(one: Mask, other: Mask) -> float:
    return float((one & other).sum() / (one | other).sum())


def unsure() -> Landmarks:
    return msgspec.structs.replace(true_landmarks(), confidence=(0.3,) * 15)


def with_door() -> tuple[Mask, Mask]:
    """The person's outline with a door that they do not touch, and the true one."""
    mask = acted()[0].mask1
    cluttered = mask.copy()
    cluttered[40:220, 5:60] = True
    return cluttered, mask


def without_legs() -> tuple[Mask, Mask]:
    """The person's outline without the legs, and the true one."""
    mask = acted()[0].mask1
    rows = np.flatnonzero(mask.any(axis=1))
    ragged = mask.copy()
    ragged[(rows[0] + rows[-1]) // 2 :] = False
    return ragged, mask


def test_a_whole_outline_stays_as_it_is() -> None:
    own = seen(acted()[0].mask1)
    held = corrected(own, true_landmarks(), 0.15)
    assert held.seen is own
    assert not held.is_changed


def test_a_door_goes_and_is_told_to_be_a_thing() -> None:
    cluttered, mask = with_door()
    held = corrected(seen(cluttered), true_landmarks(), 0.15)
    assert iou(held.seen.mask, mask) > 0.9 > iou(cluttered, mask)
    assert held.things is not None
    assert held.things[100, 20] == 1
    assert not (held.things[mask]).any()


def test_legs_of_the_floors_colour_come() -> None:
    ragged, mask = without_legs()
    held = corrected(seen(ragged), true_landmarks(), 0.15)
    assert iou(held.seen.mask, mask) > 0.75 > iou(ragged, mask)
    assert held.seen.box is not None
    assert held.things is None


def test_somebody_of_the_walls_colour_gets_an_outline() -> None:
    mask = acted()[0].mask1
    held = corrected(nobody(), true_landmarks(), 0.15)
    assert iou(held.seen.mask, mask) > 0.6


def test_unsure_landmarks_change_nothing() -> None:
    for mask, _ in (with_door(), without_legs()):
        assert not corrected(seen(mask), unsure(), 0.15).is_changed
    assert not corrected(seen(mask), None, 0.15).is_changed


def test_a_door_goes_though_no_ankle_is_seen() -> None:
    cluttered, mask = with_door()
    held = corrected(seen(cluttered), without("l_ankle", "r_ankle"), 0.15)
    assert iou(held.seen.mask, mask) > 0.85 > iou(cluttered, mask)


def test_landmarks_that_tell_no_size_overrule_nothing() -> None:
    own = seen(with_door()[0])
    assert corrected(own, without("pelvis", "l_knee", "r_knee"), 0.15).seen is own
