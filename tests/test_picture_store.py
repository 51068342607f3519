"""Drawn examples on disk: what is written is read, part by part."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lab.landmark_lessons import picture_store
from lab.landmark_lessons.picture_store import (
    Backdrops,
    Part,
    PictureStore,
    draw,
    is_drawn,
    store,
)
from synth.picture.picture_examples import SIDE_PX, PictureExample


def example(seed: int) -> PictureExample:
    rng = np.random.default_rng(seed)
    return PictureExample(
        rng.integers(0, 256, (SIDE_PX, SIDE_PX, 4)).astype(np.uint8),
        rng.integers(0, 2, (SIDE_PX, SIDE_PX)).astype(np.uint8),
        rng.normal(60, 20, (15, 2)).astype(np.float32),
        rng.normal(0, 1, 2).astype(np.float32),
        100.0 + seed,
    )


def same(one: PictureExample, other: PictureExample) -> bool:
    names = PictureExample._fields
    return all(np.allclose(getattr(one, name), getattr(other, name)) for name in names)


class Last:
    """Of so many the last."""

    def integers(self, count: int) -> int:
        return count - 1


LAST: Any = Last()


def test_examples_of_several_folders_are_numbered_through(tmp_path: Path) -> None:
    for name, seeds in (("a", (1, 2)), ("b", (3,)), ("c", (4, 5, 6))):
        store(tmp_path / name, [example(seed) for seed in seeds])
        assert is_drawn(tmp_path / name)
        told = json.loads((tmp_path / name / "drawn.json").read_text())
        assert told == {"examples": len(seeds)}
    held = PictureStore([tmp_path / name for name in "abc"])
    assert len(held) == 6
    for at in range(6):
        assert same(held[at], example(1 + at))
    assert same(held.any(LAST), example(6))


def drawing(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int]]:
    """A person is two examples, of whichever kind."""
    noted: list[tuple[str, int]] = []

    def people(kind: str, first: int) -> Any:
        def drawn(seed: int) -> Any:
            noted.append((kind, seed))
            return iter([example(first + 2 * seed), example(first + 2 * seed + 1)])

        return drawn

    monkeypatch.setattr(picture_store, "picture_examples", people("own", 0))
    monkeypatch.setattr(picture_store, "anny_examples", people("anny", 500))
    monkeypatch.setattr(picture_store, "PICTURES", 2)
    return noted


def test_people_are_drawn_once_seed_by_seed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    noted, part = drawing(monkeypatch), Part(tmp_path / "own", 7, 3)
    assert draw(part) == draw(part) == tmp_path / "own"
    assert noted == [("own", 7), ("own", 8), ("own", 9)]
    held = PictureStore([part.folder])
    assert len(held) == 6
    assert all(same(held[at], example(14 + at)) for at in range(6))
    told = json.loads((part.folder / "drawn.json").read_text())
    assert told == {"first": 7, "people": 3}
    assert sorted(path.name for path in part.folder.iterdir()) == [
        "bodies.npy",
        "drawn.json",
        "labels.npy",
        "outlines.npy",
    ]
    assert np.load(part.folder / "bodies.npy").shape == (6, SIDE_PX, SIDE_PX, 4)


def test_people_of_the_anny_model_are_drawn_where_they_are_asked_for(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    noted = drawing(monkeypatch)
    held = PictureStore([draw(Part(tmp_path / "anny", 3, 1, anny=True))])
    assert noted == [("anny", 3)]
    assert same(held[0], example(506))


def test_a_backdrop_of_each_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_store, "backdrop", lambda seed: np.full((2, 3, 3), seed, np.uint8))
    held = Backdrops.drawn(range(20, 25))
    assert held.pictures[:, 0, 0, 0].tolist() == [20, 21, 22, 23, 24]
    assert (held.any(LAST) == 24).all()
