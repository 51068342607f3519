"""The text of a notes file, updated: comments and style stay."""

from typing import Any

import msgspec
import tomlkit
from tomlkit.items import AoT

from common.notes.notes import Note, Notes


def notes_text(notes: Notes, before: str) -> str:
    """The text of a notes file with these notes; new ones are inserted in order.

    Args:
        notes: All notes that the file shall hold.
        before: The text so far, whose comments, order and style are kept.

    Raises:
        tomlkit.exceptions.TOMLKitError: When the text so far is no TOML.
    """
    document: Any = tomlkit.parse(before)
    if notes.video != document.get("video", ""):
        document["video"] = tomlkit.value(_quoted(notes.video))
    if "note" not in document:
        document["note"] = tomlkit.aot()
    tables = document["note"]
    wanted = {note.frame: note for note in notes.note}
    for at in reversed(range(len(tables))):
        if tables[at]["frame"] not in wanted:
            del tables[at]
    for note in notes.note:
        at = sum(table["frame"] < note.frame for table in tables)
        if note.frame not in [table["frame"] for table in tables]:
            made: Any = tomlkit.table() if isinstance(tables, AoT) else tomlkit.inline_table()
            made["frame"] = note.frame
            tables.insert(at, made)
        _update(next(table for table in tables if table["frame"] == note.frame), note)
    return tomlkit.dumps(document)


def _update(table: Any, note: Note) -> None:
    """Make a table match a note; entries that match already are not touched."""
    if note.orientation is None:
        table.pop("orientation", None)
    elif table.get("orientation") != note.orientation:
        table["orientation"] = note.orientation
    for name, values in (("depth", note.depth), ("joints_px", note.joints_px)):
        said = {key: _plain(value) for key, value in values.items()}
        if not said:
            table.pop(name, None)
            continue
        if name not in table:
            table[name] = tomlkit.inline_table()
        for key in [key for key in table[name] if key not in said]:
            del table[name][key]
        for key, value in said.items():
            if table[name].get(key) != value:
                table[name][key] = value


def _plain(value: object) -> object:
    return list(value) if isinstance(value, tuple) else value


def _quoted(text: str) -> str:
    """A TOML string: JSON's escapes are valid TOML, which wants DEL escaped too."""
    return msgspec.json.encode(text).decode().replace("\x7f", "\\u007f")
