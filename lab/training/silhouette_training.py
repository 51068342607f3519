"""Training of the pixel classifier on videos of synthetic people with known masks."""

import multiprocessing
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
from rich.console import Console

from common.config.part_settings import SilhouetteSettings
from common.method import DEFAULT
from common.npz_file import Facts
from common.raster.similarity import Mask
from common.video.pictures import Image
from lab.training.training import TrainingError
from runtime.terminal import bar
from synth.motion.motions import EMPTY, POSTURES, Motion, performance
from synth.person.people import Colour, Person, person
from synth.picture.exposure import default_rig
from synth.picture.render import render, room_of
from synth.picture.synth_room import Room
from viewer.background.background import learn
from viewer.background.image_stack import Floats
from viewer.silhouette import silhouette
from viewer.silhouette.pixel_classifier import HIDDEN, PixelClassifier, save

EMPTY_FRAMES: Final = 8
"""Number of frames at the start of a synthetic clip without a person."""
PERFORMANCES: Final = 70
"""Number of training people in rooms."""
SIZE: Final = (320, 240)
SHARES: Final = (1, 2)
"""Reduction factors of pictures: one network serves small ones too."""
MOMENTS: Final = 14
"""Number of successive frames with a person."""
EVERY: Final = 3
"""Stride between training frames."""
PIXELS: Final = 400
"""Largest number of pixels from such a frame."""
FREE_EVERY: Final = 3
"""Every third person moves at random."""
QUALITY: Final = (75, 96)
"""JPEG qualities of a video's pictures; development clips have 86."""
ALIKE_SHARE, PIECE_SHARE = 0.6, 0.55
"""Share of the people who wear the room's colours, and of their clothes that do."""
PEOPLE, ROOMS = 400_000, 300_000
"""First seeds of people and rooms, outside any set of clips."""
EPOCHS, BATCH, RATE = 10, 512, 3e-3
NARROW: Final = 1e-3
"""Lower bound of a feature's spread before dividing by it."""


class Examples(NamedTuple):
    """Pixels: their features (n, FEATURES), and labels (n,), True for the body."""

    features: Floats
    body: Mask


class LabelledVideo(NamedTuple):
    """One camera's recording."""

    frames: list[Image]
    masks: list[Mask]


def train_silhouettes(out: Path, seed: int, console: Console) -> Facts:
    """Train the network from scratch and write it: some minutes.

    Args:
        out: The file to write.
        seed: Seed of the first person, of the first room, and of the network's initialisation.
        console: Shows progress.

    Raises:
        TrainingError: When the file cannot be written.
    """
    if not out.parent.is_dir():
        raise TrainingError(f"cannot write {out}: there is no folder {out.parent}")
    with multiprocessing.get_context("spawn").Pool() as pool, bar(console) as progress:
        seeds = range(seed, seed + PERFORMANCES)
        drawn = progress.track(
            pool.imap(examples_of, seeds), total=len(seeds), description="rendering"
        )
        parts = list(drawn)
    examples = Examples(*(np.concatenate(part) for part in zip(*parts, strict=True)))
    try:
        save(fitted(examples, seed), out)
    except OSError as error:
        raise TrainingError(f"cannot write {out}: {error.strerror}") from error
    return {"model": str(out), "pixels": len(examples.body)}


def examples_of(seed: int) -> Examples:
    """Training pixels from one performance, seen by two cameras."""
    rng = np.random.default_rng([seed, 79])
    parts = [
        part
        for film in films(seed, rng)
        for share in SHARES
        for part in _doubtful_pixels(_small(film, share), rng)
    ]
    return Examples(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def films(seed: int, rng: np.random.Generator) -> list[LabelledVideo]:
    """A performance recorded by two cameras: the empty room, then a person in the middle of a
    movement."""
    rig, staging = default_rig(*SIZE), np.random.default_rng([seed, 77])
    someone = _dressed(person(PEOPLE + seed), room_of(ROOMS + seed, rig), staging)
    posture = POSTURES[seed % len(POSTURES)] if seed % FREE_EVERY else "free"
    moved = _cut(performance(someone, posture, seed), staging)
    quality = [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(*QUALITY))]
    seen = [LabelledVideo([], []) for _ in rig.cameras]
    for shot in render(someone, moved, rig, ROOMS + seed, seed):
        for film, frame, mask in zip(seen, *shot, strict=True):
            packed = cv2.imencode(".jpg", frame, quality)[1]
            film.frames.append(np.asarray(cv2.imdecode(packed, cv2.IMREAD_COLOR), np.uint8))
            film.masks.append(mask)
    return seen


