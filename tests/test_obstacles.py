"""What stands before people hides them in the mask, and leaves their joints where they are."""

from functools import lru_cache
from typing import Any

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from synth.picture import composites, obstacles
from synth.picture.backdrops import SIDE_PX as BACKDROP_PX
from synth.picture.composites import VISIBLE, Composite, composite
from synth.picture.obstacles import Layers, beside, coated, hidden_by
from synth.picture.picture_examples import SIDE_PX, PictureExample, picture_examples
from synth.things.furniture import THINGS
from synth.things.shade import Place

FLAT = np.full((BACKDROP_PX, BACKDROP_PX, 3), 128, np.uint8)
WRISTS = [JOINT_NAMES.index(name) for name in ("l_wrist", "r_wrist")]


@lru_cache(maxsize=1)
def example() -> PictureExample:
    return next(iter(picture_examples(1)))


def standing() -> Place:
    """Upright, 100 pixels tall, feet in row 110, hands below the hips."""
    rows = {"head_top": 10, "neck": 27, "shoulder": 28, "pelvis": 60, "hip": 60}
    rows |= {"elbow": 45, "wrist": 62, "knee": 85, "ankle": 106}
    aside = {"shoulder": 11, "elbow": 14, "wrist": 17, "hip": 6, "knee": 6, "ankle": 6}
    joints = []
    for name in JOINT_NAMES:
        part, to = name[2:] if name[:2] in ("l_", "r_") else name, {"l_": 1, "r_": -1}
        joints.append((64 + to.get(name[:2], 0) * aside.get(part, 0), rows[part]))
    return Place(np.array(joints, np.float32), 100.0, SIDE_PX)


