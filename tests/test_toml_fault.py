"""Files that are no TOML: each mistake is said in plain words, with its place."""

import inspect
import re
import tomllib
from pathlib import Path

import pytest

from common.config.config_file import load
from common.config.part_settings import SettingsError
from common.config.toml_fault import FAULTS, toml_fault

MISTAKES = {
    'room = "a\n': "line 1, column 10: a text is not closed: end it with the quote",
    'every = 2\nroom = "a': "at the end of the file: a text is not closed",
    "room = 'a\nx = 'b'\n": "line 1, column 10: a text is not closed",
    "room = '''a\n": "at the end of the file: a text is not closed",
    'room = "C:\\clips"\n': r"line 1, column 13: a text holds a single \: write \\, or use single",
    'room = "\\u12"\n': r"line 1, column 11: after \u and \U stands the number of a character",
    'room = "\\ud800"\n': r"line 1, column 15: after \u and \U stands the number of a character",
    'room = "\x01"\n': r"line 1, column 9: the character '\x01' may not stand here",
    "# \x01\n": r"line 1, column 3: the character '\x01' may not stand here",
    "= 3\n": "line 1, column 1: here should stand a setting, name = value, or a table, [name]",
    "room: a\n": "line 1, column 5: = is missing after the name",
    "a = {b = 1,}\n": "line 1, column 12: a name is missing: write name = value",
    "every = 1 2\n": "line 1, column 11: more follows the value: write each setting on a line",
    "every = 01\n": "line 1, column 10: more follows the value",
    "every =\n": "line 1, column 8: a value is missing: write a number, true, false, or a text",
    "pictures = yes\n": "line 1, column 12: a value is missing",
    "day = 2026-02-30\n": "line 1, column 7: there is no such date or time",
    "every = 1\nevery = 2\n": "line 2, column 10: this name stands twice: keep one",
    "a = {b = 1, b = 2}\n": "line 1, column 18: b stands twice: keep one",
    "[bus]\n[bus]\n": "line 2, column 5: this table was written before: put all its settings",
    "a = {b = 1}\na.c = 2\n": "line 2, column 8: this table was written before",
    "[bus\n": "line 1, column 5: ] is missing after the table's name",
    "[[site]\n": "line 1, column 7: ]] is missing after the table's name",
    "a = [1, 2\n": "at the end of the file: a list is not closed by ], or a comma is missing",
    "a = [1 2]\n": "line 1, column 8: a list is not closed by ], or a comma is missing",
    "a = {b = 1\n": "line 1, column 11: { is not closed by } on its line, or a comma is missing",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_each_mistake_is_said_in_plain_words_with_its_place(text: str, tmp_path: Path) -> None:
    path = tmp_path / "live.toml"
    path.write_text(text, newline="")
    with pytest.raises(SettingsError) as refused:
        load(path)
    assert str(refused.value).startswith(f"{path}: {MISTAKES[text]}")
    assert "\n" not in str(refused.value)


def test_nothing_that_python_finds_wrong_is_left_in_its_words() -> None:
    """Each message that stands in the parser itself, as it is filled in."""
    source = inspect.getsource(tomllib._parser)  # type: ignore[attr-defined]
    found = re.findall(r'suffixed_err\(\s*src, (?:new_)?pos, f?("[^"\n]*")', source)
    quote = repr("'")
    filled = [eval(one).replace("{expect!r}", quote) for one in found]
    messages = {re.sub(r"\{[^}]*\}", "'x'", one) for one in filled}
    assert len(messages) > 15
    for message in messages:
        assert any(re.fullmatch(pattern, message) for pattern, _ in FAULTS), message


def test_what_is_said_of_anything_else_stays_as_it_is() -> None:
    assert toml_fault("JSON is malformed: expected digit (byte 3)") == (
        "JSON is malformed: expected digit (byte 3)"
    )
