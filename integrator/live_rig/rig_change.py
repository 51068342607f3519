"""From one rig to another while a run goes on: what is remembered, in the world of the new one."""

import msgspec

from common.body.body import ANGLE_NAMES
from common.bus.messages import Report
from common.rig.camera import Rig
from integrator import opening_posture
from integrator.live_rig.rig_job import Solved
from integrator.merge_state import State
from integrator.pose import smoothing
from integrator.rig_gate import rig_agreement


def with_rig(state: State, rig: Rig) -> State:
    """The state as if the person came in now, before a rig that they told.

    Where somebody stands, and how, is looked for afresh: the world is another one. Their body is
    kept: what the opening posture measured, by the new rig, or else the stature that the rig is
    told by.
    """
    body = state.settings.body
    opening = opening_posture.elsewhere(
        state.opening, rig, body.opening_frames, state.method, body.stature_m
    )
    return state._replace(
        rig=rig,
        scale_source="person",
        calibration=state.calibration + 1,
        proposes=True,
        smooth=smoothing.init(len(ANGLE_NAMES), state.smooth.period_s),
        opening=opening,
        found=None,
        facing=("facade", "flank"),
        doubted=0,
        agreement=rig_agreement.State(),
    )


def set_back(report: Report, late_s: float) -> Report:
    """A report with its times set back where it is view 2's; the room's clock stays as it is."""
    if report.viewer == 1 or not late_s:
        return report
    next_s = None if report.next_s is None else report.next_s - late_s
    return msgspec.structs.replace(report, captured_s=report.captured_s - late_s, next_s=next_s)


def word_of(solved: Solved, late_s: float) -> str:
    """What is said of a change."""
    assert solved.trust is not None
    first = "the cameras are now calibrated by the person"
    text = first if solved.before is None else "a better calibration by the person is used now"
    late = f", camera 2 {1e3 * late_s:+.0f} ms late" if late_s else ""
    return (
        f"{text}: views {solved.trust.apart_mm:.0f} mm apart, camera 2 known to "
        f"{solved.turn_error_deg:.0f} degrees{late}; the body jumps to the new axes here"
    )
