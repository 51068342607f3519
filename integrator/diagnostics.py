"""Oddities of a performance, one line each, with what was assumed instead."""

from typing import Final, NamedTuple

from common.bus.instant import Instant
from common.bus.messages import CameraFault, View
from integrator import merge_state
from integrator.measuring.known_body import Measured

DOUBTED: Final = 0.5
"""Share of the joints' confidence below which a rig is reported as doubtful."""


class Useless(NamedTuple):
    """Number of one camera's pictures that showed no scene."""

    faults: tuple[CameraFault, ...] = ()
    frames: int = 0
    since_s: float = 0.0
    """Time of the first of them."""


class State(NamedTuple):
    """How often each viewer saw a person, and how often only a part of one."""

    seen: tuple[int, ...] = ()
    """By view, in the order of the rig's cameras; empty before the first instant."""
    cut: tuple[int, ...] = ()
    useless: tuple[Useless, ...] = ()


def step(state: State, instant: Instant) -> State:
    """Process one instant."""
    views = instant.views
    if not state.seen:
        state = State((0,) * len(views), (0,) * len(views), (Useless(),) * len(views))
    detected = [view is not None and view.person is not None for view in views]
    partly = [seen is not None and seen.cut for seen in instant.detections]
    return State(
        tuple(before + now for before, now in zip(state.seen, detected, strict=True)),
        tuple(before + now for before, now in zip(state.cut, partly, strict=True)),
        tuple(_with(own, each) for own, each in zip(state.useless, views, strict=True)),
    )


def _with(own: Useless, report: View | None) -> Useless:
    if report is None or not report.fault:
        return own
    since_s = own.since_s if own.frames else report.captured_s
    return Useless((*{*own.faults, report.fault},), own.frames + 1, since_s)


def assumed(merged: merge_state.State) -> list[str]:
    """Oddities known from the start: no calibration."""
    if merged.scale_source == "calibrated":
        return []
    if merged.scale_source == "person":
        return [
            "no calibration: the cameras are calibrated by the person, the scale by a stature of "
            f"{merged.settings.body.stature_m:g} m (keep it: tritrack calibrate person)"
        ]
    return [
        "no calibration: a rig of the paper's kind is assumed, its scale from a stature of "
        f"{merged.settings.body.stature_m:g} m (make one: tritrack calibrate person)"
    ]


def doubt(merged: merge_state.State) -> str:
    """The report of a rig that the views contradict; "" while they do not, or without a rig."""
    told, trusts = merged.agreement.told, merged.settings.trust_calibration
    if told is None or told.believed > DOUBTED or trusts or merged.scale_source == "assumed":
        return ""
    return (
        f"the calibration is not believable: views {told.apart_mm:.0f} mm apart, soles "
        f"{told.soles_mm:+.0f} mm over the floor, facings {told.facing_deg:.0f} degrees and "
        f"motions {told.motion_mm:.0f} mm apart; "
        "joints are told with less confidence: calibrate again (tritrack calibrate person), or "
        "set trust_calibration = true"
    )


def different_people(merged: merge_state.State) -> list[str]:
    """The report that views followed different people; empty while they did not."""
    same = merged.same
    views = [(view, frames) for view, frames in enumerate(same.left_out, 1) if frames]
    if not views or same.since_s is None:
        return []
    counts = " and ".join(f"view {view} was left out in {frames} frames" for view, frames in views)
    return [
        f"the views followed different people, first at {same.since_s:.1f} s: their sight lines do "
        f"not meet; {counts}"
    ]


def warnings(state: State, merged: merge_state.State) -> list[str]:
    """All oddities, once the performance is over."""
    lines = [*assumed(merged), *different_people(merged)]
    if any(state.seen) and not isinstance(merged.person.body, Measured):
        lines.append(
            "nobody took the opening posture, upright with stretched arms, facing camera 1 and "
            "seen from the side by camera 2: the body has the thesis's proportions, unmeasured"
        )
    for viewer, own in enumerate(state.useless, 1):
        if own.frames:
            lines.append(
                f"the picture of camera {viewer} is {' or '.join(sorted(own.faults))} in "
                f"{own.frames} frames, first at {own.since_s:.1f} s: it was left out there"
            )
    for viewer, (seen, cut) in enumerate(zip(state.seen, state.cut, strict=True), 1):
        if cut:
            lines.append(
                f"viewer {viewer} saw the person partly outside its picture in {cut} of {seen} "
                "frames: what is outside is guessed"
            )
    return lines
