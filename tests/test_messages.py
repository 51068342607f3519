"""The words of messages, held against those of the contract."""

from typing import get_args

import msgspec
import pytest

from common.bus.messages import Status, Views


def test_statuses_and_views_are_those_of_the_contract() -> None:
    """The words of poses.npz."""
    assert get_args(Status) == ("empty", "measuring", "tracking", "predicted", "lost")
    for word in ("both", "1", "2", "none", "1+3"):
        assert msgspec.convert(word, Views) == word
    for word in ("", "9", "1+", "first"):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert(word, Views)
