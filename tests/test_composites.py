"""What is made of an example keeps the truth of it, and looks like no other."""

from functools import lru_cache

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
