"""The guide for the viewers' next frame: the expected place of the body, and its lengths."""

import math

import numpy as np

from calibration.gate import silhouette_motion
from common.body.body import rest_pose
from common.bus.instant import Instant
from common.bus.messages import Guide
from integrator.belief import status_of
from integrator.measuring.known_body import Measured
from integrator.merge_state import State
from integrator.outgoing import moment
from integrator.person import Following, Sighting
from integrator.rig.body_position import pixels_of, scales_since


def guide_of(state: State, person: Following, now: Sighting, settled_now: bool) -> Guide:
    """Input of the viewers for their next frame.

    As printed each starts from its own estimate; beyond the print from both together.

    Args:
        state: Of this instant.
        person: Of this instant.
        now: The views of the instant.
        settled_now: The body has just been measured: both start from its place.
    """
    rig, known, place = now.filed_rig, person.body, person.pose[:3]
    measured_at = np.array(known.measured_at_m) if isinstance(known, Measured) else place
    roots = list(pixels_of(rig, place))
    for n, seen in enumerate(now.instant.detections):
        own = not (state.method.shared_start or settled_now)
        if own and seen is not None and seen.search is not None:
            roots[n] = seen.search.root_px
    upright = pixels_of(rig, np.array([place[0], measured_at[1], place[2]]))
    return Guide(
        **moment(state, now.instant),
        frames=state.frames,
        status=status_of(person, state.period_s),
        bdp=known.bdp,
        measured=isinstance(known, Measured),
        facing=state.facing,
        scale_px_per_m=_or_unseen(scales_since(rig, place, measured_at)),
        root_px=tuple(roots),
        rest_row_px=tuple(row for _, row in upright),
        pose=tuple(person.pose.tolist()),
        stick=_asks_for_stick(state, person),
        proposes=state.proposes,
        moves=silhouette_motion.moves(state.motion),
    )


def no_person(state: State, instant: Instant) -> Guide:
    """The guide while no person is in any view."""
    known, cameras = state.person.body, len(instant.views)
    return Guide(
        **moment(state, instant),
        frames=state.frames,
        bdp=known.bdp,
        measured=isinstance(known, Measured),
        facing=state.facing,
        scale_px_per_m=(0.0,) * cameras,
        root_px=((0.0, 0.0),) * cameras,
        rest_row_px=(0.0,) * cameras,
        pose=tuple(rest_pose().tolist()),
        proposes=state.proposes,
        moves=(False,) * cameras,
    )


def _asks_for_stick(state: State, person: Following) -> bool:
    """Whether the single remaining view shall fit a stick body to its next silhouette.

    On a calibrated rig the proposal is nearer than a lifted stick body, even where it fits badly:
    72 mm against 179 while camera 1 is lost (docs/measurements.md).
    """
    alone = person.found.alone
    return alone is not None and alone.stick and state.scale_source == "assumed"


def _or_unseen(scales: tuple[float, ...]) -> tuple[float, ...]:
    """Scales, with 0 for a camera that has the body behind it."""
    return tuple(scale if math.isfinite(scale) and scale > 0 else 0.0 for scale in scales)
