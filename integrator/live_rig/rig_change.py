"""Change of the rig during a run: the state, converted to the new world."""

import msgspec

from calibration.gate import moved_cameras, rig_agreement
from calibration.gate.moved_cameras import MovedCameras
from common.bus.messages import View, ViewerNumber
from common.rig.camera import Rig
from common.rig.turned_camera import angle_deg
from integrator.live_rig.rig_job import Solved
from integrator.measuring import opening_posture
from integrator.merge_state import State, facing_at_start
from integrator.person import Waiting
from integrator.rig import same_person


def with_rig(state: State, rig: Rig) -> State:
    """The state with a new rig; the person is handled as if they had just appeared.

    The person's place and pose are searched anew: the world has changed. Their body is kept: the
    measurement of the opening posture, recomputed by the new rig, or else the stature that the rig
    is based on. Where a camera keeps its position the world stays too, and with it all of the body.
    """
    before, source = state.person, state.scale_source
    settings, body = state.settings.body, before.body
    if state.rig is None or not is_same_world(state.rig, rig):
        source = "person"
        body = opening_posture.elsewhere(
            body, rig, settings.opening_frames, state.method, settings.stature_m
        )
    return state._replace(
        rig=rig,
        scale_source=source,
        calibration=state.calibration + 1,
        proposes=True,
        person=Waiting(body, before.ever_confirmed),
        facing=facing_at_start(len(rig.cameras)),
        same=same_person.State(left_out=state.same.left_out, since_s=state.same.since_s),
        agreement=rig_agreement.State(),
        stands=moved_cameras.told_by(state.stands, state.rig, rig),
    )


def is_same_world(before: Rig, rig: Rig) -> bool:
    """Whether at least one camera keeps its position: otherwise the world is new."""
    return any(
        moved_cameras.stays(one, other)
        for one, other in zip(before.cameras, rig.cameras, strict=True)
    )


def set_back(view: View, late_s: float) -> View:
    """The view with its times set back where it is camera 2's; the room's clock stays as it is."""
    if view.viewer != 2 or not late_s:
        return view
    next_s = None if view.next_s is None else view.next_s - late_s
    return msgspec.structs.replace(view, captured_s=view.captured_s - late_s, next_s=next_s)


def word_of(solved: Solved, late_s: float, moved: tuple[ViewerNumber, ...] = ()) -> str:
    """The report of a change, of moved cameras or of all."""
    known = f"views {solved.trust.apart_mm:.0f} mm apart"
    if moved:
        return f"{cameras_named(moved)} placed anew by the person: {known}"
    first = "the cameras are now calibrated by the person"
    text = first if solved.before is None else "a better calibration by the person is used now"
    late = f", camera 2 {1e3 * late_s:+.0f} ms late" if late_s else ""
    return (
        f"{text}: {known}, camera 2 known to {solved.turn_error_deg:.0f} degrees{late}; the body "
        "jumps to the new axes here"
    )


def word_of_moved(rig: Rig, stands: MovedCameras) -> str:
    """The report of cameras of a rig that have just been moved."""
    by_deg = [
        angle_deg(
            moved_cameras.turn_since(rig.cameras[n - 1], stands.of_rig[n - 1], stands.now[n - 1])
        )
        for n in stands.moved
    ]
    turned = " and ".join(f"{deg:.1f}" for deg in by_deg)
    return (
        f"{cameras_named(stands.moved)} moved, its picture turned by {turned} degrees: the rig is "
        "turned with it, and half believed until the person has told where it stands"
    )


def cameras_named(numbers: tuple[ViewerNumber, ...]) -> str:
    """A phrase for the moved cameras: "camera 2 was", "both cameras were"."""
    if len(numbers) == 1:
        return f"camera {numbers[0]} was"
    named = " and ".join(str(number) for number in numbers)
    return "both cameras were" if numbers == (1, 2) else f"cameras {named} were"
