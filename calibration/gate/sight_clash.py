"""Whether two views follow one person: sight lines that meet, and joints that move alike."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.gate.rig_agreement import joint_gaps_m
from calibration.tracks.joint_tracks import Row, Sighting, track_of_rows
from calibration.tracks.late_fit import LEAST_SHARED
from calibration.tracks.lateness import miss_at
from common.body.observation import Landmarks, Observation
from common.rig.camera import Camera

SURE: Final = 0.5
"""Confidence of a joint, in both views, from which on its gap counts."""
FEWEST_JOINTS: Final = 4
"""Fewest such joints that are compared."""
MEETS_M: Final = 0.1
"""Median gap between the sight lines of one person, metres, up to which they meet. With a good
rig it is 0.06 at most in all frames of three performers (docs/measurements.md)."""
CLASHES_M: Final = 0.2
"""Median gap above which they do not, in an instant: four standard deviations of a sure joint."""
DIFFERENT: Final = 0.5
"""Miss of the relation between both views' pictures above which they show different people,
whatever the rig is: one person's is 0.46 at most in a second, 0.33 in three; that of two
people who do not act alike is 0.54 in the median (docs/measurements.md)."""
ALIKE: Final = 0.35
"""Miss below which both show one person, where they move: the rig is wrong."""
MOVED: Final = 0.04
"""Mean distance that joints must move for the person to count as moving, heights of the person."""
LATEST: Final = 40
"""Number of clashing instants that are kept."""
EVERY: Final = 4
"""Number of clashing instants after which the relation is fitted again."""


class Clash(NamedTuple):
    """What two views have shown of one person or of two."""

    met: int = 0
    """Number of instants in which sight lines met."""
    against: int = 0
    """Number of instants that contradict one person, less those since that confirm one."""
    clashed: int = 0
    """Number of clashing instants since sight lines last met for good."""
    rows: tuple[tuple[Row, Row], ...] = ()
    """The last of them."""
    is_apart: bool = False
    """The views follow different people."""


class Meeting(NamedTuple):
    """Two views at an instant."""

    gap_m: float
    """Median gap between sight lines; NaN where too few joints are sure."""
    rows: tuple[Row, Row]


def gap_m(cameras: tuple[Camera, ...], one: Observation | None, other: Observation | None) -> float:
    """Median gap between the sight lines of sure joints, metres; NaN where these are too few.

    Args:
        cameras: Both, without distortion.
        one: A person in the first view, without distortion.
        other: A person in the second.
    """
    if one is None or other is None or one.landmarks is None or other.landmarks is None:
        return np.nan
    gaps_m = np.abs(joint_gaps_m(cameras, one.landmarks, other.landmarks, SURE))
    seen = gaps_m[np.isfinite(gaps_m)]
    return float(np.median(seen)) if len(seen) >= FEWEST_JOINTS else np.nan


def row_of_landmarks(time_s: float, seen: Landmarks) -> Row:
    """The row of a joint track."""
    joints_px, confidence = np.array(seen.joints_px), np.array(seen.confidence)
    return time_s, joints_px, confidence, seen.facing_deg, seen.facing_confidence


def step(clash: Clash, now: Meeting, lasting: int) -> Clash:
    """Process one instant.

    Sight lines that clash do not tell different people from a wrong rig. It is the people where
    the rig has been confirmed before, or where the pictures of both views have no relation that
    any two cameras would have. It is the rig where they have one and the person moves.

    Args:
        clash: The evidence so far.
        now: Both views, in an instant in which both show a person.
        lasting: Number of instants from which on evidence counts: those that contradict one person,
            less those since that confirm one. While the views are apart, all that do not clash
            confirm one.
    """
    if now.gap_m < MEETS_M or (clash.is_apart and now.gap_m <= CLASHES_M):
        return _met(clash, lasting)
    if not now.gap_m > CLASHES_M:
        return clash
    clash = clash._replace(
        against=min(clash.against + 1, lasting),
        clashed=clash.clashed + 1,
        rows=(*clash.rows, now.rows)[-LATEST:],
    )
    if clash.against < lasting:
        return clash
    return _judged(clash, lasting)


def is_of_different_people(sighting: Sighting, late_s: float) -> bool:
    """Whether both views' pictures contradict one person, whatever the rig is.

    Args:
        sighting: Both views.
        late_s: Delay of view 2.
    """
    miss = miss_at(sighting, late_s)
    return miss is not None and miss > DIFFERENT


def _met(clash: Clash, lasting: int) -> Clash:
    met, against = min(clash.met + 1, lasting), max(clash.against - 1, 0)
    if not against:
        return Clash(met)
    return clash._replace(met=met, against=against)


def _judged(clash: Clash, lasting: int) -> Clash:
    """The evidence, with a decision where it is due."""
    if clash.met >= lasting and not clash.is_apart:
        return clash._replace(is_apart=True)
    if len(clash.rows) < LEAST_SHARED or clash.clashed % EVERY:
        return clash
    miss = miss_at(_sighting(clash.rows), 0.0)
    if miss is None:
        return clash
    if clash.is_apart and len(clash.rows) == LATEST and miss < ALIKE and _moves(clash.rows):
        return clash._replace(is_apart=False, met=0)
    return clash._replace(is_apart=clash.is_apart or miss > DIFFERENT)


def _sighting(rows: tuple[tuple[Row, Row], ...]) -> Sighting:
    first, second = zip(*rows, strict=True)
    track = track_of_rows(second)._replace(times_s=np.array([row[0] for row in first]))
    return Sighting(track_of_rows(first), track, (0, 0))


def _moves(rows: tuple[tuple[Row, Row], ...]) -> bool:
    """Whether a person moves in both views."""
    return all(
        _moved(np.stack([row[1] for row in view])) >= MOVED for view in zip(*rows, strict=True)
    )


def _moved(joints_px: NDArray[np.float64]) -> float:
    """Largest mean distance of the joints (n, 15, 2) from where they were first, in heights."""
    off_px = np.linalg.norm(joints_px - joints_px[0], axis=2).mean(axis=1)
    tall_px = np.ptp(joints_px[..., 1], axis=1).max()
    return float(off_px.max() / max(tall_px, 1.0))
