"""Learning step by step: batches in their order, and work that is kept and taken up."""

from pathlib import Path
from typing import Any, NamedTuple

import pytest

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")


class Later(NamedTuple):
    """What a pool promises."""

    asked: int

    def get(self) -> list[int]:
        return [self.asked]


class Pool:
    """Notes what it is asked for."""

    def __init__(self) -> None:
        self.asked: list[int] = []

    def apply_async(self, _: Any, given: tuple[int]) -> Later:
        self.asked.append(given[0])
        return Later(given[0])


def test_batches_come_in_their_order_and_a_few_are_asked_for_ahead() -> None:
    from tritrack.landmark_lessons.landmark_learning import AHEAD, ahead

    pool: Any = Pool()
    coming: Any = ahead(pool, list, iter(range(10)))
    assert next(coming) == [0]
    assert pool.asked == list(range(AHEAD + 1))
    assert [batch for (batch,) in coming] == list(range(1, 10))


def _begun() -> Any:
    from tritrack.landmark_lessons.landmark_layers import Paced
    from tritrack.landmark_lessons.landmark_learning import begun

    network = torch.nn.Linear(2, 1)
    return begun(network, [Paced([network.weight], 0.5)])


def test_what_was_never_kept_begins_and_what_was_kept_goes_on(tmp_path: Path) -> None:
    from tritrack.landmark_lessons.landmark_learning import keep, resumed

    work = _begun()
    assert resumed(work, tmp_path / "kept.pt").batch == 0
    keep(work._replace(batch=7), tmp_path / "kept.pt")
    again = resumed(_begun(), tmp_path / "kept.pt")
    assert again.batch == 7
    assert torch.equal(again.network.weight, work.network.weight)
