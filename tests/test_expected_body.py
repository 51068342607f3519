"""What a viewer takes from the guide: its own half of it, and only while there is a body."""

from typing import Any

import msgspec
import pytest
from staging import PERSON

from common.bus.messages import Guide, ViewerNumber
from viewer.expected_body import ExpectedBody, expected_body

GUIDE = Guide(
    frame=1,
    captured_s=0.1,
    clock_s=0.1,
    frames=(1, 1),
    status="tracking",
    bdp=PERSON,
    measured=True,
    facing=("facade", "flank"),
    scale_px_per_m=(50.0, 40.0),
    root_px=((80.0, 60.0), (81.0, 61.0)),
    rest_row_px=(62.0, 63.0),
    pose=(1.0, 2.0),
)


def test_each_viewer_has_its_own_half() -> None:
    assert expected_body(GUIDE, 1) == ExpectedBody(
        PERSON, True, (1.0, 2.0), "facade", 50.0, (80.0, 60.0), 62.0
    )
    assert expected_body(GUIDE, 2) == ExpectedBody(
        PERSON, True, (1.0, 2.0), "flank", 40.0, (81.0, 61.0), 63.0
    )


@pytest.mark.parametrize("status", ["measuring", "tracking", "predicted"])
def test_a_body_is_expected_while_it_is_followed(status: str) -> None:
    assert expected_body(msgspec.structs.replace(GUIDE, status=status), 1) is not None


@pytest.mark.parametrize(
    ("changed", "viewer"),
    [
        ({"status": "empty"}, 1),
        ({"status": "lost"}, 2),
        ({"bdp": None}, 1),
        ({"scale_px_per_m": (50.0, 0.0)}, 2),
        ({"scale_px_per_m": (-1.0, 40.0)}, 1),
        ({"scale_px_per_m": (float("nan"), 40.0)}, 1),
    ],
)
def test_without_a_body_or_a_size_in_its_picture_it_is_looked_for_afresh(
    changed: dict[str, Any], viewer: ViewerNumber
) -> None:
    assert expected_body(msgspec.structs.replace(GUIDE, **changed), viewer) is None
    assert expected_body(None, viewer) is None
