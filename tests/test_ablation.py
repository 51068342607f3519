"""The table of departures: that it knows them all, and switches nothing else."""

import importlib.util
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from common.config import Mode, Settings
from tritrack.offline.lockstep import Decoders, track_clip
from tritrack.store.runs import poses


@pytest.fixture(scope="module")
def ablation() -> ModuleType:
    path = Path(__file__).parents[1] / "benchmarks" / "ablation.py"
    spec = importlib.util.spec_from_file_location("ablation", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def arrays(clip: Path, mode: Mode) -> dict[str, np.ndarray]:
    with Decoders() as decoders:
        return poses(track_clip(Settings(clip=str(clip), mode=mode), decoders).bodies)


def same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> bool:
    return all(value.tobytes() == other[name].tobytes() for name, value in one.items())


def test_default_mode_with_every_departure_off_is_paper_mode(
    ablation: ModuleType, clip: Path
) -> None:
    """To the byte: no departure is missing from the table, and none changes what is printed."""
    with ablation.without(ablation.POSES):
        off = arrays(clip, "default")
    assert same(off, arrays(clip, "paper"))
    assert not same(off, arrays(clip, "default"))


def test_what_was_off_is_on_again(ablation: ModuleType) -> None:
    before = [getattr(*each[:2]) for step in ablation.STEPS for each in step.instead]
    with ablation.without(ablation.STEPS):
        during = [getattr(*each[:2]) for step in ablation.STEPS for each in step.instead]
    after = [getattr(*each[:2]) for step in ablation.STEPS for each in step.instead]
    assert all(one is other for one, other in zip(before, after, strict=True))
    assert not any(one is other for one, other in zip(before, during, strict=True))


def test_a_row_adds_to_the_one_above_and_each_is_left_out_once(ablation: ModuleType) -> None:
    rows, n = ablation.rows(), len(ablation.STEPS)
    assert [len(row.off) for row in rows] == [*range(n, -1, -1), *[1] * n]
    for above, row in pairwise(rows[: n + 1]):
        assert above.off[1:] == row.off
    assert [row.off[0] for row in rows[n + 1 :]] == list(ablation.STEPS)
