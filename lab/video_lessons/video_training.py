"""Fine-tuning of the packaged landmark network on videos, and a test whether it improves."""

import multiprocessing
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
import torch
from rich.console import Console
from rich.progress import TaskID
from torch import nn

from common.npz_file import Facts
from lab.landmark_lessons import landmark_loss, work_of
from lab.landmark_lessons.landmark_bytes import write_both
from lab.landmark_lessons.landmark_confidence import set_confidence
from lab.landmark_lessons.landmark_file import fill, weights_of
from lab.landmark_lessons.landmark_learning import (
    Work,
    ahead,
    begun,
    keep,
    learnt_from,
    resumed,
)
from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
from lab.landmark_lessons.movenet_layers import MoveNet
from lab.landmark_lessons.picture_store import Backdrops, Part, PictureStore, draw
from lab.training.training import TrainingError
from lab.video_lessons.video_examples import Looked, looked_through
from runtime.terminal import bar
from synth.picture.composites import UNKNOWN, Composite, composite
from synth.picture.picture_examples import PictureExample
from viewer.landmarks.landmark_looks import SHIPPED

FIRST: Final = 30_000_000
"""Seed of the first synthetic person: outside the packaged network's training data."""
VIDEO_SHARE: Final = 0.5
"""Share of the videos' examples in each batch."""
RATE, WARM, MEAN_OVER, KEEP_EVERY = 0.5, 20, 50, 50
"""As in `landmark_training`; half of its highest rate: the network is trained already."""
FAR: Final = 0.3
"""Upper bound of a joint's error in the mean, statures."""
FORGETS: Final = 1.03
"""Largest ratio of the error on synthetic people, after to before, with which a network is kept."""
FEWEST: Final = 50
"""Fewest training examples; a quarter of that are held out."""


class Plan(NamedTuple):
    """Amount of training."""

    people: int = 300
    """Number of synthetic people, sixteen pictures each, that are mixed in against forgetting."""
    anny_people: int = 150
    """Number of synthetic people of the Anny model that are mixed in."""
    held_back: int = 40
    """Number of synthetic people that test for forgetting."""
    backdrops: int = 600
    batches: int = 500
    batch: int = 96


class Verdict(NamedTuple):
    """Mean error of joints, statures, before and after."""

    film: tuple[float, float]
    """On the videos' held-out ends."""
    made_up: tuple[float, float]
    """On synthetic people."""

    @property
    def better(self) -> bool:
        """Whether it improves on the videos, and hardly forgets."""
        return self.film[1] < self.film[0] and self.made_up[1] < FORGETS * self.made_up[0]

    def line(self) -> str:
        """The result in words."""
        (film, film_now), (made_up, made_up_now) = self
        return (
            f"joints {100 * film:.1f} -> {100 * film_now:.1f} % of the stature off at the films' "
            f"ends, {100 * made_up:.1f} -> {100 * made_up_now:.1f} % of made-up people"
        )


class Wanted(NamedTuple):
    """A request for a batch; equal requests give equal batches."""

    films: tuple[Path, ...]
    made_up: tuple[Path, ...]
    at: int
    plan: Plan


def teach_on_videos(
    films: Sequence[Path], teacher: str, out: Path, console: Console, plan: Plan = Plan()
) -> Facts:
    """Fine-tune the packaged network on videos and write it if it improves. Examples and progress
    are kept in `<out>.work`, from which the next call resumes.

    Args:
        films: Videos of static cameras; the last fifth of each tests the result.
        teacher: See `looked_through`.
        out: The file to write, ONNX.
        console: Shows progress.
        plan: Amount of training.

    Raises:
        TrainingError: When too little of any person is seen, or the network does not improve.
    """
    folder = work_of(out)
    looked = _looked(films, teacher, folder, console)
    *made_up, held_back = _drawn(folder, plan, console)
    wanted = Wanted(tuple(each.learnt for each in looked), tuple(made_up), 0, plan)
    before = _shipped()
    work = _learnt(wanted, folder / "learnt.pt", console)
    held = Wanted(tuple(each.held for each in looked), (held_back,), 0, plan)
    verdict = Verdict(*zip(*(_off(each, held) for each in (before, work.mean)), strict=True))
    if not verdict.better:
        raise TrainingError(f"no better, so nothing is written: {verdict.line()}")
    set_confidence(work.mean, _spoilt(held))
    write_both(work.mean, composed(wanted._replace(at=plan.batches)), folder, out)
    return {"model": str(out), "verdict": verdict.line(), **verdict._asdict()}


