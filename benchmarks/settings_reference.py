"""Write docs/settings.md, every setting with its default and meaning, from the types.

Run from the checkout: .venv/bin/python benchmarks/settings_reference.py
"""

import argparse
import ast
import inspect
import typing
from pathlib import Path
from typing import Any, Final

import msgspec

from common.config.part_settings import CameraSettings
from common.config.settings import Settings

FILE: Final = Path(__file__).parents[1] / "docs" / "settings.md"
WORDS: Final = {str: "text", int: "whole number", float: "number", bool: "true or false"}
INTRODUCTION: Final = """# Settings

Every setting of a settings file (TOML), written from the types by
`benchmarks/settings_reference.py`. All have defaults: a file names only what differs.
`tritrack track FILE`, `tritrack live FILE` and the processes of a run read them; an unknown name, a
wrong kind or a value out of bounds is refused with its place in the file. `configs/` holds whole
files.
"""


def text() -> str:
    """As the file has it."""
    tables: dict[str, type[msgspec.Struct]] = {"": Settings, "[cameras.NAME]": CameraSettings}
    for field in msgspec.structs.fields(Settings):
        if inspect.isclass(field.type) and issubclass(field.type, msgspec.Struct):
            tables[f"[{field.name}]"] = field.type
    return INTRODUCTION + "".join(section(name, kind) for name, kind in tables.items())


def section(name: str, kind: type[msgspec.Struct]) -> str:
    """A table of the settings of one type, with the line that says what they are."""
    said = meanings(kind)
    rows = [
        f"| `{field.name}` | {words} | {default_of(field)} | {said[field.name]} |\n"
        for field in msgspec.structs.fields(kind)
        if (words := kind_words(field.type))
    ]
    title = f"`{name}`" if name else "At the top of the file"
    about = one_line(inspect.getdoc(kind) or "")
    head = "| setting | kind | default | meaning |\n|---|---|---|---|\n"
    return f"\n## {title}\n\n{about}\n\n{head}{''.join(rows)}"


def meanings(kind: type[msgspec.Struct]) -> dict[str, str]:
    """The docstring below each field; "" for one without."""
    module = inspect.getmodule(kind)
    tree = ast.parse(inspect.getsource(module)) if module else ast.Module([], [])
    body = next(
        node.body
        for node in tree.body
        if isinstance(node, ast.ClassDef) and node.name == kind.__name__
    )
    found = {}
    for node, after in zip(body, [*body[1:], None], strict=True):
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found[node.target.id] = constant_of(after)
    return found


def constant_of(node: ast.stmt | None) -> str:
    """The text that a statement consists of; "" for another."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return one_line(str(node.value.value))
    return ""


def kind_words(kind: Any) -> str:
    """A type in plain words; "" for a table, which has a section of its own."""
    if kind in WORDS:
        return WORDS[kind]
    if typing.get_origin(kind) is typing.Literal:
        return " or ".join(toml_of(value) for value in typing.get_args(kind))
    parts = [each for each in typing.get_args(kind) if each is not type(None)]
    is_optional = len(parts) < len(typing.get_args(kind))
    return WORDS.get(parts[0], "") if is_optional else ""


def default_of(field: msgspec.structs.FieldInfo) -> str:
    """The default as it stands in a file."""
    return "none" if field.default is None else toml_of(field.default)


def toml_of(value: Any) -> str:
    """A value as TOML, in a span of code."""
    return f"`{msgspec.json.encode(value).decode()}`"


def one_line(said: str) -> str:
    """A docstring on one line of a table."""
    return " ".join(said.split()).replace("|", "\\|")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__).parse_args()
    FILE.write_text(text())
