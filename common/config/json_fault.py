"""Faults in JSON files, worded for the person who wrote the file."""

import re
from typing import Final

PLACED: Final = re.compile(r"JSON is malformed: (?P<fault>.*) \(byte (?P<byte>\d+)\)", re.DOTALL)
NOT_FINITE: Final = re.compile(rb"-?(NaN|Infinity|inf|nan)")
AT_END: Final = "Input data was truncated"


def json_fault(text: str, content: bytes) -> str:
    """msgspec's message with line and column, counted from 1; any other text as it is.

    Args:
        text: The message.
        content: What was decoded.
    """
    if text == AT_END:
        return "at the end of the file: a bracket or a quote is not closed"
    placed = PLACED.fullmatch(text)
    if placed is None:
        return text
    at = int(placed["byte"])
    before = content[:at]
    line, column = before.count(b"\n") + 1, at - (before.rfind(b"\n") + 1) + 1
    number = NOT_FINITE.match(content, at - before.endswith(b"-"))
    fault = placed["fault"]
    if number is not None:
        fault = f"{number[0].decode()} is no number in JSON: write a number, or leave it out"
    return f"line {line}, column {column}: {fault}"
