"""Ten actions of filmed people by silhouettes alone, each actor named by models of the others.

Run from the checkout: .venv/bin/python benchmarks/weizmann.py FOLDER/aligned_masks.npz

The silhouettes are those of Gorelick et al. 2007: one view, translation removed. A frame is its
silhouette at the actor's scale, as principal components, and how these change; an action is a
hidden Markov model of five states, learnt and scored by the recogniser's own engine. How many
components there are is chosen among the actors that are learnt from: nothing on whom is tested.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from lab.posture_models.evaluation import Outcome, confusion, wilson
from lab.posture_models.hmm_training import start, train_densities
from recognizer.forward import forward
from recognizer.postures import STATES

Array = NDArray[np.float64]

CANVAS: Final = (24, 32)
"""Width and height that a silhouette is drawn to; the actor's height fills four fifths of it."""
COMPONENTS: Final = (8, 12, 20)
"""Among how many principal components the choice is."""
CHANGE_FRAMES: Final = 3
"""Over how many frames a change is taken."""
SPREAD: Final = 0.3
"""Standard deviation that components are scaled to: the floor of variance, 0.01, is then a tenth
of their variance, about what four actors can tell of a fifth."""


class Filmed(NamedTuple):
    """One filmed action."""

    action: str
    actor: str
    pictures: Array
    """(n, height width of the canvas), 0 to 1."""


class Models(NamedTuple):
    """What was learnt from some actors."""

    middle: Array
    axes: Array  # (components, canvas)
    spread: Array  # (2 components,)
    actions: tuple[str, ...]
    transition: Array
    mean: Array
    variance: Array


def read(path: Path) -> list[Filmed]:
    """All sequences of the file."""
    with np.load(path, allow_pickle=False) as file:
        keys = sorted(key for key in file.files if not key.endswith("__shape"))
        return [_sequence(key, file[key], file[f"{key}__shape"]) for key in keys]


def _sequence(key: str, packed: NDArray[np.uint8], shape: NDArray[np.int64]) -> Filmed:
    action, actor, _ = key.split("_")
    masks = np.unpackbits(packed, axis=-1)[..., : shape[2]]
    heights = [np.ptp(np.flatnonzero(mask.any(axis=1))) + 1 for mask in masks]
    scale = 0.8 * CANVAS[1] / float(np.percentile(heights, 90))
    return Filmed(action, actor, np.stack([_drawn(mask, scale) for mask in masks]))


def _drawn(mask: NDArray[np.uint8], scale: float) -> Array:
    """A silhouette about its centre of gravity, (height width,)."""
    rows, columns = np.nonzero(mask)
    way = np.array(CANVAS) / 2 - scale * np.array([columns.mean(), rows.mean()])
    matrix = np.array([[scale, 0.0, way[0]], [0.0, scale, way[1]]])
    picture = cv2.warpAffine(mask.astype(np.float32), matrix, CANVAS, flags=cv2.INTER_AREA)
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 1.0), np.float64).ravel()


def mirrored(one: Filmed) -> Filmed:
    """The same action the other way."""
    pictures = one.pictures.reshape(-1, CANVAS[1], CANVAS[0])[:, :, ::-1]
    return one._replace(pictures=pictures.reshape(len(pictures), -1))


def learn(given: Sequence[Filmed], components: int) -> Models:
    """Components and a model of each action, from both ways of every sequence."""
    both = [*given, *map(mirrored, given)]
    pictures = np.concatenate([one.pictures for one in both])
    middle = pictures.mean(axis=0)
    axes = np.linalg.svd(pictures - middle, full_matrices=False)[2][:components]
    shown = [_shown(one, middle, axes) for one in both]
    spread = np.concatenate(shown).std(axis=0) / SPREAD
    actions = tuple(sorted({one.action for one in given}))
    models = []
    for action in actions:
        own = [s / spread for one, s in zip(both, shown, strict=True) if one.action == action]
        models.append(train_densities(own, "ergodic", 0, STATES))
    transition, mean, variance = (np.stack(part) for part in zip(*models, strict=True))
    return Models(middle, axes, spread, actions, transition, mean, variance)


def _shown(one: Filmed, middle: Array, axes: Array) -> Array:
    """Feature vectors (n, 2 components): where the silhouette is among shapes, how it changes."""
    at = (one.pictures - middle) @ axes.T
    before = np.maximum(np.arange(len(at)) - CHANGE_FRAMES, 0)
    return np.concatenate([at, at - at[before]], axis=1)


def name(models: Models, one: Filmed) -> str:
    """The likeliest action."""
    shown = _shown(one, models.middle, models.axes) / models.spread
    apart = np.square(shown[:, np.newaxis, np.newaxis] - models.mean) / models.variance
    logs = -0.5 * (apart + np.log(2 * np.pi * models.variance)).sum(axis=3)
    begin = np.tile(start("ergodic", STATES), (len(models.actions), 1))
    return models.actions[int(forward(begin, models.transition, logs).argmax())]


def outcomes(given: Sequence[Filmed], components: int) -> list[Outcome]:
    """Every actor named by models of all others."""
    found = []
    for actor in sorted({one.actor for one in given}):
        models = learn([one for one in given if one.actor != actor], components)
        found += [Outcome(one.action, name(models, one)) for one in given if one.actor == actor]
    return found


def chosen(given: Sequence[Filmed]) -> int:
    """The number of components that names most among these actors; the smallest of equals."""

    def right(components: int) -> int:
        return sum(one.truth == one.named for one in outcomes(given, components))

    return max(COMPONENTS, key=right)


def main(path: Path) -> None:
    """Measure, print, and write `weizmann.json` beside this file."""
    given = read(path)
    found, components = [], {}
    for actor in sorted({one.actor for one in given}):
        others = [one for one in given if one.actor != actor]
        components[actor] = chosen(others)
        models = learn(others, components[actor])
        found += [Outcome(one.action, name(models, one)) for one in given if one.actor == actor]
        print(actor, components[actor], [one for one in found[-10:] if one.truth != one.named])
    actions = sorted({one.action for one in given})
    correct = sum(one.truth == one.named for one in found)
    result = {
        "correct": correct,
        "tested": len(found),
        "interval_95": wilson(correct, len(found)),
        "components": components,
        "actions": actions,
        "confusion": confusion(found, actions).tolist(),
    }
    Path(__file__).with_name("weizmann.json").write_text(json.dumps(result, indent=1) + "\n")
    print(f"{correct}/{len(found)} = {correct / len(found):.1%}")


if __name__ == "__main__":
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_file():
        raise SystemExit("name the silhouettes: benchmarks/weizmann.py FOLDER/aligned_masks.npz")
    main(Path(sys.argv[1]))
