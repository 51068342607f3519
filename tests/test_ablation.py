"""The table of departures: that it knows them all, and switches nothing else."""

import importlib.util
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from common.config.settings import Settings
from common.method import DEFAULT, PAPER, THESIS, Method, Mode
from runtime.offline.lockstep import Decoders, track_clip
from runtime.store.pose_arrays import poses


@pytest.fixture(scope="module")
def ablation() -> ModuleType:
    path = Path(__file__).parents[1] / "benchmarks" / "ablation.py"
    spec = importlib.util.spec_from_file_location("ablation", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def arrays(clip: Path, mode: Mode, method: Method | None = None) -> dict[str, np.ndarray]:
    with Decoders() as decoders:
        settings = Settings(clip=str(clip), mode=mode)
        return poses(track_clip(settings, decoders, method=method).bodies)


def same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> bool:
    return all(value.tobytes() == other[name].tobytes() for name, value in one.items())


@pytest.mark.slow
def test_default_mode_with_every_departure_off_is_paper_mode(
    ablation: ModuleType, clip: Path
) -> None:
    """To the byte: no departure is missing from the record, and none hides behind a mode's name."""
    printed = ablation.with_fields(DEFAULT, ablation.departures(DEFAULT), PAPER)
    off = arrays(clip, "default", printed)
    assert same(off, arrays(clip, "paper"))
    assert not same(off, arrays(clip, "default"))


def test_every_departure_is_a_row_added_and_a_row_left_out(ablation: ModuleType) -> None:
    names, rows = ablation.departures(DEFAULT), ablation.rows()
    added, left = rows[: len(names) + 1], rows[len(names) + 1 : -1]
    assert set(names) == set(Method.__struct_fields__) - {"stick_lifting"}
    assert (added[0].method, added[-1].method) == (PAPER, DEFAULT)
    for name, (above, row) in zip(names, pairwise(added), strict=True):
        assert ablation.departures(row.method, above.method) == (name,)
    assert [ablation.departures(row.method, DEFAULT) for row in left] == [(name,) for name in names]


def test_of_one_view_the_thesis_and_its_departure_are_rows(ablation: ModuleType) -> None:
    """No other row fits the thesis's body."""
    of_two, of_one = ablation.rows(), ablation.rows(True)
    assert of_one[:-2] == of_two
    assert of_one[-2].method == THESIS
    assert ablation.departures(of_one[-1].method, THESIS) == ("steady_elbows",)
