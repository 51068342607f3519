"""One view alone: its stick body lifted into the room, and what its outline proposes (3.1.5)."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, Vector
from common.body.proportions import thesis_bdp
from common.body.stick_body import Stickman
from common.bus.messages import (
    Body,
    Facing,
    Pixel,
    Point,
    Report,
    ViewerNumber,
)
from common.rig.camera import Camera, project
from integrator.fit.joint_refinement import GOOD
from integrator.pose import joint_limits, smoothing
from integrator.single import depth_signs
from integrator.single.reflection import Front
from integrator.single.single_hypotheses import (
    Hypothesis,
    Inputs,
    Settled,
    State,
    lifted_body,
    proposed_body,
    remembered,
    settled_body,
)
from integrator.track_status import LOST_SCORE, status_of

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
    return State(number, camera, man, bdp, stature_m, printed, smooth, depth_signs.init())


class Glance(NamedTuple):
    """What the outline alone says of a frame."""

    state: State
    proposed: Hypothesis | None
    """None where nothing is proposed, or not what the user says."""

    @property
    def suffices(self) -> bool:
        """Whether the proposed body fits so well that no stick body is asked for."""
        return self.proposed is not None and self.proposed.score >= GOOD


def glance(state: State, report: Report, told: Inputs) -> Glance:
    """What is proposed of a frame with somebody; nothing as the thesis prints it.

    Args:
        state: What is remembered.
        report: A fit is not needed.
        told: The user's inputs, which go before all else.
    """
    if state.printed:
        return Glance(state, None)
    return Glance(*proposed_body(state, report, told, _since_s(state, report)))


def step(seen: Glance, report: Report, told: Inputs) -> tuple[State, Body, Settled]:
    """One frame with somebody: a lifted body competes with the proposed one, by S.

    Args:
        seen: What the outline says.
        report: With a fit, unless what is proposed suffices.
        told: The user's inputs, which go before all else.
    """
    state, found = seen
    if report.fit is None:
        assert found is not None
        state = remembered(state, found)
    else:
        state, lifted = lifted_body(state, report, told)
        if found is None or lifted.score >= SURELY * found.score:
            found = lifted
        if not state.printed:
            found = settled_body(state, report, found, told)
    return _published(state, report, found)


def _published(state: State, report: Report, found: Hypothesis) -> tuple[State, Body, Settled]:
    """What is told of the body that was found, its angles smooth."""
    dt_s = _since_s(state, report)
    fits = found.score >= LOST_SCORE
    raw = found.pose[list(ANGLES_IN_POSE)]
    smooth, angles, _ = smoothing.step(state.smooth, raw, dt_s)
    if not state.printed:
        angles = joint_limits.clipped(angles)
    badly = 0 if fits else state.badly + 1
    state = state._replace(smooth=smooth, pose=found.pose, last_s=report.captured_s, badly=badly)
    return state, _body(state, report, found, angles), found.settled


def _since_s(state: State, report: Report) -> float:
    return 0.0 if state.last_s is None else max(0.0, report.captured_s - state.last_s)


def nobody(state: State, frame: int, captured_s: float) -> tuple[State, Body, Settled]:
    """A frame without anybody: what was learnt of the body is kept, its pose is not."""
    fresh = smoothing.init(len(ANGLE_NAMES), state.smooth.period_s)
    state = state._replace(
        smooth=fresh, memory=depth_signs.init(), recall=None, front=Front(), pose=None, badly=0
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
