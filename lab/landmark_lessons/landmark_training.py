"""The network of landmarks, trained on pictures of synthetic people in three stages: resumable."""

import multiprocessing
from collections.abc import Iterator
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
from lab.landmark_lessons.landmark_bytes import write_both
from lab.landmark_lessons.landmark_confidence import set_confidence
from lab.landmark_lessons.landmark_learning import (
    Work,
    ahead,
    begun,
    keep,
    learnt_from,
    resumed,
)
from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks, between
from lab.landmark_lessons.movenet_start import movenet
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
BATCH: Final = 32
OBSTRUCTED: Final = 0.35
"""Share of the pictures in which something stands before the person, or long cloth hides legs."""
BATCHES, HEAD_BATCHES = 2_400, 450
"""By which heads and trunk learn, and after that the heads anew on the trunk that then stays."""
KEPT: Final = 0.5
"""Share of what the trunk learnt that is kept: weights between the published and the learnt ones
see drawn people and, unlike the learnt ones, photographs still."""
WARM, STEADY_SHARE = 50, 0.4
"""Batches until the highest rate is reached, and share of them until it falls to nothing."""
MEAN_OVER: Final = 100
"""Batches over which the weights' running mean goes: that mean is what is written."""
KEEP_EVERY: Final = 100
"""Batches after which the work so far is kept."""
HELD_BATCHES, RANGED = 20, 64
"""Batches of people who were held back; how many of their pictures give activations' ranges."""
NEAR: Final = 0.1
"""What is told of how good it is: how many joints are within this share of the stature."""


def train_landmarks(out: Path, seed: int, console: Console) -> Facts:
    """Learn the network and write it in bytes, two hours on two cores.

    What is drawn and learnt is kept beside it in a folder, `<out>.work`, with the network before
    it was rounded (`whole.onnx`), and the next call with the same file goes on from there.

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
        *folders, held_back = _drawn(folder, seed, console)
        network = _trained(folders, folder, seed, console)
        held = [*_held(held_back, seed)]
        set_confidence(network, held)
        write_both(network, held[:RANGED], folder, out)
    except OSError as error:
        raise TrainingError(f"cannot write {folder}: {error.strerror}") from error
    pictures = (BATCHES + HEAD_BATCHES) * BATCH
    return {"model": str(out), "pictures": pictures, "within_a_tenth": _right(network, held)}


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


class Stage(NamedTuple):
    """Batches over which the rate rises and falls once."""

    kept: Path
    """The file of what is learnt."""
    first: int
    """Number of its first batch, of all that are made up."""
    batches: int


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
        composite(
            store.any(rng), lambda: store.any(rng), lambda: backdrops.any(rng), rng, OBSTRUCTED
        )
        for _ in range(BATCH)
    ]


@lru_cache(maxsize=1)
def _opened(folders: tuple[Path, ...]) -> PictureStore:
    return PictureStore(list(folders))


@lru_cache(maxsize=1)
def _backdrops(seed: int) -> Backdrops:
    return Backdrops.drawn(range(seed * BACKDROPS, (seed + 1) * BACKDROPS))


def _trained(folders: list[Path], work: Path, seed: int, console: Console) -> MovenetLandmarks:
    """The network after all stages: heads and trunk learn, the trunk goes part of the way back to
    what was published, and the heads learn anew on it.

    Args:
        folders: Of people.
        work: The folder of what is kept of each stage.
        seed: Of all choices.
        console: For progress.
    """
    torch.manual_seed(seed)
    wanted = Wanted(tuple(folders), seed, 0)
    network = MovenetLandmarks(movenet()).to(memory_format=torch.channels_last)
    both, first = [network.heads(), network.trunk()], Stage(work / "learnt.pt", 0, BATCHES)
    learnt = _learnt(resumed(begun(network, both), first.kept), first, wanted, console)
    network = between(learnt.mean, movenet(), KEPT)
    second = Stage(work / "heads.pt", BATCHES, HEAD_BATCHES)
    heads = resumed(begun(network, [network.heads()]), second.kept)
    return _learnt(heads, second, wanted, console).mean


def _learnt(work: Work, stage: Stage, wanted: Wanted, console: Console) -> Work:
    """A work after all batches of a stage.

    Args:
        work: How far it is.
        stage: Whose batches it is of.
        wanted: Any batch.
        console: For progress.
    """
    _, first, batches = stage
    wishes = (wanted._replace(batch=first + at) for at in range(work.batch, batches))
    with multiprocessing.get_context("spawn").Pool(1) as pool, bar(console) as progress:
        task = progress.add_task("learning", total=batches, completed=work.batch)
        for shown in ahead(pool, composed, wishes):
            work = _step(work, shown, batches)
            progress.advance(task)
            if work.batch % KEEP_EVERY == 0 or work.batch == batches:
                keep(work, stage.kept)
    return work


def _step(work: Work, shown: list[Composite], batches: int) -> Work:
    """One batch more of so many."""
    share = max(1.0 / MEAN_OVER, 1.0 / (1.0 + 0.1 * work.batch))
    return learnt_from(work, shown, _rate(work.batch, batches), share)


def _rate(at: int, batches: int) -> float:
    """Of the highest: rises, stays, and falls to nothing."""
    left = (1.0 - at / batches) / (1.0 - STEADY_SHARE)
    return min(1.0, (at + 1) / WARM, max(left, 0.01))


def _held(folder: Path, seed: int) -> Iterator[Composite]:
    """Pictures of people who were held back."""
    for at in range(HELD_BATCHES):
        yield from composed(Wanted((folder,), seed, BATCHES + HEAD_BATCHES + at))


def _right(network: nn.Module, shown: list[Composite]) -> float:
    """Share of the joints that are nearly right."""
    off = landmark_loss.joints_off(network, shown)
    return float((off[np.isfinite(off)] < NEAR).mean())
