"""Outlines held against landmarks: doors go, legs of the floor's colour come, whole ones stay."""

import cv2
import msgspec
import numpy as np
import pytest
from test_body_region import true_landmarks, without
from test_own_landmarks import acted, nobody, seen

from common.body.observation import Landmarks
from common.raster.similarity import Mask
from viewer.landmarks.landmark_window import Window
from viewer.landmarks.person_mask import LandmarkResult, PersonMask
from viewer.room.silhouette_correction import _covered, _distance_2, _far_share, corrected


def iou(one: Mask, other: Mask) -> float:
    return float((one & other).sum() / (one | other).sum())


def unsure() -> Landmarks:
    return msgspec.structs.replace(true_landmarks(), confidence=(0.3,) * 15)


def with_door() -> tuple[Mask, Mask]:
    """The person's outline with a door that they do not touch, and the true one."""
    mask = acted()[0].masks[0]
    cluttered = mask.copy()
    cluttered[40:220, 5:60] = True
    return cluttered, mask


def without_legs() -> tuple[Mask, Mask]:
    """The person's outline without the legs, and the true one."""
    mask = acted()[0].masks[0]
    rows = np.flatnonzero(mask.any(axis=1))
    ragged = mask.copy()
    ragged[(rows[0] + rows[-1]) // 2 :] = False
    return ragged, mask


def test_a_whole_outline_stays_as_it_is() -> None:
    own = seen(acted()[0].masks[0])
    held = corrected(own, LandmarkResult(true_landmarks()), 0.15)
    assert held.seen is own
    assert not held.is_changed


def test_a_door_goes_and_is_told_to_be_a_thing() -> None:
    cluttered, mask = with_door()
    held = corrected(seen(cluttered), LandmarkResult(true_landmarks()), 0.15)
    assert iou(held.seen.mask, mask) > 0.9 > iou(cluttered, mask)
    assert held.things is not None
    assert held.things[100, 20] == 1
    assert not (held.things[mask]).any()


def true_person(confidence: float = 0.9) -> LandmarkResult:
    """The network sees the person as they are, in cells of a window of all of the picture."""
    window = Window(0, -40, 320)
    cells = cv2.resize(acted()[0].masks[0].astype(np.float32), (320, 240))
    square = cv2.copyMakeBorder(cells, 40, 40, 0, 0, cv2.BORDER_CONSTANT)
    logits = 12.0 * cv2.resize(square, (48, 48), interpolation=cv2.INTER_AREA) - 6.0
    sure = msgspec.structs.replace(true_landmarks(), confidence=(confidence,) * 15)
    return LandmarkResult(sure, PersonMask(logits, window))


def test_a_shadow_beside_the_body_goes_where_the_network_does_not_see_the_person() -> None:
    """The person's silhouette once more beside them, so near that it may be an arm's."""
    mask = acted()[0].masks[0]
    shaded = mask | np.roll(mask, round(0.2 * acted()[2]), axis=1)
    own = seen(shaded)
    assert not corrected(own, LandmarkResult(true_landmarks()), 0.15).is_changed
    held = corrected(own, true_person(), 0.15)
    assert iou(held.seen.mask, mask) > 0.75 > iou(shaded, mask) + 0.1
    assert held.things is not None
    assert not (held.things & held.seen.mask).any()


def test_what_a_silhouette_lacks_of_the_person_is_added_and_a_whole_one_stays() -> None:
    for given in (without_legs()[0], np.zeros((240, 320), np.bool_)):
        own = seen(given) if given.any() else nobody()
        held = corrected(own, true_person(), 0.15)
        assert iou(held.seen.mask, acted()[0].masks[0]) > 0.75
        assert held.things is None
    whole = seen(acted()[0].masks[0])
    assert corrected(whole, true_person(), 0.15).seen is whole


def test_a_pixel_that_may_be_the_person_stays_and_is_not_added() -> None:
    """The right half of the picture is .3 likely, the left not at all; a person in neither."""
    logits = np.full((48, 48), -6.0, np.float32)
    logits[:, 24:] = np.log(0.3 / 0.7)
    given = LandmarkResult(true_person().landmarks, PersonMask(logits, Window(0, -40, 320)))
    mask = np.zeros((240, 320), np.bool_)
    mask[60:200, 100:220] = True
    held = corrected(seen(mask), given, 0.15)
    assert held.seen.box is not None
    assert held.seen.box.left == pytest.approx(160, abs=4)
    assert held.seen.box.right == 219
    assert not (held.seen.mask & ~mask).any()


def test_a_guess_and_the_network_are_held_against_each_other_pixel_by_pixel() -> None:
    """Four bands of the picture, the person .1, .3, .7 and .9 likely; the guess fills every second
    row. A guess is right in four pixels of five, so its odds are 4 to 1, or 1 to 4."""
    chances = np.repeat([0.1, 0.3, 0.7, 0.9], 12)
    logits = np.tile(np.log(chances / (1.0 - chances)).astype(np.float32), (48, 1))
    given = LandmarkResult(true_person().landmarks, PersonMask(logits, Window(0, -40, 320)))
    mask = np.zeros((240, 320), np.bool_)
    mask[20:220:2] = True
    held = corrected(seen(mask)._replace(is_guess=True), given, 0.15).seen.mask
    for middle, chance in zip((40, 120, 200, 280), (0.1, 0.3, 0.7, 0.9), strict=True):
        odds = chance / (1.0 - chance)
        assert held[100, middle] == (4.0 * odds > 1.0), chance
        assert held[101, middle] == (0.25 * odds > 1.0), chance


def test_a_guess_that_agrees_with_the_network_is_whole_too() -> None:
    """A halo of a sixth of it goes, which in a silhouette that is no guess may be an arm."""
    mask = acted()[0].masks[0]
    wide = cv2.dilate(mask.astype(np.uint8), np.ones((1, 3), np.uint8)) > 0
    wide |= np.roll(wide, 4, axis=1) & ~np.roll(wide, -9, axis=1)
    assert iou(corrected(seen(wide), true_person(), 0.15).seen.mask, wide) == 1.0
    held = corrected(seen(wide)._replace(is_guess=True), true_person(), 0.15)
    assert iou(held.seen.mask, mask) > iou(wide, mask) + 0.03


def test_where_the_network_is_not_sure_the_silhouette_stands() -> None:
    own = seen(without_legs()[0])
    assert corrected(own, true_person(0.29), 0.15).seen is own
    assert corrected(own, true_person(0.31), 0.15).is_changed


def test_legs_of_the_floors_colour_come() -> None:
    ragged, mask = without_legs()
    held = corrected(seen(ragged), LandmarkResult(true_landmarks()), 0.15)
    assert iou(held.seen.mask, mask) > 0.75 > iou(ragged, mask)
    assert held.seen.box is not None
    assert held.things is None


def test_somebody_of_the_walls_colour_gets_an_outline() -> None:
    mask = acted()[0].masks[0]
    held = corrected(nobody(), LandmarkResult(true_landmarks()), 0.15)
    assert iou(held.seen.mask, mask) > 0.6


def test_unsure_landmarks_change_nothing() -> None:
    for mask, _ in (with_door(), without_legs()):
        assert not corrected(seen(mask), LandmarkResult(unsure()), 0.15).is_changed
    assert not corrected(seen(mask), LandmarkResult(None), 0.15).is_changed


def test_a_door_goes_though_no_ankle_is_seen() -> None:
    cluttered, mask = with_door()
    held = corrected(seen(cluttered), LandmarkResult(without("l_ankle", "r_ankle")), 0.15)
    assert iou(held.seen.mask, mask) > 0.85 > iou(cluttered, mask)


def test_landmarks_that_tell_no_size_overrule_nothing() -> None:
    own = seen(with_door()[0])
    assert corrected(own, LandmarkResult(without("pelvis", "l_knee", "r_knee")), 0.15).seen is own


def plain_distance(x: float, y: float, ends: np.ndarray) -> float:
    """To the nearest of many places along a bone."""
    along = ends[0] + np.linspace(0.0, 1.0, 4001)[:, None] * (ends[1] - ends[0])
    return float(np.hypot(along[:, 0] - x, along[:, 1] - y).min())


@pytest.mark.parametrize("place", [(3.0, 20.0), (30.0, 8.0), (12.0, 14.0), (25.0, 31.0)])
def test_a_place_is_as_far_from_a_bone_as_from_its_nearest_point(
    place: tuple[float, float],
) -> None:
    ends = np.array([[8.0, 12.0], [22.0, 19.0]])
    assert np.sqrt(_distance_2(*place, ends)) == pytest.approx(
        plain_distance(*place, ends), abs=1e-3
    )
    point = np.array([[8.0, 12.0], [8.0, 12.0]])
    assert _distance_2(11.0, 16.0, point) == pytest.approx(25.0)


def test_the_share_of_an_outline_far_from_all_bones_is_that_of_every_third_pixel() -> None:
    mask = np.random.default_rng(6).integers(0, 2, (40, 61)).astype(np.uint8)
    bones = np.array([[[8.0, 12.0], [22.0, 19.0]], [[45.0, 3.0], [50.0, 30.0]]])
    far = [
        min(plain_distance(x + 0.5, y + 0.5, ends) for ends in bones) > 7.0
        for y in range(0, 40, 3)
        for x in range(0, 61, 3)
        if mask[y, x]
    ]
    assert 0.2 < np.mean(far) < 0.8
    assert _far_share(mask, bones, 7.0) == pytest.approx(np.mean(far))
    assert _far_share(np.zeros_like(mask), bones, 7.0) == 0.0


def test_a_bone_is_covered_where_its_places_are_in_the_outline() -> None:
    """Nine places, tenths of the way apart; those outside of the picture are not asked for."""
    mask = np.zeros((30, 40), np.uint8)
    mask[:, :15] = 1
    bones = np.array(
        [
            [[5.0, 10.0], [25.0, 10.0]],  # 7, 9, 11, 13 of 7 to 23
            [[20.0, 2.0], [20.0, 28.0]],
            [[5.0, 5.0], [5.0, 45.0]],  # 9 to 29, then outside
            [[-30.0, 5.0], [-10.0, 5.0]],
            [[30.0, 25.0], [50.0, 25.0]],
        ]
    )
    assert _covered(mask, bones).tolist() == pytest.approx([4 / 9, 0.0, 1.0, 1.0, 0.0])
