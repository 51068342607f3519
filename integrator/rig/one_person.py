"""An instant with one person in all views, and what is forgotten where they followed several."""

from calibration.gate import rig_agreement
from common.body.body import Vector
from common.bus.instant import Instant
from integrator import belief
from integrator.measuring.known_body import Unknown, Unmeasured
from integrator.merge_state import State
from integrator.person import Following, Person, Waiting
from integrator.rig import same_person
from integrator.rig.undistortion import undistorted_instant, undistorted_rig


def step(state: State, instant: Instant) -> tuple[State, Instant, Instant]:
    """The instant with the same person in all views, as it is and without distortion.

    An assumed rig does not tell people apart.
    """
    shown = undistorted_instant(state.rig, instant)
    if state.rig is None or state.scale_source == "assumed":
        return state, instant, shown
    lasting = belief.lost_frames(state.period_s)
    expected = same_person.Expected(_place_m(state.person), lasting)
    same = same_person.step(state.same, undistorted_rig(state.rig), shown, expected)
    if same.is_apart and not state.same.is_apart:
        state = _without_another(state, lasting)
    own = same.chosen
    return (
        state._replace(same=same),
        same_person.of_person(instant, own),
        same_person.of_person(shown, own),
    )


def _without_another(state: State, lasting: int) -> State:
    """The state without what came of two people: agreement, pose, and a body that is a prior of
    both, where their views have not shown one person before."""
    body = state.person.body
    if isinstance(body, Unmeasured) and state.same.met < lasting:
        body = Unknown()
    person = Waiting(body, state.person.ever_confirmed)
    return state._replace(agreement=rig_agreement.State(), person=person)


def _place_m(person: Person) -> Vector | None:
    """Expected place of the person, (3,); None where none is followed or believed."""
    return person.pose[:3] if isinstance(person, Following) and not person.doubted else None
