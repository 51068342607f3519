"""Faults in JSON files, with the place at which an editor finds them."""

import msgspec
import pytest

from common.config.json_fault import json_fault


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (
            b'{\n "fps": NaN}',
            "line 2, column 9: NaN is no number in JSON: write a number, or leave it out",
        ),
        (
            b'{"fps": -Infinity}',
            "line 1, column 10: -Infinity is no number in JSON: write a number, or leave it out",
        ),
        (b'{\n\n "fps" 3}', "line 3, column 8: expected ':'"),
        (b'{"fps": 3', "at the end of the file: a bracket or a quote is not closed"),
    ],
)
def test_a_fault_is_named_with_line_and_column(content: bytes, said: str) -> None:
    with pytest.raises(msgspec.DecodeError) as refused:
        msgspec.json.decode(content)
    assert json_fault(str(refused.value), content) == said


def test_what_has_no_place_is_as_it_was() -> None:
    assert json_fault("Expected `int`", b"{}") == "Expected `int`"
