"""What a rig is fitted to: both views of many moments, and what is believed before."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import OTHER_SIDE, Vector
from integrator.selfcalibration import person_prior as prior
from integrator.selfcalibration.joint_tracks import (
    JointTrack,
    Sighting,
    at_times,
    height_px,
    smoothed,
    useful_times,
)

CLOSE: Final = 0.03
"""What a landmark's confidence speaks of: how probably it is less than so many statures off."""
LEAST_SURE: Final = 0.12
"""Landmarks less sure than this are left out."""

Sides = NDArray[np.bool_]
"""(n, 3) whether one view has the sides of a part the other way round than the other."""


class Known(NamedTuple):
    """What is believed of rig and person before anybody is seen."""

    mean: Vector
    """As a guess (`rig_guess.py`), where something is believed."""
    sigma: Vector
    """inf: nothing is believed."""
    soft: NDArray[np.bool_]
    """What is mostly so, but may be quite otherwise."""
    stature_m: float
    stature_error: float = 0.01
    """How far the person's lengths may add up to another (sigma of its logarithm)."""


class ClipEvidence(NamedTuple):
    """Of one clip."""

    first: JointTrack
    """At the moments that are looked at."""
    second: JointTrack
    """All of it: it may be late."""
    units_px: tuple[float, float]
    """How high the person is in each view, typically."""


class Evidence(NamedTuple):
    """All that a rig is fitted to."""

    clips: tuple[ClipEvidence, ...]
    size_px: tuple[int, int]
    known: Known

    def thinned(self, most: int) -> "Evidence":
        """The same of fewer moments."""
        step = max(1, sum(len(clip.first.times_s) for clip in self.clips) // most)
        return self._replace(
            clips=tuple(
                clip._replace(first=JointTrack(*(part[::step] for part in clip.first)))
                for clip in self.clips
            )
        )


def gathered(sightings: tuple[Sighting, ...], known: Known) -> Evidence:
    """What both views saw, made ready for the fit."""
    clips = []
    for one in sightings:
        smooth = one._replace(first=smoothed(one.first), second=smoothed(one.second))
        first = at_times(smooth.first, useful_times(one))
        units = (
            height_px(one.first) / prior.CROWN_SHARE,
            height_px(one.second) / prior.CROWN_SHARE,
        )
        clips.append(ClipEvidence(first, smooth.second, units))
    return Evidence(tuple(clips), sightings[0].size_px, known)


def sigma_m(track: JointTrack, stature_m: float) -> NDArray[np.float64]:
    """(n, 15) how far landmarks err along each axis, by their confidence; inf for unsure ones."""
    sure = np.clip(track.confidence, 1e-6, 0.98)
    spread = CLOSE * stature_m / np.sqrt(-2.0 * np.log1p(-sure))
    return np.where(track.confidence >= LEAST_SURE, spread, np.inf)


def exchanged(track: JointTrack, sides: Sides) -> JointTrack:
    """The track with the sides of parts the other way round."""
    other = np.where(sides[:, prior.PART_OF_JOINT], OTHER_SIDE, np.arange(len(OTHER_SIDE)))
    rows = np.arange(len(other))[:, None]
    return track._replace(
        joints_px=track.joints_px[rows, other], confidence=track.confidence[rows, other]
    )
