"""What is made of an example keeps the truth of it, and looks like no other."""

from functools import lru_cache

import cv2
import numpy as np
import pytest

from common.body.body import OTHER_SIDE
from synth.picture import composites
from synth.picture.backdrops import SIDE_PX as BACKDROP_PX
from synth.picture.backdrops import backdrop
from synth.picture.composites import UNKNOWN, Composite, composite
from synth.picture.picture_examples import PictureExample, picture_examples

EVERY_SHARE = [name for name in vars(composites) if name.endswith("_SHARE")]


@lru_cache(maxsize=1)
def example() -> PictureExample:
    return next(iter(picture_examples(1)))


def made(seed: int) -> Composite:
    rng = np.random.default_rng(seed)
    flat = np.full((BACKDROP_PX, BACKDROP_PX, 3), 128, np.uint8)
    return composite(example(), example, lambda: flat, rng)


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Nothing happens to a picture but what its place demands."""
    for name in EVERY_SHARE:
        monkeypatch.setattr(composites, name, 0.0)
    for name in ("TURN_DEG", "LARGER", "BESIDE_PX", "FINE_TINT", "EXPOSURE"):
        monkeypatch.setattr(composites, name, 0.0)
    return monkeypatch


def test_without_any_mischief_the_outline_is_the_examples_or_its_mirror_image(
    plain: pytest.MonkeyPatch,
) -> None:
    own = example().outline > 0
    for seed in range(8):
        told = made(seed).outline == 255
        assert np.array_equal(told, own) or np.array_equal(told, own[:, ::-1])


def test_the_mask_is_the_person_whatever_the_silhouette_says(plain: pytest.MonkeyPatch) -> None:
    own = example().body[..., 3] > 127
    for share in ("UNTOLD_SHARE", "RAGGED_SHARE"):
        plain.setattr(composites, share, 1.0)
        for seed in range(4):
            exact = made(seed).mask == 255
            assert np.array_equal(exact, own) or np.array_equal(exact, own[:, ::-1])
        plain.setattr(composites, share, 0.0)


def test_the_mask_turns_grows_and_moves_with_the_joints(plain: pytest.MonkeyPatch) -> None:
    """All of the example's joints are within its body, but for rounding."""
    for name, value in (("TURN_DEG", 20.0), ("LARGER", 0.2), ("BESIDE_PX", 4.0)):
        plain.setattr(composites, name, value)
    for seed in range(20):
        one = made(seed)
        columns, rows = one.joints_px[one.inside].astype(int).T
        assert (cv2.dilate(one.mask, np.ones((3, 3)))[rows, columns] == 255).all()


def test_what_hides_a_person_is_not_in_the_mask(plain: pytest.MonkeyPatch) -> None:
    """Nor what the silhouette still has of them."""
    own = (example().body[..., 3] > 127).sum()
    plain.setattr(composites, "HIDDEN_SHARE", 1.0)
    hidden = [made(seed) for seed in range(30)]
    assert np.mean([(one.mask > 0).sum() < own for one in hidden]) > 0.3
    assert any((one.mask == 0)[one.outline > 0].sum() > 200 for one in hidden)
    plain.setattr(composites, "HIDDEN_SHARE", 0.0)
    plain.setattr(composites, "BEFORE_SHARE", 1.0)
    before = [made(seed) for seed in range(30)]
    assert np.mean([(one.mask > 0).sum() < own for one in before]) > 0.3


def test_beyond_the_cameras_picture_there_is_no_mask(plain: pytest.MonkeyPatch) -> None:
    plain.setattr(composites, "BORDER_SHARE", 1.0)
    for seed in range(12):
        one = made(seed)
        black = one.picture.max(axis=2) == 0
        strip = black.all(axis=0)[None] | black.all(axis=1)[:, None]
        assert not one.mask[strip].any()


def test_of_a_recorded_frame_the_mask_is_not_known(plain: pytest.MonkeyPatch) -> None:
    """All of such a frame counts as the body; with the backdrop alone in its place it is known."""
    body = np.full_like(example().body, 255)
    recorded = example()._replace(body=body)
    flat = np.full((BACKDROP_PX, BACKDROP_PX, 3), 128, np.uint8)
    for nobody, due in ((0.0, UNKNOWN), (1.0, 0)):
        plain.setattr(composites, "NOBODY_SHARE", nobody)
        one = composite(recorded, example, lambda: flat, np.random.default_rng(1))
        assert (one.mask == due).all()


def test_in_the_mirror_left_is_right(plain: pytest.MonkeyPatch) -> None:
    own = example()
    mirrored = [one for one in map(made, range(8)) if not np.allclose(one.joints_px, own.joints_px)]
    assert mirrored
    for one in mirrored:
        across = own.joints_px.copy()
        across[:, 0] = len(own.outline) - across[:, 0]
        assert np.allclose(one.joints_px, across[OTHER_SIDE], atol=1e-3)
        assert np.allclose(one.facing, own.facing * [-1, 1])


def test_where_nobody_is_no_joint_is_told(plain: pytest.MonkeyPatch) -> None:
    plain.setattr(composites, "NOBODY_SHARE", 1.0)
    one = made(0)
    assert one.nobody
    assert not one.inside.any()
    assert not one.facing.any()


def test_an_outline_that_is_not_told_is_grey(plain: pytest.MonkeyPatch) -> None:
    plain.setattr(composites, "UNTOLD_SHARE", 1.0)
    assert (made(0).outline == UNKNOWN).all()


def test_beyond_the_cameras_picture_is_nothing_and_no_joint(plain: pytest.MonkeyPatch) -> None:
    plain.setattr(composites, "BORDER_SHARE", 1.0)
    for seed in range(12):
        one = made(seed)
        shown = one.picture.max(axis=2)
        black_columns, black_rows = shown.max(axis=0) == 0, shown.max(axis=1) == 0
        assert black_columns.any() or black_rows.any()
        columns, rows = one.joints_px[one.inside].astype(int).T
        assert not (black_columns[columns] | black_rows[rows]).any()


def test_a_larger_picture_has_a_larger_stature(plain: pytest.MonkeyPatch) -> None:
    plain.setattr(composites, "LARGER", 0.1)
    for seed in range(6):
        one = made(seed)
        spans = [np.ptp(joints, axis=0).max() for joints in (one.joints_px, example().joints_px)]
        assert one.stature_px / example().stature_px == pytest.approx(spans[0] / spans[1], rel=1e-3)


@pytest.mark.slow
def test_every_backdrop_is_another() -> None:
    seen = [backdrop(seed) for seed in range(12)]
    assert all(one.shape == (BACKDROP_PX, BACKDROP_PX, 3) for one in seen)
    assert len({one.tobytes() for one in seen}) == len(seen)
    assert np.array_equal(backdrop(5), seen[5])
