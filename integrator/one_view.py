"""One view alone: its stick body lifted into the room, and what its outline proposes (3.1.5)."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body import ANGLE_NAMES, ANGLES_IN_POSE, Vector
from common.camera import Camera, project
from common.messages import (
    Body,
    Facing,
    Pixel,
    Point,
    Report,
    ViewerNumber,
)
from common.proportions import thesis_bdp
from common.stickman import Stickman
from integrator import limits, signs, smoothing
from integrator.belief import LOST_SCORE, status_of
from integrator.mirroring import Front
from integrator.one_outline import (
    Hypothesis,
    Inputs,
    Settled,
    State,
    lifted_body,
    proposed_body,
    settled_body,
)

SURELY: Final = 1.15
"""The lifted body goes before the proposed one where its S is higher by this factor."""


def init(
    number: ViewerNumber,
    camera: Camera,
    man: Stickman,
    stature_m: float,
    printed: bool,
    period_s: float,
) -> State:
    """A view that has seen nobody."""
    smooth = smoothing.init(len(ANGLE_NAMES), period_s)
    bdp = thesis_bdp(stature_m)
    return State(number, camera, man, bdp, stature_m, printed, smooth, signs.init())


def step(state: State, report: Report, told: Inputs) -> tuple[State, Body, Settled]:
    """One frame with somebody: the lifted body competes with the proposed one, by S.

    Args:
        state: What is remembered.
        report: With a fit.
        told: The user's inputs, which go before all else.
    """
    state, found = lifted_body(state, report, told)
    dt_s = 0.0 if state.last_s is None else max(0.0, report.captured_s - state.last_s)
    if not state.printed:
        state, other = proposed_body(state, report, told, dt_s)
        if other is not None and found.score < SURELY * other.score:
            found = other
        found = settled_body(state, report, found, told)
    fits = found.score >= LOST_SCORE
    raw = found.pose[list(ANGLES_IN_POSE)]
    smooth, angles, _ = smoothing.step(state.smooth, raw, dt_s)
    if not state.printed:
        angles = limits.clipped(angles)
    badly = 0 if fits else state.badly + 1
    state = state._replace(smooth=smooth, pose=found.pose, last_s=report.captured_s, badly=badly)
    return state, _body(state, report, found, angles), found.settled


def nobody(state: State, frame: int, captured_s: float) -> tuple[State, Body, Settled]:
    """A frame without anybody: what was learnt of the body is kept, its pose is not."""
    fresh = smoothing.init(len(ANGLE_NAMES), state.smooth.period_s)
    state = state._replace(
        smooth=fresh, memory=signs.init(), recall=None, front=Front(), pose=None, badly=0
    )
    body = Body(
        frame=frame, captured_s=captured_s, clock_s=captured_s, status="empty", views="none"
    )
    return state, body, Settled()


def _body(state: State, report: Report, found: Hypothesis, angles_deg: Vector) -> Body:
    pose = found.pose.copy()
    pose[list(ANGLES_IN_POSE)] = angles_deg
    facing: Facing = "flank" if found.settled.orientation in ("left", "right") else "facade"
    places_px = project(state.camera, found.joints_m)
    outside = _outside(report, places_px)
    pixels = _pixels(places_px)
    fit = report.fit
    return Body(
        frame=report.frame,
        captured_s=report.captured_s,
        clock_s=report.clock_s,
        status=status_of(state.badly, "predicted" if outside.any() else "tracking"),
        views="1" if state.number == 1 else "2",
        joints_m=tuple(_point(place) for place in found.joints_m),
        joints_px=(pixels, pixels),
        pose=tuple(pose.tolist()),
        angles_raw_deg=tuple(found.pose[list(ANGLES_IN_POSE)].tolist()),
        confidence=tuple(np.where(outside, 0.0, found.confidence).tolist()),
        score=(found.score, 0.0) if state.number == 1 else (0.0, found.score),
        facing=(facing, facing),
        bdp=state.bdp,
        matches=2 + (0 if fit is None else fit.matches),
    )


def _outside(report: Report, places_px: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which joints the picture does not show, (15,): what is said of them is a guess."""
    shown = (places_px >= 0) & (places_px <= (report.width, report.height))
    outside: NDArray[np.bool_] = np.logical_not(shown.all(axis=1)) & report.cut
    return outside


def _point(place: Vector) -> Point:
    x, y, z = (float(value) for value in place)
    return (x, y, z)


def _pixels(pixels: NDArray[np.float64]) -> tuple[Pixel, ...]:
    return tuple((float(u), float(v)) for u, v in np.nan_to_num(pixels, nan=-1.0))
