"""What a browser may say of points: taken, or refused with the place and the cure."""

from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from animator.marking.sheet import (
    MOST_MARKS,
    MOST_SAID_BYTES,
    Hello,
    Mark,
    Marked,
    Number,
    Save,
    Sheet,
    SheetError,
    heard,
    refuse_sheet,
)

POLES = Hello(
    title="room",
    run=1,
    method="poles",
    size=(640, 480),
    pictures=(),
    numbers=(Number("pole_height_m", "height of the poles", "m", True),),
    hints={"pole": ("the top", "the top")},
    writes="calibration.json",
)
POLE = Mark("pole", ((0.0, 480.0), None), (0.0, 1.0))


def test_what_the_page_says_is_heard() -> None:
    said = b"""{"type": "marked", "by": "me", "count": 3, "sheet": {
        "numbers": {"pole_height_m": 2.2},
        "marks": [{"kind": "pole", "px": [[12.25, 30], null], "at_m": [0, 1]}]}}"""
    sheet = Sheet((Mark("pole", ((12.25, 30.0), None), (0.0, 1.0)),), {"pole_height_m": 2.2})
    assert heard(said) == Marked(sheet, "me", 3)
    assert heard(b'{"type": "save"}') == Save()


@pytest.mark.parametrize(
    "said",
    [
        b"",
        b"[",
        b"\xff\xfe",
        b'{"type": "format the disk"}',
        b'{"type": "save", "path": "/etc/passwd"}',
        b'{"type": "marked", "by": "me", "count": 1}',
        b'{"type": "marked", "by": "me", "count": 1, "sheet": {"marks": [{"kind": "cow"}]}}',
        b'{"type": "marked", "by": "", "count": 1, "sheet": {"numbers": {"a": NaN}, "marks": []}}',
        b"[" * 20_000,
    ],
)
def test_what_no_page_says_is_refused(said: bytes) -> None:
    with pytest.raises(SheetError, match="load it anew"):
        heard(said)


@given(st.binary(max_size=200))
def test_no_bytes_do_more_than_to_be_refused(said: bytes) -> None:
    with pytest.raises(SheetError):
        heard(said)


def test_points_to_the_very_border_are_taken() -> None:
    """And not a hair farther."""
    refuse_sheet(Sheet((POLE,), {"pole_height_m": None}), POLES)
    for place in ((-0.01, 480.0), (0.0, 480.01)):
        beyond = msgspec.structs.replace(POLE, px=(place, None))
        with pytest.raises(SheetError, match="point 1 is outside"):
            refuse_sheet(Sheet((beyond,), {"pole_height_m": None}), POLES)


@pytest.mark.parametrize(
    ("marks", "numbers", "says"),
    [
        ((POLE,) * (MOST_MARKS + 1), {}, f"more than {MOST_MARKS} points"),
        ((POLE, Mark("pole", ((641.0, 3.0), None), (0.0, 0.0))), {}, "point 2 is outside"),
        ((Mark("pole", (None, (3.0, -0.01)), (0.0, 0.0)),), {}, "point 1 is outside"),
        ((Mark("pole", (None, (float("nan"), 3.0)), (0.0, 0.0)),), {}, "point 1 is outside"),
        ((Mark("pole", at_m=(0.0, 1001.0)),), {}, "say metres"),
        ((Mark("pole", at_m=(0.0, float("inf"))),), {}, "say metres"),
        ((POLE, Mark("pole", at_m=(-1001.0, 0.0))), {}, "pole 2 is farther than 1000 m off"),
        ((Mark("pole"),), {}, "point 1 is none of this page's"),
        ((Mark("wall"),), {}, "point 1 is none of this page's"),
        ((POLE,), {"pole_height_m": 0.0}, "height of the poles: must be a positive number, got 0"),
        ((POLE,), {"pole_height_m": float("inf")}, "must be a positive number"),
        ((POLE,), {"weight_kg": 3.0}, "weight_kg is not asked for"),
    ],
)
def test_what_no_click_gives_is_refused(
    marks: tuple[Mark, ...], numbers: dict[str, Any], says: str
) -> None:
    with pytest.raises(SheetError, match=says):
        refuse_sheet(Sheet(marks, numbers), POLES)


def test_the_longest_sheet_fits_into_what_a_browser_may_say() -> None:
    far = -999.123456789
    mark = Mark("pole", ((1919.12, 1079.12),) * 2, (far, far))
    numbers = dict.fromkeys(("pole_height_m", "distance_1_m", "distance_2_m"), 123.456789012)
    said = msgspec.json.encode(Marked(Sheet((mark,) * MOST_MARKS, {**numbers}), "x" * 12, 10**6))
    assert len(said) < MOST_SAID_BYTES
