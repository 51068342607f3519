"""How well an observation fits a known person: place, clothes, and who hides whom."""

from collections.abc import Sequence
from itertools import permutations
from typing import Final

import numpy as np

from common.body.body import Vector
from common.body.clothes import colour_distance
from common.body.observation import Observation
from common.rig.camera import Camera, project
from integrator.people.known_life import Life, Places

NEAR_M: Final = 0.5
"""Distance in a picture, at the person's depth, from which on an observation is not of a person who
was seen in the instant before, metres."""
REACH_M_S: Final = 1.5
"""By how much that grows for each second in which no view shows them: walking pace."""
FARTHEST_M: Final = 4.0
"""Its upper bound."""
COUNTS: Final = 0.3
"""Confidence from which a joint counts."""
FEWEST: Final = 4
"""Fewest joints that place a person; of fewer the middle of the silhouette counts."""
KEEPS: Final = 0.2
"""By how much cheaper the observation is that carries the viewer's number of the person."""
AWAY: Final = 0.3
"""Cost of a person whom no view has shown for AWAY_S, beside one who has just been seen."""
AWAY_S: Final = 0.5
HIDDEN: Final = 0.4
"""Cost of a person all of whose joints are behind one who is nearer to the camera."""
BEHIND_M: Final = 0.25
"""By how much farther from the camera they are at least: two in one place may be one person."""
UNLIKE: Final = 1.0
"""Difference of colours that is a person's own at most, over a wall's light and shadow, where other
views alone have shown their clothes."""
OTHER_CLOTHES: Final = 0.4
"""The same where that view has."""
COLOUR_COST: Final = 0.6
"""Cost of such a difference."""


def cost_of(camera: Camera, view: int, life: Life, seen: Observation, now_s: float) -> float:
    """Cost of an observation as that of a known person, in [0, 1]; 1 or more: it is not theirs.

    Args:
        camera: The view's, without distortion.
        view: Its place in the rig.
        life: The person.
        seen: The observation.
        now_s: Capture time.
    """
    unlike = colour_distance(life.colours_in(view), seen.colours)
    unlike /= OTHER_CLOTHES if life.has_colours_in(view) else UNLIKE
    unseen_s = life.unseen_s(now_s)
    is_away = unseen_s > AWAY_S
    if is_away and unlike > 1.0:
        return np.inf
    expected_m = life.expected_m(now_s)
    if expected_m is None:
        return 0.0 if life.tracks[view] == seen.track else np.inf
    gate_m = min(NEAR_M + REACH_M_S * unseen_s, FARTHEST_M)
    far = off_m(camera, expected_m, seen) / gate_m
    if not far < 1.0:
        return np.inf
    keeps = KEEPS * (life.tracks[view] == seen.track)
    return max(0.0, 0.5 * far + AWAY * is_away + COLOUR_COST * min(unlike, 1.0) - keeps)


def hidden_shares(camera: Camera, places_m: Sequence[Places | None]) -> Vector:
    """For each person, the share of the joints that are behind another person who is nearer to the
    camera, (n,); 0 of one whose place is not known.

    Args:
        camera: The view's, without distortion.
        places_m: The joints of each; None: not known.
    """
    shown = [None if each is None else _in_picture(camera, each) for each in places_m]
    shares = np.zeros(len(places_m))
    for (i, one), (_, other) in permutations(enumerate(shown), 2):
        if one is None or other is None or other[1] > one[1] - BEHIND_M:
            continue
        low, high = other[0].min(axis=0), other[0].max(axis=0)
        behind = ((one[0] > low) & (one[0] < high)).all(axis=1)
        shares[i] = max(shares[i], float(behind.mean()))
    return shares


def _in_picture(camera: Camera, joints_m: Places) -> tuple[Places, float]:
    """The joints' places in a picture, (15, 2) pixels, and their mean depth, metres."""
    depth_m = float((joints_m @ np.array(camera.R).T + np.array(camera.t))[:, 2].mean())
    return project(camera, joints_m), depth_m


def off_m(camera: Camera, joints_m: Places, seen: Observation) -> float:
    """Median distance of an observation's joints from a person's in the picture, metres at the
    person's depth; infinite where the person is behind the camera.

    Args:
        camera: Without distortion.
        joints_m: The person's.
        seen: The observation.
    """
    places_px, depth_m = _in_picture(camera, joints_m)
    if np.isnan(places_px).any() or depth_m <= 0.0:
        return np.inf
    px_per_m = float(camera.K[0][0]) / depth_m
    shown = seen.landmarks
    sure = np.zeros(len(joints_m), np.bool_)
    if shown is not None:
        sure = np.array(shown.confidence) > COUNTS
    if shown is None or sure.sum() < FEWEST:
        box = seen.box
        middle_px = (box.left + box.right + 1) / 2, (box.top + box.bottom + 1) / 2
        return float(np.linalg.norm(places_px.mean(axis=0) - middle_px)) / px_per_m
    off_px = np.linalg.norm(places_px - np.array(shown.joints_px), axis=1)[sure]
    return float(np.median(off_px)) / px_per_m
