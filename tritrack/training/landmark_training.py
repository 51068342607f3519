"""The network of landmarks, trained on pictures of synthetic people: resumable, hours."""

import copy
import multiprocessing
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
import torch
from rich.console import Console

from synth.picture.composites import Composite, composite
from tritrack.terminal import bar
from tritrack.training import torch_landmarks
from tritrack.training.picture_store import Backdrops, Part, PictureStore, draw
from tritrack.training.training import TrainingError
from viewer.landmarks.landmark_network import SHIPPED


class Amount(NamedTuple):
    """How much is learnt."""

    people: int
    """Our own people, sixteen pictures each."""
    anny_people: int
    """Bodies of the Anny model."""
    backdrops: int
    batches: int
    rate: float
    """Highest rate."""
    mean_over: int
    """Batches over which the weights' running mean goes: that mean is what is written."""


FROM_NOTHING: Final = Amount(12_000, 4_000, 8_000, 12_000, 2e-3, 1000)
FURTHER: Final = Amount(2_000, 750, 700, 1_600, 1e-3, 160)
"""What a network is taught on by that learnt before."""
PART: Final = 500
"""How many people a file holds: 300 MB."""
ANNY_TIMES: Final = 2
"""How much more often than one of our own a person of that model is shown."""
HELD_BACK: Final = 100
"""People who are drawn to tell how good the network is, and not learnt from."""
BATCH: Final = 128
WARM, STEADY_SHARE, DECAY = 200, 0.55, 1e-4
"""Batches until the highest rate is reached; share of them until it falls to nothing."""
STEEPEST: Final = 5.0
"""Size that a slope is cut to."""
KEEP_EVERY: Final = 200
"""Batches after which the work so far is kept."""
NEAR: Final = 0.1
"""What is told of how good it is: how many joints are within this share of the stature."""


class Course(NamedTuple):
    """What is to be learnt; the same course gives the same pictures in the same order."""

    amount: Amount
    seed: int
    """The first person's, and of all choices."""
    start: Path | None = None
    """A network that is taught on; None: learnt from nothing."""


class Work(NamedTuple):
    """How far a training is."""

    network: Any
    mean: Any
    """The same, its weights' running mean."""
    adam: Any
    batch: int
    """The next one."""


def train_landmarks(
    out: Path, seed: int, console: Console, start: Path | None = None
) -> dict[str, Any]:
    """Learn the network and write it, hours on two cores; what is drawn and learnt is kept beside
    it in a folder, `<out>.work`, and the next call with the same file goes on from there.

    Args:
        out: The file to write, ONNX.
        seed: The first person's, and of all choices.
        console: For progress.
        start: A network that is taught on, or `shipped`; None: learnt from nothing.

    Raises:
        TrainingError: When the file cannot be written, or `start` is no such network.
    """
    if not out.parent.is_dir():
        raise TrainingError(f"cannot write {out}: there is no folder {out.parent}")
    folder = out.with_name(out.name + ".work")
    course = Course(FROM_NOTHING if start is None else FURTHER, seed, start)
    first = _first_network(start)
    try:
        folders = _drawn(folder, course, console)
        work = _learnt(folders[:-1], folder / "learnt.pt", first, course, console)
        torch_landmarks.export(work.mean, out)
    except OSError as error:
        raise TrainingError(f"cannot write {folder}: {error.strerror}") from error
    right = _right(work.mean, folders[-1:], course)
    return {"model": str(out), "pictures": work.batch * BATCH, "within_a_tenth": right}


def _first_network(start: Path | None) -> Any:
    """The network to be taught on; None: a fresh one, whose weights its seed gives."""
    if start is None:
        return None
    try:
        return torch_landmarks.read(SHIPPED if start == Path("shipped") else start)
    except (OSError, ValueError) as error:
        raise TrainingError(f"cannot teach {start} on: {error}") from error


