"""Work distributed over all cores of this machine, or over a Dask cluster."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Final, TypeVar

Given = TypeVar("Given")
Made = TypeVar("Made")

CONNECT_S: Final = 10
"""Seconds to wait for a cluster's answer."""


class ClusterError(RuntimeError):
    """A cluster that cannot be used; the text names it and the cure."""


@contextmanager
def spread(dask: str) -> Iterator[None]:
    """Inside, `made` uses all cores, or a Dask cluster.

    Args:
        dask: Address of the cluster's scheduler, tcp://host:8786; "" for this machine alone. Its
            workers need tritrack and the clips under the same paths.

    Raises:
        ClusterError: When it does not answer, or Dask is not installed.
    """
    from joblib import parallel_config
    from joblib.externals.loky import get_reusable_executor

    if not dask:
        try:
            with parallel_config(backend="loky", n_jobs=-1, inner_max_num_threads=1):
                yield
        finally:  # idle workers would keep their memory for minutes
            get_reusable_executor().shutdown(wait=True)
        return
    try:
        from distributed import Client
    except ImportError as error:
        raise ClusterError("--dask needs Dask: pip install 'tritrack[cluster]'") from error
    try:
        client = Client(dask, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at {dask!r} ({error}): start one with `dask scheduler`, "
            "and workers with `dask worker ADDRESS`"
        ) from error
    with client, parallel_config(backend="dask", wait_for_workers_timeout=CONNECT_S):
        yield


def made(work: Callable[[Given], Made], of: Iterable[Given]) -> Iterator[Made]:
    """Results of a module's function for each item, in the order of completion."""
    from joblib import Parallel, delayed

    parallel: Any = Parallel(return_as="generator_unordered", batch_size=1)
    yield from parallel(delayed(work)(each) for each in of)
