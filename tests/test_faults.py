"""What goes wrong, told apart: exit code 2 for what a user can mend, 1 for faults."""

import errno
import tempfile
from pathlib import Path

import pytest

from common.config.part_settings import SettingsError
from runtime.faults import Fault, Unfollowed, code_of, refuse_unfollowed, told


@pytest.mark.parametrize(
    "error",
    [SettingsError("size must look like 160x120"), OSError(errno.ENOSPC, "No space left")],
    ids=["a class of ours", "a full disk"],
)
def test_what_a_user_can_mend_is_told_as_it_is(error: Exception) -> None:
    assert (code_of(error), told(error)) == (2, str(error))


def test_a_name_that_is_too_long_is_said_so() -> None:
    """Any command and option may meet one, at the first look at the path."""
    with pytest.raises(OSError, match="too long") as raised:
        Path("a" * 300).is_file()
    assert code_of(raised.value) == 2
    assert told(raised.value) == f"the name '{'a' * 60}'... is too long: use a shorter one"


def test_a_fault_is_one_line_and_its_traceback_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    error = ValueError("axis 1 is out of bounds\nfor array of dimension 1")
    line = told(error)
    (kept,) = tmp_path.iterdir()
    assert code_of(error) == 1
    assert line.startswith("a fault of tritrack itself (ValueError: axis 1 is out of bounds for")
    assert line.endswith(f"please report {kept}")
    assert "ValueError: axis 1 is out of bounds" in kept.read_text()


def test_a_fault_that_another_process_met_is_told_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    error = Fault("viewer 1: a fault of tritrack itself")
    assert (code_of(error), told(error)) == (1, "viewer 1: a fault of tritrack itself")
    assert not list(tmp_path.iterdir())


def test_clips_that_are_mostly_not_followed_end_a_run_with_code_3() -> None:
    refuse_unfollowed({"good": {"followed": 0.5}})
    with pytest.raises(Unfollowed, match=r"in 1 of 2 clips .* \(bad: 49%\)") as raised:
        refuse_unfollowed({"good": {"followed": 1.0}, "bad": {"followed": 0.49}})
    assert code_of(raised.value) == 3
    assert told(raised.value) == str(raised.value)


def test_a_clip_that_was_not_read_to_its_end_goes_before_how_much_of_it_is_followed() -> None:
    lost = {"followed": None, "unread": {"clips/a/cam1.mp4": {"read": 15, "of": 228}}}
    with pytest.raises(Unfollowed, match=r"\(clips/a/cam1\.mp4: 15 of 228\)") as raised:
        refuse_unfollowed({"good": {"followed": 1.0}, "a": lost})
    assert code_of(raised.value) == 3


def test_a_clip_that_shows_nobody_is_not_followed_and_that_is_said() -> None:
    with pytest.raises(Unfollowed, match=r"in 1 of 2 clips .* \(empty: nobody was found\)"):
        refuse_unfollowed({"good": {"followed": 1.0}, "empty": {"followed": None}})
