"""A pool of workers that works in the test's own process, and draws that a test gives."""

import multiprocessing
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest


def pool_here(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Work that a pool would do is done here; what it is asked for is written down."""
    asked: list[Any] = []

    def imap(work: Callable[[Any], Any], given: Iterable[Any], chunksize: int = 1) -> Iterator[Any]:
        for one in given:
            asked.append(one)
            yield work(one)

    def apply_async(work: Callable[..., Any], given: tuple[Any, ...]) -> Any:
        asked.append(given[0])
        return SimpleNamespace(get=lambda: work(*given))

    @contextmanager
    def pool(_: int | None = None) -> Iterator[Any]:
        yield SimpleNamespace(imap=imap, apply_async=apply_async)

    def context(way: str) -> Any:
        assert way == "spawn"
        return SimpleNamespace(Pool=pool)

    monkeypatch.setattr(multiprocessing, "get_context", context)
    return asked


class Draws:
    """A generator whose draws are given: each list is used up in its order, its last one stays."""

    def __init__(self, **draws: list[Any]) -> None:
        self._draws = draws
        self.asked: list[tuple[Any, ...]] = []

    def _next(self, kind: str, *given: Any) -> Any:
        self.asked.append((kind, *given))
        left = self._draws[kind]
        return left.pop(0) if len(left) > 1 else left[0]

    def random(self) -> Any:
        return self._next("random")

    def normal(self, *given: Any) -> Any:
        return self._next("normal", *given)

    def uniform(self, *given: Any) -> Any:
        return self._next("uniform", *given)

    def integers(self, *given: Any) -> Any:
        return self._next("integers", *given)

    def permutation(self, count: int) -> Any:
        """The last first."""
        return np.arange(count)[::-1]
