"""Colours of clothes: of the upper body, then of the legs, in L*a*b*."""

import cv2
import numpy as np
import pytest
from staging import observation

from viewer.people.clothes_colours import clothes_colours

RED_LAB, WHITE_LAB = (53.2, 80.1, 67.2), (100.0, 0.0, 0.0)


def dressed(upper: tuple[int, int, int], lower: tuple[int, int, int]) -> tuple[float, ...]:
    mask = np.zeros((120, 160), np.bool_)
    mask[20:100, 60:90] = True
    picture = np.full((120, 160, 3), 30, np.uint8)
    picture[20:61, 60:90], picture[61:100, 60:90] = upper, lower
    cv2.rectangle(picture, (0, 0), (59, 119), (0, 255, 0), cv2.FILLED)
    return clothes_colours(picture, observation(mask))


def test_a_red_shirt_over_white_trousers() -> None:
    """sRGB red is (53.2, 80.1, 67.2) in L*a*b* under D65."""
    found = dressed((0, 0, 255), (255, 255, 255))
    assert found == pytest.approx((*RED_LAB, *WHITE_LAB), abs=0.6)
    assert dressed((255, 255, 255), (0, 0, 255)) == pytest.approx((*WHITE_LAB, *RED_LAB), abs=0.6)
