"""Features around the contour, held against pixels mixed by hand."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from common.video.decoding import Image
from viewer.background.background import BackgroundModel
from viewer.silhouette.alpha_matte import NOISE, SHARES
from viewer.silhouette.boundary_features import CROSS, FEATURES, features_of
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
