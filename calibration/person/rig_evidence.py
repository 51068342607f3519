"""The data of a rig's fit: both views at many moments, and the priors."""

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
"""Error, statures, to which a landmark's confidence refers: its probability of being less than
this off."""
LEAST_SURE: Final = 0.12
"""Confidence below which landmarks are left out."""

INDEPENDENT_HZ: Final = 1.0
"""Rate of independent landmark errors, Hz: the network errs alike in neighbouring frames."""
MOST_INDEPENDENT: Final = 5.0
"""Number of independent moments that a clip counts for at first, however long it is: the network's
systematic errors do not average out. A minute of each of two performers gave rigs that were 46 and
59 mm off without this bound, 25 and 23 with it (docs/measurements.md). `independent_moments.py`
later estimates the number from the clip itself."""

Sides = NDArray[np.bool_]
"""(n, 3) whether one view has the sides of a part exchanged relative to the other."""


class Known(NamedTuple):
    """Priors on rig and person before any observation."""

    mean: Vector
    """The prior mean as a guess (`rig_guess.py`), where there is a prior."""
    sigma: Vector
    """Standard deviations; inf: no prior."""
    soft: NDArray[np.bool_]
    """Heavy-tailed priors: mostly true, but possibly far off."""
    stature_m: float
    stature_error: float = 0.01
    """Standard deviation of the logarithm of the sum of the person's lengths."""


class ClipEvidence(NamedTuple):
    """Observations of one clip."""

    first: JointTrack
    """View 1 at the moments used."""
    second: JointTrack
    """All of view 2: it may be late."""
    units_px: tuple[float, float]
    """Typical height of the person in each view, pixels."""


class Evidence(NamedTuple):
    """All data of a rig's fit."""

    clips: tuple[ClipEvidence, ...]
    size_px: tuple[int, int]
    known: Known
    worth: float
    """Number of moments with independent landmark errors that all clips together count for."""

    @property
    def moments(self) -> int:
        """Number of moments."""
        return sum(len(clip.first.times_s) for clip in self.clips)

    @property
    def own_share(self) -> float:
        """Share of the landmarks whose errors are independent."""
        return min(1.0, self.worth / max(self.moments, 1))

    def thinned(self, most: int) -> "Evidence":
        """The same data with fewer moments."""
        step = max(1, self.moments // most)
        return self._replace(
            clips=tuple(
                clip._replace(first=JointTrack(*(part[::step] for part in clip.first)))
                for clip in self.clips
            )
        )


def gathered(sightings: tuple[Sighting, ...], known: Known) -> Evidence:
    """Both views' observations, prepared for the fit."""
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
    """Number of moments of a clip with new landmark errors, systematic ones left out."""
    at_s = clip.first.times_s
    return min(float(len(at_s)), INDEPENDENT_HZ * float(np.ptp(at_s))) if len(at_s) else 0.0


def sigma_px(track: JointTrack, unit_px: float) -> NDArray[np.float64]:
    """(n, 15) standard deviation of landmarks along each axis of the picture, from their
    confidence and the person's height in it; inf for unsure ones."""
    sure = np.clip(track.confidence, 1e-6, 0.98)
    spread = CLOSE * unit_px / np.sqrt(-2.0 * np.log1p(-sure))
    return np.where(track.confidence >= LEAST_SURE, spread, np.inf)


def exchanged(track: JointTrack, sides: Sides) -> JointTrack:
    """The track with the sides of some parts exchanged."""
    other = np.where(sides[:, prior.PART_OF_JOINT], OTHER_SIDE, np.arange(len(OTHER_SIDE)))
    rows = np.arange(len(other))[:, None]
    return track._replace(
        joints_px=track.joints_px[rows, other], confidence=track.confidence[rows, other]
    )
