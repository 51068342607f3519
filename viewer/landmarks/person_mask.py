"""What the network of landmarks makes of one person: joints, and the pixels that show them."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.observation import Landmarks
from viewer.landmarks.landmark_window import SIDE, Window

LIKELY: Final = 0.5
"""Probability from which a pixel is a person's, where they are compared with another."""


class PersonMask(NamedTuple):
    """The person in a window, as the network sees them."""

    logits: NDArray[np.float32]
    """(CELLS, CELLS)"""
    window: Window

    def over(self, shape: tuple[int, ...], *probabilities: float) -> list[NDArray[np.uint8]]:
        """For each probability (H, W) 1 where the person is at least so probable; 0 outside of the
        window.

        Args:
            shape: Of the picture, (H, W, ...).
            probabilities: Between 0 and 1.
        """
        logits = self.logits_over(shape)
        return [(logits >= _logit(each)).view(np.uint8) for each in probabilities]

    def logits_over(self, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """(H, W) log odds that a pixel shows the person; minus infinity outside of the window.

        Args:
            shape: Of the picture, (H, W, ...).
        """
        high, wide = shape[:2]
        cells = len(self.logits) - 1.0
        corners = np.array([(0.0, 0.0), (cells, 0.0), (0.0, cells)])
        in_planes = (corners + 0.5) * (SIDE / len(self.logits))
        onto = cv2.getAffineTransform(
            corners.astype(np.float32),
            (self.window.in_picture(in_planes) - 0.5).astype(np.float32),
        )
        warped = cv2.warpAffine(self.logits, onto, (wide, high), borderValue=-math.inf)
        return np.asarray(warped, np.float32)


class LandmarkResult(NamedTuple):
    """What the network makes of a person in a frame."""

    landmarks: Landmarks | None
    """None: it sees no person."""
    person: PersonMask | None = None
    """Where the network sees the person; None: an outside source does not say."""
    carried: bool = False
    """It is of an earlier frame, moved on: there was no look."""

    @property
    def surety(self) -> float:
        """Mean confidence of the joints; 0 without a person."""
        return 0.0 if self.landmarks is None else float(np.mean(self.landmarks.confidence))


class Shown(NamedTuple):
    """The people in a frame, as the network of landmarks sees them."""

    followed: LandmarkResult
    number: int = 0
    """Of the followed person's track."""
    others: tuple[tuple[int, LandmarkResult], ...] = ()
    """The others, with the numbers of their tracks."""

    @property
    def masks(self) -> list[PersonMask]:
        """Where the others are."""
        return [each.person for _, each in self.others if each.person is not None]


def likeliest(
    people: Sequence[PersonMask], other: PersonMask | None, shape: tuple[int, ...]
) -> NDArray[np.uint8]:
    """(H, W) 1 where any of some people is LIKELY, and likelier than another.

    Args:
        people: At least one.
        other: The one with whom they are compared; None: is nowhere.
        shape: Of the picture, (H, W, ...).
    """
    logits = np.max([each.logits_over(shape) for each in people], axis=0)
    shown = logits >= _logit(LIKELY)
    if other is not None:
        shown &= logits > other.logits_over(shape)
    return shown.view(np.uint8)


def _logit(probability: float) -> float:
    return math.log(probability / (1.0 - probability))
