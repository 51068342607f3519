"""The body's region in a picture, held against the silhouette of a rendered person."""

import cv2
import numpy as np
import pytest
from test_own_landmarks import acted

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from viewer.room.body_region import BONES, body_region, bone_region, stature_px


def true_landmarks() -> Landmarks:
    joints_px = acted()[1]
    return Landmarks(tuple((float(x), float(y)) for x, y in joints_px), (1.0,) * 15)


def test_the_stature_is_that_of_the_person() -> None:
    assert stature_px(true_landmarks()) == pytest.approx(acted()[2], rel=0.1)


def test_the_region_is_nearly_the_silhouette_and_a_little_more_holds_it() -> None:
    mask = acted()[0].masks[0]
    own = body_region(true_landmarks(), mask.shape, 0.0) > 0
    assert (own & mask).sum() / (own | mask).sum() > 0.7
    assert (mask & ~(body_region(true_landmarks(), mask.shape, 0.06) > 0)).mean() < 0.0005


def test_all_bones_together_are_no_more_than_the_region() -> None:
    mask = acted()[0].masks[0]
    bones = [bone_region(true_landmarks(), mask.shape, n) for n in range(len(BONES))]
    whole = body_region(true_landmarks(), mask.shape, 0.01) > 0
    assert not (np.any(bones, axis=0) & ~whole).any()


def without(*names: str) -> Landmarks:
    """These joints unseen, as keypoint files write them: anywhere, with confidence 0."""
    known, gone = true_landmarks(), [JOINT_NAMES.index(name) for name in names]
    places = [(0.0, 0.0) if n in gone else place for n, place in enumerate(known.joints_px)]
    sure = [0.0 if n in gone else 1.0 for n in range(len(places))]
    return Landmarks(tuple(places), tuple(sure))


def test_what_is_not_seen_makes_nobody_taller_and_is_not_drawn() -> None:
    mask = acted()[0].masks[0]
    unseen = without("l_ankle", "r_ankle", "l_wrist")
    assert stature_px(unseen) == pytest.approx(stature_px(true_landmarks()), rel=0.15)
    own, whole = (body_region(each, mask.shape, 0.0) > 0 for each in (unseen, true_landmarks()))
    assert own.sum() < whole.sum()
    assert (own & ~whole).mean() < 0.002


def test_of_whom_nothing_long_is_seen_nothing_is_told() -> None:
    assert stature_px(without("pelvis", "l_knee", "r_knee")) == 0.0


PLACES = {
    **{"pelvis": (60.0, 70.0), "neck": (64.0, 38.0), "head_top": (66.0, 24.0)},
    **{"l_shoulder": (74.0, 42.0), "l_elbow": (90.0, 50.0), "l_wrist": (104.0, 42.0)},
    **{"r_shoulder": (54.0, 42.0), "r_elbow": (44.0, 56.0), "r_wrist": (30.0, 60.0)},
    **{"l_hip": (65.0, 71.0), "l_knee": (74.0, 92.0), "l_ankle": (72.0, 116.0)},
    **{"r_hip": (55.0, 70.0), "r_knee": (50.0, 95.0), "r_ankle": (44.0, 118.0)},
}
TALL_PX = float(np.hypot(5.0, 25.0)) / 0.244
"""By the right thigh, the least foreshortened: (50, 95) - (55, 70) of a length of 0.244."""


def posed(unseen: tuple[str, ...] = ()) -> Landmarks:
    sure = [0.0 if name in unseen else 0.8 for name in JOINT_NAMES]
    return Landmarks(tuple(PLACES[name] for name in JOINT_NAMES), tuple(sure))


def off(near: tuple[float, float], far: tuple[float, float]) -> np.ndarray:
    """(130, 120) how far the middle of each pixel is from a line."""
    at = np.stack(np.meshgrid(np.arange(120) + 0.5, np.arange(130) + 0.5), axis=-1)
    start, along = np.array(near), np.array(far) - np.array(near)
    share = ((at - start) @ along / max(float(along @ along), 1e-9)).clip(0.0, 1.0)
    return np.asarray(np.linalg.norm(at - start - share[..., None] * along, axis=2))