def _dressed(someone: Person, room: Room, rng: np.random.Generator) -> Person:
    """Some people wear about the colour of the background."""
    if rng.random() >= ALIKE_SHARE:
        return someone
    look = someone.look
    trousers = _worn(look.trousers, room, rng)
    shirt = _worn(look.shirt, room, rng)
    return someone._replace(look=look._replace(trousers=trousers, shirt=shirt))


def _worn(own: Colour, room: Room, rng: np.random.Generator) -> Colour:
    """A colour near one of the room's, or the person's own."""
    if rng.random() >= PIECE_SHARE:
        return own
    picture = room.pictures[rng.integers(2)]
    y, x = rng.integers(70, 190), rng.integers(110, 200)
    behind = np.median(picture[y : y + 20, x : x + 20].reshape(-1, 3), axis=0)
    worn = np.clip(behind * rng.uniform(0.8, 1.2) + rng.normal(0, 6, 3), 10, 245)
    return int(worn[0]), int(worn[1]), int(worn[2])


def _cut(moved: Motion, rng: np.random.Generator) -> Motion:
    """The empty room and the MOMENTS after it."""
    empty = int(np.count_nonzero(moved.phase == EMPTY))
    start = int(rng.integers(empty, len(moved.phase) - MOMENTS - 2))
    rows = np.r_[0:empty, start : start + MOMENTS]
    return moved._replace(
        joints_m=moved.joints_m[rows],
        bones=moved.bones[rows],
        angles_deg=moved.angles_deg[rows],
        root_m=moved.root_m[rows],
        phase=moved.phase[rows],
    )


def _small(film: LabelledVideo, share: int) -> LabelledVideo:
    """The video at a reduced size; a small pixel is body where half of it is."""
    width, height = SIZE[0] // share, SIZE[1] // share
    frames = [cv2.resize(each, (width, height), interpolation=cv2.INTER_AREA) for each in film[0]]
    masks = [
        each.reshape(height, share, width, share).mean(axis=(1, 3)) >= 0.5 for each in film.masks
    ]
    return LabelledVideo([np.asarray(frame, np.uint8) for frame in frames], masks)


def _doubtful_pixels(film: LabelledVideo, rng: np.random.Generator) -> Iterator[Examples]:
    """Pixels that the viewer would classify again in some frames, with their labels."""
    settings = SilhouetteSettings()
    state = silhouette.init(learn(film.frames[:EMPTY_FRAMES]), settings, DEFAULT)
    for count, (frame, truth) in enumerate(zip(film.frames, film.masks, strict=True)):
        if not truth.any():
            continue
        state = silhouette.in_light_of(state, frame)
        guessed = silhouette.guess(state, frame, None)
        if count % EVERY == 0:
            rows = rng.permutation(len(guessed.places))[:PIXELS]
            yield Examples(guessed.features[rows], truth[tuple(guessed.places[rows].T)])
        state = silhouette.learn_colours(state, guessed.mask, frame, guessed)


def fitted(examples: Examples, seed: int) -> PixelClassifier:
    """The classifier, trained by Adam; the features' scales are folded into its weights."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.neural_network import MLPClassifier

    middle, spread = examples.features.mean(axis=0), examples.features.std(axis=0) + NARROW
    model = MLPClassifier(
        (HIDDEN,),
        batch_size=BATCH,
        learning_rate_init=RATE,
        max_iter=EPOCHS,
        n_iter_no_change=EPOCHS,
        random_state=seed,
    )
    with warnings.catch_warnings():
        # EPOCHS are enough, converged or not
        warnings.simplefilter("ignore", ConvergenceWarning)
        model.fit((examples.features - middle) / spread, examples.body)
    fc1 = model.coefs_[0] / spread[:, None]
    arrays = (fc1, model.intercepts_[0] - middle @ fc1, model.coefs_[1][:, 0])
    return PixelClassifier(
        *(np.asarray(each, np.float32) for each in (*arrays, model.intercepts_[1]))
    )
