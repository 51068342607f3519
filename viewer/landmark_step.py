"""A viewer's landmarks, frame by frame: where the network looks, and when."""

import math
from typing import Final, NamedTuple

from common.body.observation import Landmarks
from common.config.settings import Settings
from viewer.captured_frame import CapturedFrame
from viewer.landmarks.landmark_looks import network_of
from viewer.landmarks.outside_source import nearest_landmarks
from viewer.landmarks.own_landmarks import LandmarkModel, LandmarkResult, own_landmarks
from viewer.silhouette.silhouette import Seen

SEARCH_S: Final = 0.5
"""Time between two searches of the whole picture, in seconds, beside the looks at known people."""


class State(NamedTuple):
    """What one frame hands to the next."""

    known: Landmarks | None = None
    """Those of the last processed frame."""
    searched_s: float = -math.inf
    """Capture time of the last frame whose whole picture was searched for people."""


def step(
    state: State, frame: CapturedFrame, seen: Seen, settings: Settings, *, alone: bool
) -> tuple[State, LandmarkResult]:
    """The landmarks of a frame: our own network's, or those that an outside source sent with it.

    A frame that comes late is skipped, and keeps what is known. A single view has no other to rely
    on: its landmarks are computed even then, with one look instead of two.

    Args:
        state: From the frame before.
        frame: The picture, and the landmarks of an outside source.
        seen: The silhouette in it.
        settings: They name the network or the source.
        alone: The viewer is the only one of its run.
    """
    if not settings.looks_itself:
        result = LandmarkResult(nearest_landmarks(frame.landmarks, seen.box))
        return State(result.landmarks), result
    if frame.hurried and not alone:
        return state, LandmarkResult(None)
    model = LandmarkModel(network_of(settings.landmarks), alone and not frame.hurried)
    searches = not frame.hurried and frame.captured_s >= state.searched_s + SEARCH_S
    result = own_landmarks(frame.picture, seen, state.known, model, searches=searches)
    searched_s = frame.captured_s if searches else state.searched_s
    return State(result.landmarks, searched_s), result
