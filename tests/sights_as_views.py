"""What cameras show of a made-up person, as their viewers' messages."""

from collections.abc import Sequence

import msgspec
import numpy as np
from staging import report

from calibration.tracks.joint_tracks import Sightings
from common.body.observation import Landmarks
from common.bus.instant import Instant

SEEN = np.pad(np.ones((80, 30), np.bool_), ((20, 20), (65, 65)))


def instants_of(sightings: Sightings, seconds: float, hz: float = 15.0) -> list[Instant]:
    """So many seconds of them, from the start again where they are shorter."""
    counts = min(len(track.times_s) for track in sightings.tracks)
    return [instant_of(sightings, n % counts, n / hz) for n in range(round(seconds * hz))]


def instant_of(sightings: Sightings, row: int, at_s: float) -> Instant:
    """One row of all views."""
    views = []
    for number, track in enumerate(sightings.tracks, 1):
        places = tuple((u, v) for u, v in track.joints_px[row].tolist())
        shown = Landmarks(places, tuple(track.confidence[row].tolist()))
        view = report(number, SEEN, landmarks=shown, captured_s=at_s, clock_s=at_s)
        views.append(view)
    return Instant(tuple(views))


def without(instant: Instant, numbers: Sequence[int]) -> Instant:
    """The instant where some views show no person."""
    return Instant(
        tuple(
            msgspec.structs.replace(view, people=()) if view and view.viewer in numbers else view
            for view in instant.views
        )
    )
