"""What hides people in pictures: furniture, what they push or carry, others, and long cloth."""

from collections.abc import Callable
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.picture.picture_examples import SIDE_PX, PictureExample
from synth.things.furniture import MOVED, THINGS
from synth.things.shade import Floats, Place, fill, line

OUTLINED_SHARE: Final = 0.5
"""Share of what people push or carry that their silhouettes have: it moves, too."""
PLAIN_SHARE: Final = 0.6
"""Share of obstacles of one colour; all others are parts of a backdrop."""
COAT_SHARE: Final = 0.4
"""Share of cloth that hangs from the shoulders; all other hangs from the hips."""
HEM: Final = (0.35, 1.05)
"""Range of how far down the legs cloth hangs: 0.5 is the knee, 1 the ankle."""


class Layers(NamedTuple):
    """A picture while it is made, and what of it is the person."""

    picture: Floats
    """(SIDE_PX, SIDE_PX, 3)"""
    outline: NDArray[np.uint8]
    """1 inside the silhouette, 0 outside."""
    mask: NDArray[np.uint8]
    """1 where the person is visible, 0 elsewhere."""


def obstructed(layers: Layers, place: Place, texture: Floats, rng: np.random.Generator) -> Layers:
    """A thing before the person: any of THINGS.

    Args:
        layers: What there is.
        place: Where the person is.
        texture: (SIDE_PX, SIDE_PX, 3) what the thing may be painted with.
        rng: Source of all choices.
    """
    kind = list(THINGS)[int(rng.integers(len(THINGS)))]
    shade = THINGS[kind](place, rng)
    if rng.random() < PLAIN_SHARE:
        texture = np.full_like(texture, rng.uniform(10, 240) * rng.uniform(0.6, 1.0, 3))
    colours = np.concatenate([texture * shade[..., None], 255.0 * (shade[..., None] > 0)], axis=2)
    moves = kind in MOVED and rng.random() < OUTLINED_SHARE
    return hidden_by(layers, np.asarray(colours, np.float32), moves)


def covered(layers: Layers, texture: Callable[[], Floats], rng: np.random.Generator) -> Layers:
    """A plain thing before the person: a table's edge, a box; silhouettes may not know of it."""
    over = np.zeros((SIDE_PX, SIDE_PX), np.bool_)
    if rng.random() < 0.5:
        over[int(rng.uniform(0.5, 0.95) * SIDE_PX) :] = True
    else:
        (left, top), (wide, high) = (
            rng.integers(0, SIDE_PX, 2),
            rng.integers(SIDE_PX // 16, SIDE_PX * 2 // 5, 2),
        )
        over[top : top + high, left : left + wide] = True
    picture = np.where(over[..., None], texture(), layers.picture)
    outline = layers.outline * ~over if rng.random() < 0.6 else layers.outline
    mask = (layers.mask * ~over).astype(np.uint8)
    return Layers(np.asarray(picture, np.float32), outline.astype(np.uint8), mask)


def hidden_by(layers: Layers, thing: Floats, moves: bool) -> Layers:
    """Something before the person, and before what is behind.

    Args:
        layers: What there is.
        thing: (SIDE_PX, SIDE_PX, 4) blue, green, red, times coverage; coverage.
        moves: Whether the silhouette has it; else it has a gap there.
    """
    picture = layers.picture * (1.0 - thing[..., 3:] / 255) + thing[..., :3]
    over = thing[..., 3] > 127.5
    outline = layers.outline | over if moves else layers.outline * ~over
    mask = (layers.mask * ~over).astype(np.uint8)
    return Layers(np.asarray(picture, np.float32), outline.astype(np.uint8), mask)


def beside(other: PictureExample, rng: np.random.Generator) -> Floats:
    """Another person of about the same size, some steps aside: as an example's body."""
    size = float(rng.uniform(0.7, 1.2))
    aside = rng.choice([-1, 1]) * rng.uniform(0.15, 0.5) * SIDE_PX
    shift = (1.0 - size) * SIDE_PX / 2 + np.array([aside, rng.normal(0.0, 0.06) * SIDE_PX])
    warp = np.array([[size, 0.0, shift[0]], [0.0, size, shift[1]]], np.float32)
    return cv2.warpAffine(other.body, warp, (SIDE_PX, SIDE_PX)).astype(np.float32)


def coated(example: PictureExample, rng: np.random.Generator) -> PictureExample:
    """The same person in a long coat or skirt; forearms and hands are before it."""
    place = Place(example.joints_px, example.stature_px, SIDE_PX)
    cloth = place.blank()
    fill(cloth, cv2.convexHull(_corners(place, rng))[:, 0], 1.0)
    for side in "lr":
        elbow, wrist = place.middle(f"{side}_elbow"), place.middle(f"{side}_wrist")
        line(cloth, [elbow, wrist + 0.35 * (wrist - elbow)], 0.05 * place.stature, 0.0)
    across = np.linspace(0.0, rng.uniform(2.0, 9.0) * SIDE_PX / place.stature, SIDE_PX)
    folds = 1.0 - rng.uniform(0.0, 0.3) * (0.5 + 0.5 * np.sin(2 * np.pi * across))
    colour = rng.uniform(10, 230) * rng.uniform(0.6, 1.0, 3)
    body, on = example.body.copy(), cloth > 0
    body[on, :3] = np.broadcast_to(folds[None, :, None] * colour, body[..., :3].shape)[on]
    body[on, 3] = 255
    return example._replace(body=body, outline=example.outline | on.astype(np.uint8))


def _corners(place: Place, rng: np.random.Generator) -> Floats:
    """(n, 2) of cloth: where it hangs from, and its hem, wider than the legs."""
    down, wide = rng.uniform(*HEM), rng.uniform(0.03, 0.1) * place.stature
    tops = ["hip", "shoulder"] if rng.random() < COAT_SHARE else ["hip"]
    corners = []
    for side, other in ("lr", "rl"):
        hip, knee, ankle = (place.middle(f"{side}_{name}") for name in ("hip", "knee", "ankle"))
        hem = (
            hip + 2 * down * (knee - hip) if down < 0.5 else knee + (2 * down - 1) * (ankle - knee)
        )
        apart = hip - place.middle(f"{other}_hip")
        out = apart / max(float(np.linalg.norm(apart)), 1.0) * wide
        corners += [hem + out, hem - 0.5 * out, hem + np.array([wide, 0.0])]
        corners += [hem - np.array([wide, 0.0])]
        corners += [place.middle(f"{side}_{name}") + 0.6 * out for name in tops]
    return np.asarray(corners, np.float32)
