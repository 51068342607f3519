"""Oddities of a performance, one line each, with what was assumed instead."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from common.bus.instant import Instant, Seen
from common.bus.messages import CameraFault, View
from integrator import merge_state

MOST_NOTICED: Final = 20
"""Upper bound of the people about whom a run's warnings speak."""
DOUBTED: Final = 0.5
"""Share of the joints' confidence below which a rig is reported as doubtful."""


class Useless(NamedTuple):
    """Number of one camera's pictures that showed no scene."""

    faults: tuple[CameraFault, ...] = ()
    frames: int = 0
    since_s: float = 0.0
    """Time of the first of them."""


class Present(NamedTuple):
    """A person at an instant."""

    number: int
    """Their number; 0: of a run that follows one person."""
    seen: Seen
    """By view."""
    measured: bool
    """Whether they were measured in the opening posture."""


class Noticed(NamedTuple):
    """What was noticed of one person."""

    number: int
    """Their number; 0: of a run that follows one person."""
    seen: tuple[int, ...]
    """For each view, the number of instants in which it showed them."""
    cut: tuple[int, ...]
    """For each view, in how many of these it showed a part of them only."""
    measured: bool = False
    """Whether they were ever measured in the opening posture."""


class State(NamedTuple):
    """How often each viewer saw each person, and how often only a part of them."""

    people: tuple[Noticed, ...] = ()
    """In the order in which they were first seen; the first MOST_NOTICED."""
    useless: tuple[Useless, ...] = ()
    """By view, in the order of the rig's cameras; empty before the first instant."""


def step(state: State, instant: Instant, present: Sequence[Present]) -> State:
    """Process one instant.

    Args:
        state: Of the instant before.
        instant: The viewers' reports.
        present: The people whom the integrator knows.
    """
    useless = state.useless or (Useless(),) * len(instant.views)
    people = {one.number: one for one in state.people}
    for one in present:
        if any(one.seen) and (one.number in people or len(people) < MOST_NOTICED):
            people[one.number] = _noticed(people.get(one.number), one)
    return State(
        tuple(people.values()),
        tuple(_with(own, each) for own, each in zip(useless, instant.views, strict=True)),
    )


def _noticed(before: Noticed | None, now: Present) -> Noticed:
    """A person after one more instant in which they are seen."""
    none = (0,) * len(now.seen)
    before = before or Noticed(now.number, none, none)
    there = [one is not None for one in now.seen]
    partly = [one is not None and one.cut for one in now.seen]
    return Noticed(
        now.number,
        tuple(was + here for was, here in zip(before.seen, there, strict=True)),
        tuple(was + here for was, here in zip(before.cut, partly, strict=True)),
        before.measured or now.measured,
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
    lines = [*assumed(merged), *different_people(merged), *_unmeasured(state.people)]
    for viewer, own in enumerate(state.useless, 1):
        if own.frames:
            lines.append(
                f"the picture of camera {viewer} is {' or '.join(sorted(own.faults))} in "
                f"{own.frames} frames, first at {own.since_s:.1f} s: it was left out there"
            )
    return [*lines, *_cut_off(state.people, len(state.useless))]


def _unmeasured(people: Sequence[Noticed]) -> list[str]:
    """The warning about people who did not take the opening posture."""
    if not people or all(one.measured for one in people):
        return []
    numbers = [str(one.number) for one in people if not one.measured and one.number]
    said = "nobody took the opening posture"
    if numbers:
        said = f"{_people(numbers)} did not take the opening posture"
    return [
        f"{said}, upright with stretched arms, facing camera 1 and seen from the side by "
        "camera 2: the body has the thesis's proportions, unmeasured"
    ]


def _cut_off(people: Sequence[Noticed], views: int) -> list[str]:
    """For each view, the warning about people who were partly outside its picture."""
    lines = []
    for view in range(views):
        partly = [
            f"{_name(one.number)} partly outside its picture in {one.cut[view]} of "
            f"{one.seen[view]} frames"
            for one in people
            if one.cut[view]
        ]
        if partly:
            lines.append(f"viewer {view + 1} saw {', '.join(partly)}: what is outside is guessed")
    return lines


def _name(number: int) -> str:
    return f"person {number}" if number else "the person"


def _people(numbers: Sequence[str]) -> str:
    """Numbers of people, as in "persons 1, 2 and 4"."""
    *others, last = numbers
    return f"persons {', '.join(others)} and {last}" if others else f"person {last}"
