"""The words of messages, held against those of the contract."""

from typing import get_args

import msgspec
import pytest

from common.bus.messages import (
    MOST_VIEWS,
    Status,
    Views,
    place_in_rig,
)


def test_statuses_and_views_are_those_of_the_contract() -> None:
    """The words of poses.npz."""
    assert get_args(Status) == ("empty", "measuring", "tracking", "predicted", "lost")
    for word in ("both", "1", "2", "none", "1+3"):
        assert msgspec.convert(word, Views) == word
    for word in ("", "9", "1+", "first"):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert(word, Views)


def test_viewers_are_numbered_from_1_and_a_rigs_cameras_have_places_from_0() -> None:
    assert [place_in_rig(number) for number in (1, 2, MOST_VIEWS)] == [0, 1, MOST_VIEWS - 1]
