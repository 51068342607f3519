"""Commands from the page to the integrator."""

from typing import Final

from common.bus.control_messages import Answer, Command
from common.notes.notes import ORIENTATIONS, Orientation
from integrator.measuring.known_body import Unknown, Unmeasured
from integrator.merge_state import State
from integrator.single.sight import Annotations

OTHERWISE: Final[dict[str, Orientation]] = {"front": "forward_right", "back": "backward_right"}
"""Default orientations for "front" and "back", where nothing else is known."""


def step(
    state: State, said: Annotations, command: Command
) -> tuple[State, Annotations, Answer | None]:
    """One command: the state after it, the inputs for the next instant, and the answer.

    Args:
        state: Before it.
        said: Inputs for the next instant so far.
        command: Any command; the answer is None where it is not for the integrator.
    """
    if command.what == "measure":
        return _unmeasured(state), said, _answer(command, True, _how_to_stand(state))
    if command.what not in OTHERWISE:
        return state, said, None
    found = state.person.found
    alone = None if found is None else found.alone
    if alone is None:
        seen = "nobody is seen" if found is None else "both cameras see front and back"
        return state, said, _answer(command, False, f"{seen}: this is for one camera alone")
    facing = _turned(alone.lifting.orientation, command.what)
    word = f"the person is taken to face {facing.replace('_', ' ')} from now on"
    return state, said._replace(orientation=facing), _answer(command, True, word)


def _unmeasured(state: State) -> State:
    """The state in which the body will be measured again; until then it keeps its lengths."""
    body = state.person.body
    if isinstance(body, Unknown):
        return state
    return state._replace(person=state.person._replace(body=Unmeasured(body.bdp)))


def _how_to_stand(state: State) -> str:
    found = state.person.found
    if state.rig is not None and (found is None or found.alone is None):
        return "stand upright with both arms stretched out level: the body is measured then"
    return "the body's lengths are told from its outline anew"


def _turned(before: str, to: str) -> Orientation:
    """The same side of the picture with front and back exchanged: one of ORIENTATIONS."""
    side = before.rpartition("_")[2]
    name = f"{'forward' if to == 'front' else 'backward'}_{side}"
    return next((one for one in ORIENTATIONS if one == name), OTHERWISE[to])


def _answer(command: Command, well: bool, text: str) -> Answer:
    return Answer(what=command.what, well=well, text=text)
