"""Pictures of people of the Anny model, held against what they say of themselves."""

import numpy as np
import pytest

pytest.importorskip("anny", reason="Anny's people need the extra `train`")

from common.body.body import JOINT_NAMES
from synth.anny_people.anny_examples import anny_examples
from synth.picture.picture_examples import PICTURES, SIDE_PX, PictureExample, picture_examples

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def shown() -> list[PictureExample]:
    return [each for seed in range(12) for each in anny_examples(seed)]


def within(each: PictureExample) -> np.ndarray:
    at = np.floor(each.joints_px)
    return np.asarray(((at >= 0) & (at < SIDE_PX)).all(axis=1))


def test_joints_lie_in_the_body(shown: list[PictureExample]) -> None:
    inside = np.zeros((len(shown), len(JOINT_NAMES)))
    for row, each in zip(inside, shown, strict=True):
        seen = within(each)
        x, y = np.floor(each.joints_px).astype(int)[seen].T
        row[seen], row[~seen] = each.body[y, x, 3] > 0, np.nan
    assert np.nanmean(inside, axis=0).min() > 0.95


def test_left_is_on_the_right_of_whoever_faces_the_camera_upright(
    shown: list[PictureExample],
) -> None:
    left, right, neck, pelvis = (
        JOINT_NAMES.index(name) for name in ("l_shoulder", "r_shoulder", "neck", "pelvis")
    )
    checked = 0
    for each in shown:
        up = each.joints_px[pelvis] - each.joints_px[neck]
        if abs(each.facing[1]) < 0.7 or up[1] < 0.8 * np.linalg.norm(up):
            continue
        across = each.joints_px[left, 0] - each.joints_px[right, 0]
        assert np.sign(across) == np.sign(each.facing[1])
        checked += 1
    assert checked > 20


def test_limbs_are_as_long_as_the_stature_allows(shown: list[PictureExample]) -> None:
    """No limb looks longer than it is; the longest of many look as long: 0.245 of the stature."""
    knee, ankle = JOINT_NAMES.index("l_knee"), JOINT_NAMES.index("l_ankle")
    shares = [
        float(np.linalg.norm(each.joints_px[ankle] - each.joints_px[knee]) / each.stature_px)
        for each in shown
    ]
    assert 0.2 < np.quantile(shares, 0.9) < 0.3


def test_a_seed_is_a_person() -> None:
    one, again, other = (list(anny_examples(seed)) for seed in (5, 5, 6))
    assert 0 < len(one) <= PICTURES
    for a, b in zip(one, again, strict=True):
        assert np.array_equal(a.body, b.body)
        assert np.array_equal(a.joints_px, b.joints_px)
    assert not np.array_equal(one[0].body, other[0].body)


def test_they_fill_their_pictures_as_our_own_people_do(shown: list[PictureExample]) -> None:
    ours = [each for seed in range(12) for each in picture_examples(seed)]
    share, own = (np.mean([each.body[..., 3] > 0 for each in found]) for found in (shown, ours))
    assert share == pytest.approx(own, rel=0.3)
