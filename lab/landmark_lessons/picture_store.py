"""Drawn examples on disk: what the network of landmarks is trained on, many times over."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.lib.format import open_memmap
from numpy.typing import NDArray

from synth.anny_people.anny_examples import anny_examples
from synth.picture.backdrops import Backdrop, backdrop
from synth.picture.picture_examples import PICTURES, SIDE_PX, PictureExample, picture_examples

DRAWN: Final = "drawn.json"


class Part(NamedTuple):
    """People with consecutive seeds, in a file of their own."""

    folder: Path
    first: int
    people: int
    anny: bool = False
    """Of the Anny body model instead of our own."""


class PictureStore:
    """Examples of many people, read where they lie."""

    def __init__(self, folders: list[Path]) -> None:
        """Open what `draw` wrote."""
        self._bodies = [np.load(folder / "bodies.npy", mmap_mode="r") for folder in folders]
        self._outlines = [np.load(folder / "outlines.npy", mmap_mode="r") for folder in folders]
        self._labels = [np.load(folder / "labels.npy", mmap_mode="r") for folder in folders]
        self._ends = np.cumsum([len(labels) for labels in self._labels])

    def __len__(self) -> int:
        """How many examples there are."""
        return int(self._ends[-1])

    def __getitem__(self, at: int) -> PictureExample:
        """One of them."""
        part = int(np.searchsorted(self._ends, at, side="right"))
        row = at - (int(self._ends[part - 1]) if part else 0)
        labels = np.array(self._labels[part][row])
        return PictureExample(
            np.array(self._bodies[part][row]),
            np.unpackbits(self._outlines[part][row], axis=1),
            labels[:30].reshape(15, 2),
            labels[30:32],
            float(labels[32]),
        )

    def any(self, rng: np.random.Generator) -> PictureExample:
        """Any of them."""
        return self[int(rng.integers(len(self)))]


class Backdrops(NamedTuple):
    """What people are put before."""

    pictures: NDArray[np.uint8]

    @classmethod
    def drawn(cls, seeds: range) -> Self:
        """Those of some seeds."""
        return cls(np.stack([backdrop(seed) for seed in seeds]))

    def any(self, rng: np.random.Generator) -> Backdrop:
        """Any of them."""
        return np.asarray(self.pictures[int(rng.integers(len(self.pictures)))])


def is_drawn(folder: Path) -> bool:
    """Whether all examples of a folder are there."""
    return (folder / DRAWN).exists()


def store(folder: Path, examples: Sequence[PictureExample]) -> None:
    """Write examples of any source, one at least, in the place of what was begun there."""
    folder.mkdir(parents=True, exist_ok=True)
    np.save(folder / "bodies.npy", np.array([one.body for one in examples]))
    outlines = [np.packbits(one.outline, axis=1) for one in examples]
    np.save(folder / "outlines.npy", np.array(outlines))
    np.save(folder / "labels.npy", np.array([_label(one) for one in examples], np.float32))
    (folder / DRAWN).write_text(json.dumps({"examples": len(examples)}))


def _label(shown: PictureExample) -> list[float]:
    return [*shown.joints_px.ravel(), *shown.facing, shown.stature_px]


def draw(part: Part) -> Path:
    """Draw a part where it is not drawn yet; its folder.

    Raises:
        NoAnny: When people of that model are wanted, and it is not installed.
    """
    folder, first, people, anny = part
    if is_drawn(folder):
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    most = people * PICTURES
    bodies = open_memmap(folder / "new.npy", "w+", np.uint8, (most, SIDE_PX, SIDE_PX, 4))
    outlines: list[NDArray[np.uint8]] = []
    labels: list[list[float]] = []
    for seed in range(first, first + people):
        for shown in (anny_examples if anny else picture_examples)(seed):
            bodies[len(labels)] = shown.body
            outlines.append(np.packbits(shown.outline, axis=1))
            labels.append(_label(shown))
    bodies.flush()
    np.save(folder / "outlines.npy", np.stack(outlines))
    np.save(folder / "labels.npy", np.array(labels, np.float32))
    (folder / "new.npy").rename(folder / "bodies.npy")
    (folder / DRAWN).write_text(json.dumps({"first": first, "people": people}))
    return folder
