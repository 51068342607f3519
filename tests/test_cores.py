"""Work is spread over this machine's cores or over a Dask cluster, with the same results."""

import os
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from lab.training.recordings import recordings
from runtime.offline.batch import Asked, track_all
from runtime.store.cores import ClusterError, made, spread

QUIET = Console(quiet=True)


def process_of(number: int) -> tuple[int, int]:
    return number, os.getpid()


def test_without_a_place_to_work_it_is_done_here_and_in_order() -> None:
    assert list(made(process_of, range(3))) == [(i, os.getpid()) for i in range(3)]


def test_a_failure_of_the_work_is_a_failure_of_the_whole() -> None:
    with pytest.raises(ZeroDivisionError):
        list(made((1).__truediv__, [0]))


@pytest.mark.slow
def test_all_cores_do_it_in_processes_of_their_own() -> None:
    with spread(""):
        done = dict(made(process_of, range(8)))
    assert sorted(done) == list(range(8))
    assert os.getpid() not in done.values()


@pytest.mark.slow
def test_a_dask_cluster_of_two_tracks_clips_to_the_same_bits(clip: Path, tmp_path: Path) -> None:
    """Its workers are other processes, which hand what they tracked back to be kept here."""
    from distributed import LocalCluster

    run = (
        tmp_path
        / "runs"
        / next(iter(track_all([clip], tmp_path / "runs", Asked(), QUIET)["clips"]))
    )
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        spread(cluster.scheduler_address),
    ):
        done = dict(made(process_of, range(8)))
        (tracked,) = recordings([clip], None, tmp_path / "kept", QUIET)
    assert os.getpid() not in done.values()
    (alone,) = recordings([run], None, tmp_path, QUIET)
    assert np.array_equal(tracked.rows, alone.rows)
    assert len(list((tmp_path / "kept").iterdir())) == 1


@pytest.mark.slow
def test_a_cluster_that_does_not_answer_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("runtime.store.cores.CONNECT_S", 1)
    with (
        pytest.raises(ClusterError, match=r"no Dask scheduler answers at 'tcp://127.0.0.1:9'"),
        spread("tcp://127.0.0.1:9"),
    ):
        pass


def test_an_address_that_is_none_is_named() -> None:
    with (
        pytest.raises(ClusterError, match="no Dask scheduler answers at 'nonsense"),
        spread("nonsense://nowhere"),
    ):
        pass
