"""Faults in TOML files, worded for the person who wrote the file."""

import re
from typing import Final

PLACED: Final = re.compile(r"(?P<fault>.*) \(at (?P<place>line \d+, column \d+|end of document)\)")
OPEN_TEXT: Final = "a text is not closed: end it with the quote that it begins with"
TWICE: Final = "this name stands twice: keep one"
ELSEWHERE: Final = "this table was written before: put all its settings there"
ESCAPE: Final = r"after \u and \U stands the number of a character: mend it, or use single quotes"
FAULTS: Final = (
    (r"Unterminated string|Expected (\"'\"|\"'''\"|'\"\"\"'|'\"')", OPEN_TEXT),
    (r"(Illegal|Found invalid) character '(\\n|\\r)'", OPEN_TEXT),
    (r"(?:Illegal|Found invalid) character ('.*'|\".*\")", r"the character \1 may not stand here"),
    (r"Invalid statement", "here should stand a setting, name = value, or a table, [name]"),
    (r"Invalid initial character for a key part", "a name is missing: write name = value"),
    (r"Expected '=' after a key in a key/value pair", "= is missing after the name"),
    (
        r"Expected newline or end of document after a statement",
        "more follows the value: write each setting on a line of its own, texts in quotes",
    ),
    (r"Invalid value", "a value is missing: write a number, true, false, or a text in quotes"),
    (r"Invalid date or datetime", "there is no such date or time"),
    (r"Cannot overwrite a value", TWICE),
    (r"Duplicate inline table key '(.*)'", r"\1 stands twice: keep one"),
    (r"Cannot declare .* twice", ELSEWHERE),
    (r"Cannot (mutate immutable|redefine) namespace .*", ELSEWHERE),
    (r"Expected '(\]\]?)' at the end of .*", r"\1 is missing after the table's name"),
    (r"Unclosed array", "a list is not closed by ], or a comma is missing in it"),
    (r"Unclosed inline table", "{ is not closed by } on its line, or a comma is missing"),
    (r"Unescaped '\\' in a string", r"a text holds a single \: write \\, or use single quotes"),
    (r"Invalid hex value|Escaped character is not a Unicode scalar value", ESCAPE),
)
"""Patterns of tomllib's messages, and the wording that replaces each."""


def toml_fault(text: str) -> str:
    """tomllib's message in plain words, after the line and column; any other text as it is."""
    placed = PLACED.fullmatch(text)
    if placed is None:
        return text
    at_end = placed["place"] == "end of document"
    where = "at the end of the file" if at_end else placed["place"]
    return f"{where}: {_plain(placed['fault'])}"


def _plain(fault: str) -> str:
    for pattern, said in FAULTS:
        if found := re.fullmatch(pattern, fault):
            return found.expand(said) if r"\1" in said else said
    return fault