def made(seed: int, share: float) -> Composite:
    return composite(example(), example, lambda: FLAT, np.random.default_rng(seed), share)


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Nothing happens to a picture but what stands before the person."""
    for name in vars(composites):
        if name.endswith("_SHARE") and name not in ("CLOTH_SHARE", "THING_SHARE", "PASSER_SHARE"):
            monkeypatch.setattr(composites, name, 0.0)
    for name in ("TURN_DEG", "LARGER", "BESIDE_PX", "FINE_TINT", "EXPOSURE"):
        monkeypatch.setattr(composites, name, 0.0)
    return monkeypatch


def test_a_picture_without_an_obstacle_is_what_its_seed_made_before() -> None:
    for seed in range(20):
        one = composite(example(), example, lambda: FLAT, np.random.default_rng(seed))
        rare = made(seed, 1e-9)
        pairs: list[Any] = list(zip(one, rare, strict=True))
        assert all(np.array_equal(a, b) for a, b in pairs)


def test_an_obstacle_changes_no_joint_and_no_other_choice() -> None:
    for seed in range(40):
        bare, one = made(seed, 0.0), made(seed, 1.0)
        for name in ("joints_px", "inside", "facing", "stature_px", "nobody"):
            assert np.array_equal(getattr(bare, name), getattr(one, name))


def test_what_is_hidden_is_not_in_the_mask_and_most_of_the_person_is(
    plain: pytest.MonkeyPatch,
) -> None:
    plain.setattr(composites, "CLOTH_SHARE", 0.0)
    own = int((made(0, 0.0).mask > 0).sum())
    left = np.array([(made(seed, 1.0).mask > 0).sum() for seed in range(60)]) / own
    assert left.max() <= 1.0
    assert left.min() >= VISIBLE
    assert (left < 0.97).mean() > 0.4
    for seed in range(30):
        bare, one = made(seed, 0.0), made(seed, 1.0)
        seen = one.mask > 0
        assert np.abs(one.picture[seen].astype(int) - bare.picture[seen]).mean() < 6.0


def test_furniture_alone_is_no_person(plain: pytest.MonkeyPatch) -> None:
    plain.setattr(composites, "NOBODY_SHARE", 1.0)
    plain.setattr(composites, "THING_SHARE", 1.0)
    for seed in range(10):
        bare, one = made(seed, 0.0), made(seed, 1.0)
        assert not one.mask.any()
        assert not one.inside.any()
        assert not np.array_equal(bare.picture, one.picture)


def test_a_silhouette_has_what_moves_with_the_person_and_a_gap_where_furniture_stands() -> None:
    mask = np.zeros((SIDE_PX, SIDE_PX), np.uint8)
    mask[20:100, 40:80] = 1
    thing = np.zeros((SIDE_PX, SIDE_PX, 4), np.float32)
    thing[60:90, 60:100] = 255.0, 0.0, 0.0, 255.0
    layers = Layers(np.full((SIDE_PX, SIDE_PX, 3), 90.0, np.float32), mask, mask)
    stands, moves = (hidden_by(layers, thing, moved) for moved in (False, True))
    assert stands.outline.sum() == 80 * 40 - 30 * 20
    assert moves.outline.sum() == 80 * 40 + 30 * 20
    for one in (stands, moves):
        assert one.mask.sum() == 80 * 40 - 30 * 20
        assert one.picture[75, 70].tolist() == [255.0, 0.0, 0.0]
        assert one.picture[75, 50].tolist() == [90.0, 90.0, 90.0]


@pytest.mark.parametrize("kind", THINGS)
def test_every_thing_is_opaque_and_no_brighter_than_its_colour(kind: str) -> None:
    for seed in range(20):
        first, again = (THINGS[kind](standing(), np.random.default_rng(seed)) for _ in range(2))
        assert np.array_equal(first, again)
        assert first.min() == 0.0
        assert 0.0 < first.max() <= 1.0


@pytest.mark.parametrize("kind", ["desk", "chair", "wheelchair"])
def test_furniture_stands_on_the_floor_and_hides_legs_rather_than_the_head(kind: str) -> None:
    floor = standing().floor()
    lowest, shares = [], []
    for seed in range(40):
        covered = THINGS[kind](standing(), np.random.default_rng(seed)) > 0
        lowest.append(np.flatnonzero(covered.any(axis=1)).max())
        shares.append((covered[60:106, 52:76].mean(), covered[8:25, 52:76].mean()))
    assert floor == pytest.approx(110.0)
    assert np.median(lowest) == pytest.approx(floor, abs=3.0)
    legs, head = np.mean(shares, axis=0)
    assert legs > 4 * head
    assert legs > 0.2


def test_an_umbrella_hides_the_head_rather_than_the_legs() -> None:
    covered = [THINGS["umbrella"](standing(), np.random.default_rng(n)) > 0 for n in range(40)]
    head, legs = (
        np.mean([one[rows, 52:76].mean() for one in covered])
        for rows in (slice(0, 20), slice(70, 106))
    )
    assert head > 0.1
    assert legs < 0.02


def test_a_box_is_between_the_hands_or_on_the_floor() -> None:
    rows = []
    for seed in range(40):
        covered = THINGS["box"](standing(), np.random.default_rng(seed)) > 0
        rows.append(np.flatnonzero(covered.any(axis=1)))
    stands = np.array([one.max() > 105 for one in rows])
    assert 0.25 < stands.mean() < 0.75
    assert [one.max() for one, low in zip(rows, stands, strict=True) if low] == pytest.approx(
        np.full(stands.sum(), standing().floor()), abs=1.0
    )
    held = [one.mean() for one, low in zip(rows, stands, strict=True) if not low]
    assert np.mean(held) == pytest.approx(60.0, abs=6.0)


def test_another_person_passes_on_one_side() -> None:
    columns = []
    for seed in range(20):
        body = beside(example(), np.random.default_rng(seed))
        columns.append(np.flatnonzero((body[..., 3] > 127).any(axis=0)).mean() / SIDE_PX - 0.5)
    assert min(columns) < -0.15
    assert max(columns) > 0.15
    assert np.abs(columns).mean() > 0.12


def bare_person() -> PictureExample:
    """The standing one as a picture: one colour wherever a bone is near."""
    place, body = standing(), np.zeros((SIDE_PX, SIDE_PX, 4), np.uint8)
    body[10:110, 50:78] = 20, 40, 200, 255
    body[28:66, 44:84] = 20, 40, 200, 255
    outline = (body[..., 3] > 0).astype(np.uint8)
    facing = np.array([0.0, 1.0], np.float32)
    return PictureExample(body, outline, place.joints, facing, place.stature)


def test_long_cloth_hides_the_legs_down_to_its_hem_and_is_the_persons() -> None:
    plain = bare_person()
    hems = []
    for seed in range(30):
        one = coated(plain, np.random.default_rng(seed))
        changed = (one.body != plain.body).any(axis=2)
        assert changed[70:78, 60:68].all()
        assert (one.body[changed, 3] == 255).all()
        assert (one.outline[changed] == 1).all()
        assert not changed[:20].any()
        hems.append(np.flatnonzero(changed.any(axis=1)).max())
        assert np.array_equal(one.joints_px, plain.joints_px)
    low, high = obstacles.HEM
    assert min(hems) >= 60 + 2 * low * 25 - 2
    assert max(hems) <= 85 + (2 * high - 1) * 21 + 6
    assert max(hems) - min(hems) > 15


def test_hands_are_before_the_cloth() -> None:
    plain = bare_person()
    for seed in range(30):
        one = coated(plain, np.random.default_rng(seed))
        columns, rows = plain.joints_px[WRISTS].astype(int).T
        assert np.array_equal(one.body[rows, columns], plain.body[rows, columns])


def test_the_persons_floor_is_below_the_lowest_joint() -> None:
    assert standing().floor() == 106.0 + 4.0
