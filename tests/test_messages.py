"""The words of messages, held against those of the contract."""

from typing import get_args

from common.bus.messages import Status, Views


def test_statuses_and_views_are_those_of_the_contract() -> None:
    """The words of poses.npz."""
    assert get_args(Status) == ("empty", "measuring", "tracking", "predicted", "lost")
    assert set(get_args(Views)) == {"both", "1", "2", "none"}
