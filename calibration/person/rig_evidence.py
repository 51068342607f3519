"""What a rig is fitted to: both views of many moments, and what is believed before."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import (
    JointTrack,
    Sighting,
    at_times,
    height_px,
    smoothed,
    useful_times,
)
from calibration.tracks.rig_guess import LATE
from common.body.body import OTHER_SIDE, Vector

CLOSE: Final = 0.03
"""What a landmark's confidence speaks of: how probably it is less than so many statures off."""
LEAST_SURE: Final = 0.12
"""Landmarks less sure than this are left out."""

INDEPENDENT_HZ: Final = 1.0
"""How often in a second a landmark errs anew: the network errs alike in neighbouring frames."""
MOST_INDEPENDENT: Final = 5.0
"""Number of independent moments that a clip counts for at first, however long it is: the network's
systematic errors do not average out. A minute of each of two performers gave rigs that were 46 and
59 mm off without this bound, 25 and 23 with it (docs/measurements.md). `film_worth.py` later
estimates the number from the clip itself."""

Sides = NDArray[np.bool_]
"""(n, 3) whether one view has the sides of a part the other way round than the other."""


class Known(NamedTuple):
    """What is believed of rig and person before a person is seen."""

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
    worth: float
    """As how many moments whose landmarks err by themselves all together count."""

    @property
    def moments(self) -> int:
        """How many there are."""
        return sum(len(clip.first.times_s) for clip in self.clips)

    @property
    def own_share(self) -> float:
        """Share of all landmarks that err by themselves."""
        return min(1.0, self.worth / max(self.moments, 1))

    def thinned(self, most: int) -> "Evidence":
        """The same of fewer moments."""
        step = max(1, self.moments // most)
        return self._replace(
            clips=tuple(
                clip._replace(first=JointTrack(*(part[::step] for part in clip.first)))
                for clip in self.clips
            )
        )


def gathered(sightings: tuple[Sighting, ...], known: Known) -> Evidence:
    """What both views saw, made ready for the fit."""
    clips = []
    for one, late_s in zip(sightings, known.mean[LATE:], strict=True):
        smooth = one._replace(first=smoothed(one.first), second=smoothed(one.second))
        first = at_times(smooth.first, useful_times(one, late_s))
        units = (
            height_px(one.first) / prior.CROWN_SHARE,
            height_px(one.second) / prior.CROWN_SHARE,
        )
        clips.append(ClipEvidence(first, smooth.second, units))
    worth = sum(min(own_moments(clip), MOST_INDEPENDENT) for clip in clips)
    return Evidence(tuple(clips), sightings[0].size_px, known, worth)


def own_moments(clip: ClipEvidence) -> float:
    """In how many moments of a clip landmarks err anew, habits left out."""
    at_s = clip.first.times_s
    return min(float(len(at_s)), INDEPENDENT_HZ * float(np.ptp(at_s))) if len(at_s) else 0.0


def sigma_px(track: JointTrack, unit_px: float) -> NDArray[np.float64]:
    """(n, 15) how far landmarks err along each axis of the picture, by their confidence and how
    high the person is in it; inf for unsure ones."""
    sure = np.clip(track.confidence, 1e-6, 0.98)
    spread = CLOSE * unit_px / np.sqrt(-2.0 * np.log1p(-sure))
    return np.where(track.confidence >= LEAST_SURE, spread, np.inf)


def exchanged(track: JointTrack, sides: Sides) -> JointTrack:
    """The track with the sides of parts the other way round."""
    other = np.where(sides[:, prior.PART_OF_JOINT], OTHER_SIDE, np.arange(len(OTHER_SIDE)))
    rows = np.arange(len(other))[:, None]
    return track._replace(
        joints_px=track.joints_px[rows, other], confidence=track.confidence[rows, other]
    )