def _drawn(folder: Path, course: Course, console: Console) -> list[Path]:
    """The folders of all people, those who are held back last."""
    amount, first = course.amount, course.seed * 2 * FROM_NOTHING.people
    kinds = (("own", amount.people, False), ("anny", amount.anny_people, True))
    parts = [
        Part(folder / f"{name}{at}", first + at, min(PART, people - at), anny)
        for name, people, anny in kinds
        for at in range(0, people, PART)
    ]
    parts.append(Part(folder / "held_back", first + FROM_NOTHING.people, HELD_BACK))
    with multiprocessing.get_context("spawn").Pool() as pool, bar(console) as progress:
        drawn = pool.imap(draw, parts)
        folders = list(progress.track(drawn, total=len(parts), description="drawing"))
    own = -(-amount.people // PART)
    return [*folders[:own], *folders[own:-1] * ANNY_TIMES, folders[-1]]


class Wanted(NamedTuple):
    """A batch that is to be made up; the same wish gives the same batch."""

    folders: tuple[Path, ...]
    backdrops: range
    """Seeds of those it may have."""
    seed: int
    batch: int


def _wanted(folders: list[Path], course: Course, batch: int) -> Wanted:
    first = course.seed * FROM_NOTHING.backdrops
    backdrops = range(first, first + course.amount.backdrops)
    return Wanted(tuple(folders), backdrops, course.seed, batch)


def composed(wanted: Wanted) -> list[Composite]:
    """One batch of pictures."""
    cv2.setNumThreads(1)
    store, backdrops = _opened(wanted.folders), _backdrops(wanted.backdrops)
    rng = np.random.default_rng([wanted.seed, wanted.batch, 81])
    return [
        composite(store.any(rng), lambda: store.any(rng), lambda: backdrops.any(rng), rng)
        for _ in range(BATCH)
    ]


@lru_cache(maxsize=1)
def _opened(folders: tuple[Path, ...]) -> PictureStore:
    return PictureStore(list(folders))


@lru_cache(maxsize=1)
def _backdrops(seeds: range) -> Backdrops:
    return Backdrops.drawn(seeds)


def _learnt(folders: list[Path], kept: Path, first: Any, course: Course, console: Console) -> Work:
    """The network after all batches; what was kept before is not done again."""
    batches = course.amount.batches
    if first is not None and not kept.exists():
        torch_landmarks.normalised(first, composed(_wanted(folders, course, batches)))
    work = _begun(kept, first, course)
    wishes = (_wanted(folders, course, at) for at in range(work.batch, batches))
    with multiprocessing.get_context("spawn").Pool(1) as pool, bar(console) as progress:
        task = progress.add_task("learning", total=batches, completed=work.batch)
        for shown in _ahead(pool, wishes):
            work = _step(work, shown, course.amount)
            progress.advance(task)
            if work.batch % KEEP_EVERY == 0 or work.batch == batches:
                _keep(work, kept)
    return work


def _ahead(pool: Any, wishes: Iterator[Wanted], ahead: int = 4) -> Iterator[list[Composite]]:
    """Batches in their order, a few made before they are asked for."""
    coming = []
    for wanted in wishes:
        coming.append(pool.apply_async(composed, (wanted,)))
        if len(coming) > ahead:
            yield coming.pop(0).get()
    for last in coming:
        yield last.get()


def _begun(kept: Path, first: Any, course: Course) -> Work:
    """What was kept, or a start: from a network, or from nothing."""
    torch.manual_seed(course.seed)
    network = torch_landmarks.LandmarkNetwork() if first is None else first
    network = network.to(memory_format=torch.channels_last)
    mean = copy.deepcopy(network)
    adam = torch.optim.AdamW(network.parameters(), lr=course.amount.rate, weight_decay=DECAY)
    if not kept.exists():
        return Work(network, mean, adam, 0)
    held = torch.load(kept, weights_only=True)
    network.load_state_dict(held["network"])
    mean.load_state_dict(held["mean"])
    adam.load_state_dict(held["adam"])
    return Work(network, mean, adam, int(held["batch"]))


def _keep(work: Work, kept: Path) -> None:
    """Write it, then put it in the place of what was kept before."""
    parts = {name: getattr(work, name).state_dict() for name in ("network", "mean", "adam")}
    new = kept.with_name("new.pt")
    torch.save({**parts, "batch": work.batch}, new)
    new.rename(kept)


def _step(work: Work, shown: list[Composite], amount: Amount) -> Work:
    """One batch more."""
    network, mean, adam, at = work
    for group in adam.param_groups:
        group["lr"] = _rate(at, amount)
    network.train()
    adam.zero_grad()
    torch_landmarks.loss(network, shown).backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), STEEPEST)
    adam.step()
    share = max(1.0 / amount.mean_over, 1.0 / (1.0 + 0.1 * at))
    with torch.no_grad():
        own, running = network.state_dict(), mean.state_dict()
        for name, value in running.items():
            if value.is_floating_point():
                value.lerp_(own[name], share)
    return work._replace(batch=at + 1)


def _rate(at: int, amount: Amount) -> float:
    """Rises, stays, and falls to nothing."""
    left = (1.0 - at / amount.batches) / (1.0 - STEADY_SHARE)
    return amount.rate * min(1.0, (at + 1) / WARM, max(left, 0.01))


def _right(network: Any, folders: list[Path], course: Course) -> float:
    """Share of the joints of people who were held back that are nearly right."""
    shown = composed(_wanted(folders, course, course.amount.batches))
    off = torch_landmarks.joints_off(network, shown)
    return float((off[np.isfinite(off)] < NEAR).mean())
