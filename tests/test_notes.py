"""The user's inputs: what is said once holds until something else is said (T21, T26)."""

from hypothesis import given, settings
from hypothesis import strategies as st

from common.body.body import JOINT_NAMES, LIMBS
from common.notes.notes import ORIENTATIONS, Held, Note, Notes, held, noted

ways = st.sampled_from(["toward", "away", "auto"])
places = st.tuples(st.floats(0, 999), st.floats(0, 999)) | st.just("auto")
inputs = st.builds(
    Note,
    frame=st.integers(0, 40),
    orientation=st.none() | st.sampled_from([*ORIENTATIONS, "auto"]),
    depth=st.dictionaries(st.sampled_from(LIMBS), ways, max_size=3),
    joints_px=st.dictionaries(st.sampled_from(JOINT_NAMES), places, max_size=3),
)


def test_the_dancer_turns_and_the_orientation_holds_until_the_next_turn() -> None:
    """T22: one input a change of orientation; T21: a direction of depth "rarely changes"."""
    notes = Notes(
        note=(
            Note(0, "forward_left", {"l_upper_arm": "toward"}),
            Note(30, "backward_left"),
            Note(50, None, {"l_upper_arm": "away"}),
        )
    )
    assert held(notes, 29) == Held("forward_left", {"l_upper_arm": "toward"})
    assert held(notes, 30) == Held("backward_left", {"l_upper_arm": "toward"})
    assert held(notes, 1000) == Held("backward_left", {"l_upper_arm": "away"})


def test_before_the_first_note_the_program_decides() -> None:
    assert held(Notes(note=(Note(5, "left"),)), 4) == Held()


def test_auto_gives_every_kind_of_decision_back() -> None:
    given_up = Note(9, "auto", {"torso": "auto"}, {"l_wrist": "auto"})
    notes = Notes(note=(Note(5, "left", {"torso": "away"}, {"l_wrist": (1.0, 2.0)}), given_up))
    assert held(notes, 8) == Held("left", {"torso": "away"}, {"l_wrist": (1.0, 2.0)})
    assert held(notes, 9) == Held()


@settings(max_examples=40)
@given(st.lists(inputs, max_size=6), inputs)
def test_an_input_changes_what_it_names_from_its_frame_on_and_nothing_else(
    earlier: list[Note], new: Note
) -> None:
    notes = Notes()
    for each in earlier:
        notes = noted(notes, each)
    after = noted(notes, new)
    for frame in range(new.frame):
        assert held(after, frame) == held(notes, frame)
    at = held(after, new.frame)
    before = held(notes, new.frame)
    wanted = before.orientation if new.orientation is None else new.orientation
    assert (at.orientation or "auto") == (wanted or "auto")
    for name in LIMBS:
        assert at.depth.get(name, "auto") == new.depth.get(name, before.depth.get(name, "auto"))
    for name in JOINT_NAMES:
        said = new.joints_px.get(name, before.joints_px.get(name, "auto"))
        assert at.joints_px.get(name, "auto") == said


def test_saying_again_what_holds_leaves_no_note() -> None:
    notes = Notes(note=(Note(3, "left"),))
    assert noted(notes, Note(7, "left")) == notes
    assert noted(notes, Note(3, "auto")) == Notes()