def _looked(films: Sequence[Path], teacher: str, folder: Path, console: Console) -> list[Looked]:
    with bar(console) as progress:
        looked = []
        for n, film in enumerate(films):
            task = progress.add_task(f"looking through {film.name}", total=1.0)

            def tell(share: float, task: TaskID = task) -> None:
                progress.update(task, completed=share)

            looked.append(looked_through(film, teacher, folder / f"film{n}_{film.stem}", tell))
    learnt, held = ([len(PictureStore([each[at]])) for each in looked] for at in (0, 1))
    if sum(learnt) < FEWEST or sum(held) < FEWEST // 4:
        raise TrainingError(
            f"the teacher saw a person in {sum(learnt) + sum(held)} frames: name videos of more"
        )
    return looked


def _drawn(folder: Path, plan: Plan, console: Console) -> list[Path]:
    """Synthetic people: our own, those of Anny, and last those that are held out."""
    parts = [
        Part(folder / "own", FIRST, plan.people),
        Part(folder / "anny", FIRST, plan.anny_people, anny=True),
        Part(folder / "held_back", FIRST + plan.people, plan.held_back),
    ]
    asked = [part for part in parts if part.people]
    with multiprocessing.get_context("spawn").Pool() as pool, bar(console) as progress:
        drawn = pool.imap(draw, asked)
        return list(progress.track(drawn, total=len(asked), description="drawing"))


def composed(wanted: Wanted) -> list[Composite]:
    """One batch of videos and synthetic people, with random light, rotation and corruption."""
    cv2.setNumThreads(1)
    films, made_up = _opened(wanted.films), _opened(wanted.made_up)
    backdrops, rng = _backdrops(wanted.plan), np.random.default_rng([wanted.at, 83])
    return [
        composite(
            (films if rng.random() < VIDEO_SHARE else made_up).any(rng),
            lambda: made_up.any(rng),
            lambda: backdrops.any(rng),
            rng,
        )
        for _ in range(wanted.plan.batch)
    ]


@lru_cache(maxsize=4)
def _opened(folders: tuple[Path, ...]) -> PictureStore:
    return PictureStore(list(folders))


@lru_cache(maxsize=1)
def _backdrops(plan: Plan) -> Backdrops:
    return Backdrops.drawn(range(FIRST, FIRST + plan.backdrops))


def _shipped() -> MovenetLandmarks:
    """The packaged network; weights stored in bytes are dequantised."""
    network = MovenetLandmarks(MoveNet()).to(memory_format=torch.channels_last)
    fill(network, weights_of(SHIPPED))
    return network.eval()


def _learnt(wanted: Wanted, kept: Path, console: Console) -> Work:
    """The network after all batches; those done before are not repeated."""
    network, batches = _shipped(), wanted.plan.batches
    work = resumed(begun(network, [network.heads(), network.trunk()]), kept)
    wishes = (wanted._replace(at=at) for at in range(work.batch, batches))
    with multiprocessing.get_context("spawn").Pool(1) as pool, bar(console) as progress:
        task = progress.add_task("learning", total=batches, completed=work.batch)
        for shown in ahead(pool, composed, wishes):
            rate = RATE * min(1.0, (work.batch + 1) / WARM, 1.0 - work.batch / batches)
            work = learnt_from(work, shown, rate, max(1.0 / MEAN_OVER, 1.0 / (1 + work.batch)))
            progress.advance(task)
            if work.batch % KEEP_EVERY == 0 or work.batch == batches:
                keep(work, kept)
    return work


def _off(network: nn.Module, held: Wanted) -> tuple[float, float]:
    """Error of joints, on the videos' held-out ends without augmentation, and on synthetic
    people."""
    films = _opened(held.films)
    plain = [_plain(films[at]) for at in range(len(films))]
    return _mean_off(network, plain), _mean_off(network, _spoilt(held))


def _spoilt(held: Wanted) -> list[Composite]:
    """One composite of each synthetic example that is held back."""
    rng, made_up, backdrops = (
        np.random.default_rng(89),
        _opened(held.made_up),
        _backdrops(held.plan),
    )
    return [
        composite(made_up[at], lambda: made_up.any(rng), lambda: backdrops.any(rng), rng)
        for at in range(len(made_up))
    ]


def _plain(example: PictureExample) -> Composite:
    """An example of a video without augmentation."""
    joints = example.joints_px
    inside = np.all((joints > 0) & (joints < len(example.body)), axis=1)
    outline = example.outline * np.uint8(255)
    picture = np.ascontiguousarray(example.body[..., :3])
    mask = np.full_like(outline, UNKNOWN)
    return Composite(
        picture, outline, mask, joints, inside, example.facing, example.stature_px, nobody=False
    )


def _mean_off(network: nn.Module, shown: list[Composite]) -> float:
    off = landmark_loss.joints_off(network, shown)
    return float(np.minimum(off[np.isfinite(off)], FAR).mean())
