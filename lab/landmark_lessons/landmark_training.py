"""The network of landmarks, trained on pictures of synthetic people: resumable."""

import multiprocessing
from functools import lru_cache
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
import torch
from rich.console import Console
from torch import nn

from common.npz_file import Facts
from lab.landmark_lessons import landmark_loss, work_of
from lab.landmark_lessons.landmark_file import write_network
from lab.landmark_lessons.landmark_learning import (
    Work,
    ahead,
    begun,
    keep,
    learnt_from,
    resumed,
)
from lab.landmark_lessons.photographed_start import photographed_start
from lab.landmark_lessons.picture_store import Backdrops, Part, PictureStore, draw
from lab.training.training import TrainingError
from runtime.terminal import bar
from synth.picture.composites import Composite, composite

PEOPLE, ANNY_PEOPLE, PART = 7_200, 5_100, 300
"""Who is learnt from, sixteen pictures each: our own people, and bodies of the Anny model; how many
of them a file holds: 300 MB."""
ANNY_TIMES: Final = 2
"""How much more often than one of our own a person of that model is shown."""
BACKDROPS: Final = 2_400
HELD_BACK: Final = 100
"""People who are drawn to tell how good the network is, and not learnt from."""
BATCHES, BATCH = 4_000, 64
RATE, WARM, STEADY_SHARE = 2e-3, 100, 0.4
"""Highest rate, of what is new; batches until it is reached; share of them until it falls to
nothing."""
MEAN_OVER: Final = 200
"""Batches over which the weights' running mean goes: that mean is what is written."""
KEEP_EVERY: Final = 100
"""Batches after which the work so far is kept."""
NEAR: Final = 0.1
"""What is told of how good it is: how many joints are within this share of the stature."""


def train_landmarks(out: Path, seed: int, console: Console) -> Facts:
    """Learn the network and write it, two hours on two cores.

    What is drawn and learnt is kept beside it in a folder, `<out>.work`, and the next call with the
    same file goes on from there.

    Args:
        out: The file to write, ONNX.
        seed: The first person's, and of all choices.
        console: For progress.

    Raises:
        TrainingError: When the file cannot be written.
    """
    if not out.parent.is_dir():
        raise TrainingError(f"cannot write {out}: there is no folder {out.parent}")
    folder = work_of(out)
    try:
        folders = _drawn(folder, seed, console)
        work = _learnt(folders[:-1], folder / "learnt.pt", seed, console)
        write_network(work.mean, out)
    except OSError as error:
        raise TrainingError(f"cannot write {folder}: {error.strerror}") from error
    right = _right(work.mean, folders[-1:], seed)
    return {"model": str(out), "pictures": work.batch * BATCH, "within_a_tenth": right}


def _drawn(folder: Path, seed: int, console: Console) -> list[Path]:
    """The folders of all people, those who are held back last."""
    first = seed * 2 * PEOPLE
    kinds = (("own", PEOPLE, False), ("anny", ANNY_PEOPLE, True))
    parts = [
        Part(folder / f"{name}{at}", first + at, min(PART, people - at), anny)
        for name, people, anny in kinds
        for at in range(0, people, PART)
    ]
    parts.append(Part(folder / "held_back", first + PEOPLE, HELD_BACK))
    with multiprocessing.get_context("spawn").Pool() as pool, bar(console) as progress:
        drawn = pool.imap(draw, parts)
        folders = list(progress.track(drawn, total=len(parts), description="drawing"))
    own = -(-PEOPLE // PART)
    return [*folders[:own], *folders[own:-1] * ANNY_TIMES, folders[-1]]


class Wanted(NamedTuple):
    """A batch that is to be made up; the same wish gives the same batch."""

    folders: tuple[Path, ...]
    seed: int
    batch: int


def composed(wanted: Wanted) -> list[Composite]:
    """One batch of pictures."""
    cv2.setNumThreads(1)
    store, backdrops = _opened(wanted.folders), _backdrops(wanted.seed)
    rng = np.random.default_rng([wanted.seed, wanted.batch, 81])
    return [
        composite(store.any(rng), lambda: store.any(rng), lambda: backdrops.any(rng), rng)
        for _ in range(BATCH)
    ]


@lru_cache(maxsize=1)
def _opened(folders: tuple[Path, ...]) -> PictureStore:
    return PictureStore(list(folders))


@lru_cache(maxsize=1)
def _backdrops(seed: int) -> Backdrops:
    return Backdrops.drawn(range(seed * BACKDROPS, (seed + 1) * BACKDROPS))


def _learnt(folders: list[Path], kept: Path, seed: int, console: Console) -> Work:
    """The network after all batches; what was kept before is not done again."""
    work = _begun(kept, folders, seed)
    wishes = (Wanted(tuple(folders), seed, at) for at in range(work.batch, BATCHES))
    with multiprocessing.get_context("spawn").Pool(1) as pool, bar(console) as progress:
        task = progress.add_task("learning", total=BATCHES, completed=work.batch)
        for shown in ahead(pool, composed, wishes):
            work = _step(work, shown)
            progress.advance(task)
            if work.batch % KEEP_EVERY == 0 or work.batch == BATCHES:
                keep(work, kept)
    return work


def _begun(kept: Path, folders: list[Path], seed: int) -> Work:
    """What was kept, or a fresh start."""
    torch.manual_seed(seed)
    first = composed(Wanted(tuple(folders), seed, BATCHES))
    network = photographed_start(first).to(memory_format=torch.channels_last)
    return resumed(begun(network, network.paces()), kept)


def _step(work: Work, shown: list[Composite]) -> Work:
    """One batch more."""
    work.network.train()
    share = max(1.0 / MEAN_OVER, 1.0 / (1.0 + 0.1 * work.batch))
    return learnt_from(work, shown, _rate(work.batch), share)


def _rate(at: int) -> float:
    """Rises, stays, and falls to nothing."""
    left = (1.0 - at / BATCHES) / (1.0 - STEADY_SHARE)
    return RATE * min(1.0, (at + 1) / WARM, max(left, 0.01))


def _right(network: nn.Module, folders: list[Path], seed: int) -> float:
    """Share of the joints of people who were held back that are nearly right."""
    shown = composed(Wanted(tuple(folders), seed, BATCHES))
    off = landmark_loss.joints_off(network, shown)
    return float((off[np.isfinite(off)] < NEAR).mean())
