"""Notes on disk: what is written is read again, and mistakes are named by line, key and cure."""

import errno
import os
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_notes import inputs

from common.notes.notes import Note, Notes, noted
from common.notes.notes_file import (
    MAX_BYTES,
    NotesError,
    load_notes,
    notes_path,
    save_notes,
)


@pytest.mark.slow
@settings(max_examples=30)
@given(st.lists(inputs, max_size=6), st.text(max_size=8))
def test_what_is_written_is_read_again(
    tmp_path_factory: pytest.TempPathFactory, given_notes: list[Note], video: str
) -> None:
    notes = Notes(video)
    for each in given_notes:
        notes = noted(notes, each)
    path = tmp_path_factory.getbasetemp() / "notes.toml"
    save_notes(path, notes)
    assert load_notes(path) == notes


def test_a_file_as_people_write_it_is_read(tmp_path: Path) -> None:
    """TOML has several ways to say the same; the order of notes does not matter."""
    path = tmp_path / "notes.toml"
    path.write_text(
        "[[note]]\nframe = 40\n[note.depth]\nl_upper_arm = 'away'  # the arm swings back\n"
        "[[note]]\nframe = 0\norientation = 'left'\njoints_px = {l_wrist = [10, 20.5]}\n"
    )
    first = Note(0, "left", {}, {"l_wrist": (10.0, 20.5)})
    assert load_notes(path).note == (first, Note(40, None, {"l_upper_arm": "away"}))


WRITTEN = """# my dance

video = "dance.avi"  # the second take

# she turns here
[[note]]
frame = 40
orientation = "left"  # or so it seems
[note.depth]
l_upper_arm = 'away'  # the arm swings back

[[note]]
frame = 0
depth.torso = "toward"
depth.head = "away"
"""


def test_what_people_write_beside_their_notes_stays(tmp_path: Path) -> None:
    """A comment, an order, a style: the page changes what it was told to, and nothing else."""
    path = tmp_path / "notes.toml"
    path.write_text(WRITTEN)
    notes = load_notes(path)
    save_notes(path, notes)
    assert path.read_text() == WRITTEN
    for new in (
        Note(40, "right", {"r_upper_arm": "toward"}),
        Note(0, depth={"torso": "away"}),
        Note(20, None, {}, {"l_wrist": (10.0, 20.5)}),
    ):
        notes = noted(notes, new)
        save_notes(path, notes)
        assert load_notes(path) == notes
    for kept in (
        "# my dance",
        "# the second take",
        "# she turns here",
        "# or so it seems",
        "# the arm swings back",
        'depth.head = "away"',
    ):
        assert kept in path.read_text()


@settings(max_examples=30)
@given(st.lists(inputs, max_size=6))
def test_whatever_is_said_to_a_written_file_is_read_again(
    tmp_path_factory: pytest.TempPathFactory, given_notes: list[Note]
) -> None:
    path = tmp_path_factory.getbasetemp() / "notes.toml"
    path.write_text(WRITTEN)
    notes = load_notes(path)
    for each in given_notes:
        notes = noted(notes, each)
        save_notes(path, notes)
        assert load_notes(path) == notes


def test_a_file_that_was_spoilt_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "notes.toml"
    path.write_text("[[note]]\nframe 1")
    with pytest.raises(NotesError, match=r"was changed and is no TOML: .*mend that line"):
        save_notes(path, Notes(note=(Note(2, "right"),)))
    assert path.read_text() == "[[note]]\nframe 1"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[[note]]\nframe = 1\norientation = 'fwd'", "line 3, orientation: .*fwd.*forward_left"),
        ("[[note]]\nframe = -1", "line 2, frame: .*-1.*counted from 0"),
        ("[[note]]\nframe = 'x'", "line 2, frame: .*got text.*number of a frame"),
        ("[[note]]\norientation = 'left'", "line 1, frame: .*missing.*number of a frame"),
        ("[[note]]\nframe=1\n[note.depth]\narm='away'", "line 3, depth: .*arm.*l_upper_arm"),
        ("[[note]]\nframe=1\ndepth.torso='up'", "line 3, depth: .*up.*toward"),
        ("[[note]]\nframe=1\njoints_px.l_wrst=[1,2]", "line 3, joints_px: .*l_wrst.*l_wrist"),
        ("[[note]]\nframe=1\njoints_px.l_wrist=[1]", r"line 3, joints_px: .*\[column, row\]"),
        ("[[note]]\nframe=1\njoints_px.l_wrist=[nan,2]", "line 3, joints_px: .*no place"),
        ("[[note]]\nframe=0\n\n[[note]]\nframe=1\nturn='left'", "line 6, turn: .*orientation"),
        ("[[note]]\nframe=1\n[[note]]\nframe=1", "two of frame 1: join them"),
        ("[[note]]\nframe 1", "line 2.*mend that line"),
        ("note = 3", r"note: .*begin each with \[\[note\]\]"),
        ("notes = 3", "notes: .*unknown.*known are .*note"),
    ],
)
def test_a_mistake_is_named_by_line_key_and_cure(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "notes.toml"
    path.write_text(text)
    with pytest.raises(NotesError, match=f"notes.toml.*{said}") as error:
        load_notes(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("content", [b"\xff\xfe\0", b"#" * (MAX_BYTES + 1), b"a=" + b"[" * 9999])
def test_what_is_no_text_too_long_or_too_deep_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "notes.toml"
    path.write_bytes(content)
    with pytest.raises(NotesError, match=r"notes\.toml"):
        load_notes(path)


def test_notes_that_are_not_there_are_named(tmp_path: Path) -> None:
    with pytest.raises(NotesError, match=r"absent\.toml: No such file.*name another"):
        load_notes(tmp_path / "absent.toml")


def test_a_full_disk_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "notes.toml"
    save_notes(path, Notes(note=(Note(1, "left"),)))

    def full(*_: Any) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(NotesError, match=r"No space left.*untouched"):
        save_notes(path, Notes(note=(Note(2, "right"),)))
    assert load_notes(path).note == (Note(1, "left"),)
    assert [each.name for each in tmp_path.iterdir()] == ["notes.toml"]


def test_videos_of_one_folder_do_not_share_their_notes(tmp_path: Path) -> None:
    first, second = tmp_path / "walk.avi", tmp_path / "dance.avi"
    shared = tmp_path / "notes.toml"
    assert notes_path(first) == notes_path(second) == shared
    save_notes(shared, Notes(first.name))
    assert notes_path(first) == shared
    assert notes_path(second) == tmp_path / "dance.notes.toml"


def test_notes_without_a_videos_name_are_of_any_video_beside_them(tmp_path: Path) -> None:
    save_notes(tmp_path / "notes.toml", Notes())
    assert notes_path(tmp_path / "dance.avi") == tmp_path / "notes.toml"