def capsules(beyond: float) -> list[tuple[np.ndarray, float]]:
    """How far pixels are from each bone, hand and foot, and how far these reach, px."""
    found = []
    for near, far, radius in (
        ("neck", "head_top", 0.055),
        ("pelvis", "neck", 0.085),
        *((f"{s}_{a}", f"{s}_{b}", r) for s in "lr" for a, b, r in (
            ("hip", "knee", 0.05), ("knee", "ankle", 0.035),
            ("shoulder", "elbow", 0.03), ("elbow", "wrist", 0.024),
        )),
    ):  # fmt: skip
        found.append((off(PLACES[near], PLACES[far]), (radius + beyond) * TALL_PX))
    for side in "lr":
        elbow, wrist = (np.array(PLACES[f"{side}_{name}"]) for name in ("elbow", "wrist"))
        hand = tuple(wrist + 0.5 * (wrist - elbow))
        found.append((off(PLACES[f"{side}_wrist"], hand), (0.024 + beyond) * TALL_PX))
        ankle = PLACES[f"{side}_ankle"]
        found.append((off(ankle, ankle), (0.045 + beyond) * TALL_PX))
    return found


def test_the_stature_is_by_the_long_bone_that_is_least_foreshortened_and_seen() -> None:
    assert stature_px(posed()) == pytest.approx(TALL_PX)
    trunk = float(np.hypot(4.0, 32.0)) / 0.322
    shank = float(np.hypot(2.0, 24.0)) / 0.249
    left = float(np.hypot(9.0, 21.0)) / 0.244
    assert stature_px(posed(("r_knee",))) == pytest.approx(max(trunk, shank, left))
    assert stature_px(posed(("r_knee", "pelvis", "l_hip"))) == pytest.approx(shank)


@pytest.mark.parametrize("beyond", [0.0, 0.04])
def test_the_region_is_what_lies_about_bones_hands_feet_and_between_the_corners_of_the_trunk(
    beyond: float,
) -> None:
    """Within a pixel and a half of capsules worked out pixel by pixel."""
    found = body_region(posed(), (130, 120, 3), beyond) > 0
    surely = np.any([far <= reach - 1.0 for far, reach in capsules(beyond)], axis=0)
    corners = [PLACES[name] for name in ("l_shoulder", "r_shoulder", "r_hip", "l_hip")]
    maybe = np.any([far <= reach + 1.5 for far, reach in capsules(beyond)], axis=0)
    polygon = np.array(corners, np.float32)
    depth = [
        [cv2.pointPolygonTest(polygon, (x + 0.5, y + 0.5), True) for x in range(120)]
        for y in range(130)
    ]
    trunk, trunk_most = np.array(depth) > 1.5, np.array(depth) > -1.5
    assert found[surely | trunk].all()
    assert not found[~(maybe | trunk_most)].any()


def test_each_bone_has_its_own_width_and_forearms_hands_shanks_feet() -> None:
    parts = capsules(0.0)
    for bone in range(len(BONES)):
        found = bone_region(posed(), (130, 120, 3), bone) > 0
        near, far, radius = BONES[bone]
        names = JOINT_NAMES[near], JOINT_NAMES[far]
        own = [(off(PLACES[names[0]], PLACES[names[1]]), radius * TALL_PX)]
        side = "lr".index(names[1][0]) if names[1][1] == "_" else 0
        if names[1].endswith("wrist"):
            own.append(parts[10 + 2 * side])
        if names[1].endswith("ankle"):
            own.append(parts[11 + 2 * side])
        assert found[np.any([off_px <= reach - 1.0 for off_px, reach in own], axis=0)].all()
        assert not found[np.all([off_px >= reach + 1.5 for off_px, reach in own], axis=0)].any()


def test_a_trunk_of_three_corners_is_filled_and_of_two_is_not() -> None:
    """Between the left shoulder and both hips, away from the bones that are not seen."""
    unseen = ("pelvis", "neck", "head_top", "l_knee", "r_knee", "l_elbow", "r_elbow")
    inside = (55, 67)
    assert body_region(posed((*unseen, "r_shoulder")), (130, 120), 0.0)[inside] == 1
    assert body_region(posed((*unseen, "r_shoulder", "r_hip")), (130, 120), 0.0)[inside] == 0
