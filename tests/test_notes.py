"""The user's inputs: what is said once holds until something else is said (T21, T26)."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.body.body import JOINT_NAMES, LIMBS
from common.notes.notes import ORIENTATIONS, Held, Note, Notes, held, noted, placed_once

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


def test_notes_are_in_the_order_of_frames_and_one_frame_has_one() -> None:
    notes = Notes("a.avi", (Note(9, "left"), Note(0, "right"), Note(4, "auto")))
    assert [note.frame for note in notes.note] == [0, 4, 9]
    with pytest.raises(ValueError, match=r"^note: two of frame 4: join them$"):
        Notes(note=(Note(4, "left"), Note(1), Note(4, "right")))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"frame": -1}, "frame must not be negative, got -1"),
        ({"frame": 0, "depth": {"torso": "away", "tail": "away"}}, "depth knows no tail"),
        ({"frame": 0, "joints_px": {"nose": (1.0, 2.0)}}, "joints_px knows no nose"),
        ({"frame": 0, "joints_px": {"l_wrist": (1.0, 1.1e5)}}, "joints_px has l_wrist at no place"),
        ({"frame": 0, "joints_px": {"l_wrist": (-1.1e5, 1.0)}}, r"place of a picture: \(-110000"),
        (
            {"frame": 0, "joints_px": {"l_wrist": (1.0, float("inf"))}},
            "joints_px has l_wrist at no",
        ),
    ],
)
def test_what_no_video_could_have_is_refused(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Note(**wrong)
    Note(0, joints_px={"l_wrist": (-1e5, 1e5), "r_wrist": "auto"})


def test_an_input_joins_what_was_said_at_its_frame_and_goes_before_it() -> None:
    notes = Notes("a.avi", (Note(3, "left", {"torso": "away"}, {"l_wrist": (1.0, 2.0)}),))
    new = Note(3, "right", {"torso": "toward", "head": "away"}, {"r_wrist": (3.0, 4.0)})
    joined = noted(notes, new)
    assert joined.video == "a.avi"
    assert joined.note == (
        Note(
            3,
            "right",
            {"torso": "toward", "head": "away"},
            {"l_wrist": (1.0, 2.0), "r_wrist": (3.0, 4.0)},
        ),
    )


def test_a_joint_that_is_placed_once_is_where_it_was_before_in_the_next_frame() -> None:
    empty = placed_once(Notes(), 5, "l_wrist", (7.0, 8.0))
    assert [held(empty, n).joints_px for n in (4, 5, 6)] == [{}, {"l_wrist": (7.0, 8.0)}, {}]
    before = Notes(note=(Note(2, joints_px={"l_wrist": (1.0, 2.0), "r_wrist": (3.0, 4.0)}),))
    after = placed_once(before, 5, "l_wrist", (7.0, 8.0))
    assert [held(after, n).joints_px["l_wrist"] for n in (4, 5, 6)] == [
        (1.0, 2.0),
        (7.0, 8.0),
        (1.0, 2.0),
    ]
    assert [held(after, n).joints_px["r_wrist"] for n in (5, 6)] == [(3.0, 4.0)] * 2
    moved = Notes(note=(*before.note, Note(6, joints_px={"l_wrist": (9.0, 9.0)})))
    assert held(placed_once(moved, 5, "l_wrist", (7.0, 8.0)), 6).joints_px["l_wrist"] == (9.0, 9.0)


def test_notes_that_repeat_what_holds_are_left_out_and_those_that_follow_stay() -> None:
    notes = Notes(
        note=(
            Note(3, "left", {"torso": "away"}),
            Note(7, "left", {"torso": "away", "head": "toward"}, {"l_wrist": (1.0, 2.0)}),
            Note(9, None, {}, {"l_wrist": (1.0, 2.0)}),
        )
    )
    assert noted(notes, Note(20, "right")).note == (
        Note(3, "left", {"torso": "away"}),
        Note(7, None, {"head": "toward"}, {"l_wrist": (1.0, 2.0)}),
        Note(20, "right"),
    )


def test_what_is_given_back_though_no_one_took_it_is_no_note() -> None:
    given_back = Note(3, "auto", {"torso": "auto"}, {"l_wrist": "auto"})
    assert noted(Notes(), given_back) == Notes()
