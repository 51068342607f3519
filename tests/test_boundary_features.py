"""Features around the contour, held against pixels mixed by hand."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from common.video.pictures import Image
from viewer.background.background import BackgroundModel
from viewer.silhouette.alpha_matte import NOISE, SHARES
from viewer.silhouette.boundary_features import (
    CROSS,
    FEATURES,
    _gathered,
    _window,
    counts_3x3,
    features_of,
)
from viewer.silhouette.colour_model import SHADES

BODY, ROOM = (40.0, 60.0, 160.0), (150.0, 150.0, 150.0)
OWN = SHARES * [tuple(each) for each in CROSS.tolist()].index((0, 0))
"""Which feature is a pixel's own alpha."""
FACTS = SHARES * len(CROSS) + 2
"""The first feature after the shares of body around."""
ROWS, COLUMNS, EDGE = 120, 160, 80


def mixed(share: float, shade: float) -> Image:
    """Body at the left, then a column that it covers in part, then the room in a shade."""
    picture = np.empty((ROWS, COLUMNS, 3))
    picture[:] = np.array(ROOM) * shade
    picture[:, :EDGE] = BODY
    picture[:, EDGE] = share * np.array(BODY) + (1 - share) * np.array(ROOM) * shade
    return np.rint(picture).astype(np.uint8)


def wall() -> BackgroundModel:
    """Of one grey, known to 2 grey levels, in its own light; no colour is anybody's."""
    return BackgroundModel(
        np.full((ROWS, COLUMNS, 3), ROOM, np.float32),
        np.full((ROWS, COLUMNS, 2), 0.25, np.float32),
        np.ones(3, np.float32),
        np.zeros(SHADES, np.float32),
    )


def features(
    share: float, shade: float, doubted: tuple[slice, slice] | None = None
) -> NDArray[Any]:
    """(H, W, FEATURES); NaN where nothing is looked at."""
    mask, doubt = np.zeros((2, ROWS, COLUMNS), np.uint8)
    mask[20:100, 40:EDGE] = 1
    if doubted is not None:
        doubt[doubted] = 1
    places, found = features_of(mixed(share, shade), wall(), mask, doubt)
    out = np.full((ROWS, COLUMNS, FEATURES), np.nan, np.float32)
    out[places[:, 0], places[:, 1]] = found
    return out


@pytest.mark.parametrize("shade", [1.0, 0.8])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 1.0])
def test_coverage_is_the_share_that_was_mixed(share: float, shade: float) -> None:
    """P3: also where the room lies in the body's shadow."""
    found = features(share, shade)[60, EDGE, OWN]
    off = np.array(BODY) - np.array(ROOM) * shade
    luma = np.array([0.114, 0.587, 0.299]) @ off
    square = luma**2 + 0.16 * ((off - luma) ** 2).sum()
    assert found == pytest.approx(share * square / (square + NOISE), abs=0.02)


def test_the_shade_of_the_room_beside_the_body_is_told() -> None:
    assert features(0.5, 0.8)[60, EDGE, FACTS + 3] == pytest.approx(0.8, abs=0.01)


def test_distance_brightness_and_colour_are_in_spreads() -> None:
    """A pixel of the body: 8 spreads of 2 grey levels each are a one."""
    off = np.array(BODY) - np.array(ROOM)
    luma = np.array([0.114, 0.587, 0.299]) @ off
    spreads = [luma / 2, np.sqrt(((off - luma) ** 2).sum()) / 2]
    told = features(0.5, 1.0)[60, EDGE - 1, FACTS + 5 : FACTS + 7]
    assert told == pytest.approx(np.clip(spreads, -20, 20) / 8, abs=1e-3)


def test_only_the_outline_and_what_is_in_doubt_is_looked_at() -> None:
    doubted = slice(50, 54), slice(60, 62)
    looked = ~np.isnan(features(0.5, 1.0, doubted)[..., OWN])
    assert looked[60, EDGE - 1 : EDGE + 1].all()
    assert looked[doubted].all()
    assert not looked[60, 45 : EDGE - 2].any()
    assert not looked[60, EDGE + 2 :].any()


def test_of_nobody_nothing_is_looked_at() -> None:
    nobody = np.zeros((ROWS, COLUMNS), np.uint8)
    places, found = features_of(mixed(0.5, 1.0), wall(), nobody, nobody)
    assert (places.shape, found.shape) == ((0, 2), (0, FEATURES))


def test_the_window_around_a_mask_ends_at_the_picture() -> None:
    mask = np.zeros((40, 60), np.uint8)
    mask[10:20, 30:37] = 1
    assert _window(mask, 4) == (26, 6, 41, 24)
    assert _window(mask, 15) == (15, 0, 52, 35)
    assert _window(mask, 35) == (0, 0, 60, 40)


def test_neighbours_in_the_mask_are_counted() -> None:
    mask = np.zeros((5, 7), np.uint8)
    mask[1:4, 2:5] = 1
    assert counts_3x3(mask)[2].tolist() == [0, 3, 6, 9, 6, 3, 0]


@pytest.mark.parametrize("stride", [1, 2])
def test_features_are_gathered_from_a_cross_of_neighbours_then_from_around(stride: int) -> None:
    """Against plain indexing; neighbours beyond the window are its border's."""
    rng = np.random.default_rng(2)
    shares = rng.normal(size=(9, 12, SHARES)).astype(np.float32)
    around, wide = rng.integers(0, 256, (2, 9, 12), dtype=np.uint8)
    places = np.array([[0, 0], [4, 7], [8, 11], [1, 10]], np.int32)
    facts = rng.normal(size=(4, FEATURES - FACTS)).astype(np.float32)
    there = places.copy()
    found = _gathered(there, shares, facts, around, wide, stride, (20, 3))
    assert there.tolist() == (places + np.array([20, 3])).tolist()
    for n, (y, x) in enumerate(places.tolist()):
        rows = np.clip(y + stride * CROSS[:, 0], 0, 8)
        columns = np.clip(x + stride * CROSS[:, 1], 0, 11)
        due = [*shares[rows, columns].ravel(), around[y, x] / 255, wide[y, x] / 255, *facts[n]]
        assert found[n] == pytest.approx(np.array(due), rel=1e-6)


@pytest.mark.parametrize("rows", [120, 480])
def test_a_taller_picture_is_looked_at_as_far_around_by_its_height(rows: int) -> None:
    """The band is a hundred-and-twentieth of the height to either side of the outline."""
    times = rows // 120
    model = BackgroundModel(
        np.full((rows, 160, 3), ROOM, np.float32),
        np.full((rows, 160, 2), 0.25, np.float32),
        np.ones(3, np.float32),
        np.zeros(SHADES, np.float32),
    )
    frame = np.full((rows, 160, 3), ROOM, np.uint8)
    frame[:, 60:100] = BODY
    mask = np.zeros((rows, 160), np.uint8)
    mask[:, 60:100] = 1
    places, _ = features_of(frame, model, mask, np.zeros_like(mask))
    columns = np.unique(places[places[:, 0] == rows // 2, 1])
    reach = [*range(60 - times, 60 + times), *range(100 - times, 100 + times)]
    assert columns.tolist() == reach
