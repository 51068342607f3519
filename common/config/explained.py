"""Faults in settings and measurement files, worded for the person who wrote the file."""

import re
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from typing import Final

import msgspec
from msgspec import inspect

from common.config.json_fault import json_fault
from common.config.toml_fault import toml_fault

SAID: Final = re.compile(r"(?P<reason>.*?)(?: - at `\$(?P<place>.*)`)?", re.DOTALL)
STEP: Final = re.compile(r"\.([^.\[\]]+)|\[(\d+|\.\.\.)\]")
FIELD: Final = re.compile(
    r"Object (?P<what>contains unknown|missing required) field `(?P<name>.*)`"
)
VALUE: Final = re.compile(r"Invalid enum value (?P<got>.*)", re.DOTALL)
KIND: Final = re.compile(
    r"Expected `(?P<kinds>[^`]+)`(?: of length (?P<length>\d+))?(?P<bound> [<>]=? \S+)?"
    r"(?:, got `?(?P<got>[^`]+)`?)?"
)
WORDS: Final = {
    "int": "a whole number",
    "float": "a number",
    "str": "text",
    "bool": "true or false",
    "array": "a list",
    "object": "a table",
}
"""Plain names for msgspec's types."""

Step = str | int
"""A key, or an index in a list, from 0; "..." for any key."""


def explained(error: Exception, kind: type, json: bytes | None = None) -> str:
    """msgspec's message in plain words: the setting, the value, and what is allowed.

    Args:
        error: The exception that decoding raised.
        kind: The type that the file was decoded as.
        json: The file's content, where it is JSON; None: it is TOML.
    """
    if not isinstance(error, msgspec.ValidationError):
        return toml_fault(str(error)) if json is None else json_fault(str(error), json)
    said = SAID.fullmatch(str(error))
    assert said is not None, "the expression takes any text"
    place = STEP.findall(said["place"] or "")
    steps: list[Step] = [key or (int(index) if index != "..." else index) for key, index in place]
    reason = said["reason"]
    if field := FIELD.fullmatch(reason):
        return _of_field(steps, field["name"], field["what"], kind)
    if value := VALUE.fullmatch(reason):
        known = [str(one) for info in _found(kind, steps) for one in _values(info)]
        return f"{_named(steps)} must be {_either(known) or 'another'}, got {value['got']}"
    if expected := KIND.fullmatch(reason):
        return f"{_named(steps)} must {_wanted(expected)}"
    return f"{_named(steps)}: {reason}" if steps else reason


def _of_field(steps: Sequence[Step], field: str, what: str, kind: type) -> str:
    named = _named([*steps, field])
    if what.startswith("missing"):
        return f"{named} is missing: add it"
    structs = [info for info in _found(kind, steps) if isinstance(info, inspect.StructType)]
    known = [each.encode_name for info in structs for each in info.fields]
    near = get_close_matches(field, known, 1)
    hint = f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}"
    return f"unknown setting {named} ({hint})"


def _wanted(expected: re.Match[str]) -> str:
    """The expected type of a value and its actual type."""
    kinds = [WORDS.get(kind, kind) for kind in expected["kinds"].split(" | ") if kind != "null"]
    got = expected["got"]
    was = f", got {'a fraction' if got == 'float' else WORDS.get(got, got)}" if got else ""
    if expected["length"]:
        return f"have {expected['length']} entries{was}"
    return f"be {_either(kinds)}{expected['bound'] or ''}{was}"


def _named(steps: Sequence[Step]) -> str:
    """A place counted from 1: `cameras 1, floor_px 2` for `$.cameras[0].floor_px[1]`."""
    text = ""
    for before, step in zip([None, *steps], steps, strict=False):
        if isinstance(step, int):
            text += f" {step + 1}"
        elif step != "...":
            text += ("" if not text else ", " if isinstance(before, int) else ".") + step
    return text.strip() or "it"


def _found(kind: type, steps: Sequence[Step]) -> list[inspect.Type]:
    """What is allowed at a place of a file."""
    infos = list(_parts(inspect.type_info(kind)))
    for step in steps:
        infos = [part for info in infos for below in _below(info, step) for part in _parts(below)]
    return infos


def _parts(info: inspect.Type) -> Iterator[inspect.Type]:
    """A type, or each member of a union."""
    if isinstance(info, inspect.UnionType):
        for each in info.types:
            yield from _parts(each)
    elif isinstance(info, inspect.Metadata):
        yield from _parts(info.type)
    else:
        yield info


def _below(info: inspect.Type, step: Step) -> Iterator[inspect.Type]:
    if isinstance(info, inspect.StructType):
        yield from (each.type for each in info.fields if each.encode_name == step)
    elif isinstance(info, inspect.DictType):
        yield info.value_type
    elif isinstance(info, inspect.ListType | inspect.VarTupleType):
        yield info.item_type
    elif isinstance(info, inspect.TupleType) and isinstance(step, int):
        yield from info.item_types[step : step + 1]


def _values(info: inspect.Type) -> Iterator[str | int | None]:
    if isinstance(info, inspect.LiteralType):
        yield from info.values


def _either(words: Sequence[str]) -> str:
    *first, last = words or [""]
    return f"{', '.join(first)} or {last}" if first else last
