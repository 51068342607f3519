"""Options that are refused at the door: with the number that was given, and what was meant."""

from pathlib import Path

import pytest
import typer

from common.atomic_file import FileRefused
from tritrack.commands.options import (
    fov_given,
    numbers_given,
    size_given,
    square_given,
    stature_given,
    views_given,
    writable,
    writable_file,
)


def test_a_folder_is_tried_where_its_nearest_that_is_there_lies(tmp_path: Path) -> None:
    assert writable(None) is None
    new = tmp_path / "new" / "deep"
    assert writable(new) == new
    assert [*tmp_path.iterdir()] == [], "nothing is left of the trial"
    (tmp_path / "file").write_text("")
    with pytest.raises(typer.BadParameter, match=r"cannot write .*deep: Not a directory: .*file$"):
        writable(tmp_path / "file" / "deep")
    with pytest.raises(typer.BadParameter, match="cannot write /proc/none: No such file"):
        writable(Path("/proc/none"))


def test_a_file_is_no_folder_and_no_pipe(tmp_path: Path) -> None:
    import os

    assert writable_file(None) is None
    assert writable_file(tmp_path / "new" / "out.json") == tmp_path / "new" / "out.json"
    with pytest.raises(typer.BadParameter, match="is a folder: name a file"):
        writable_file(tmp_path)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(FileRefused):
        writable_file(tmp_path / "pipe")
    (tmp_path / "file").write_text("")
    with pytest.raises(typer.BadParameter, match="Not a directory"):
        writable_file(tmp_path / "file" / "out.json")


def test_a_size_is_a_size() -> None:
    assert size_given(None) is None
    assert size_given("320x240") == "320x240"
    with pytest.raises(typer.BadParameter, match="wide"):
        size_given("wide")


@pytest.mark.parametrize(
    ("check", "inside", "outside", "said"),
    [
        (stature_given, (0.5, 1.75, 2.6), 175.0, r"from 0.5 to 2.6 metres, got 175: 1.75\?"),
        (stature_given, (), 0.49, r"from 0.5 to 2.6 metres, got 0.49$"),
        (stature_given, (), 261.0, r"got 261$"),
        (fov_given, (10.0, 150.0), 151.0, r"from 10 to 150 degrees, got 151$"),
        (fov_given, (), 9.9, r"degrees, got 9.9$"),
        (square_given, (1.0, 1000.0), 1001.0, r"from 1 to 1000 mm, got 1001$"),
    ],
)
def test_a_number_out_of_bounds_is_told_with_its_unit_and_a_hundredth_is_asked_for(
    check: object, inside: tuple[float, ...], outside: float, said: str
) -> None:
    assert callable(check)
    assert check(None) is None
    assert [check(value) for value in inside] == [*inside]
    with pytest.raises(typer.BadParameter, match=said):
        check(outside)


@pytest.mark.parametrize(
    ("text", "numbers"),
    [("1", (1,)), ("12", (1, 2)), ("1,3", (1, 3)), ("8, 2", (2, 8)), ("321", (1, 2, 3))],
)
def test_cameras_are_named_by_numbers_with_commas_or_without(
    text: str, numbers: tuple[int, ...]
) -> None:
    assert numbers_given(text) == numbers
    assert views_given(text) == text
    assert views_given(None) is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "numbers with commas between: 2 or 1,3; got "),
        ("left", "numbers with commas between: 2 or 1,3; got left"),
        ("1,", "numbers with commas between"),
        ("0", "cameras have the numbers 1 to 8, got 0"),
        ("1,9", "cameras have the numbers 1 to 8, got 1,9"),
        ("1,12", "cameras have the numbers 1 to 8, got 1,12"),
        ("11", "each camera is named once, got 11"),
    ],
)
def test_what_names_no_cameras_is_refused(text: str, said: str) -> None:
    with pytest.raises(typer.BadParameter, match=said):
        views_given(text)
