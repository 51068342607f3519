"""Synthetic people before backdrops, with light, occlusion and the flaws of cheap cameras."""

from collections.abc import Callable
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import OTHER_SIDE, Vector
from synth.picture.backdrops import SIDE_PX as BACKDROP_PX
from synth.picture.backdrops import Backdrop
from synth.picture.obstacles import Layers, beside, coated, covered, hidden_by, obstructed
from synth.picture.picture_examples import SIDE_PX, PictureExample
from synth.things.shade import Place

Floats = NDArray[np.float32]
UNKNOWN: Final = 128
"""Value of an unknown silhouette."""
NOBODY_SHARE: Final = 0.04
"""Share of the pictures with the backdrop alone."""
ALIKE_SHARE, PLAIN_SHARE = 0.15, 0.2
"""Share of backdrops with a colour of the person's, and share with hardly any pattern."""
BEHIND_SHARE, BEFORE_SHARE = 0.15, 0.04
"""Share of pictures with another person behind or before the person."""
SHADOW_SHARE, HIDDEN_SHARE, BORDER_SHARE = 0.35, 0.12, 0.12
"""Shares with the person's shadow, with an object before the person, with the picture's border."""
CLOTH_SHARE, THING_SHARE, PASSER_SHARE = 0.35, 0.65, 0.2
"""Shares of the obstructed pictures with long cloth over the legs, with a thing before the person,
and with another person partly before the person."""
VISIBLE: Final = 0.3
"""A thing or another person that leaves less of the person than this share is left away."""
COARSEST: Final = 1.3
"""Logarithm of the ratio by which a picture is coarser than the window."""
COARSE_SHARE, SMEARED_SHARE, GREY_SHARE, JPEG_SHARE = 0.6, 0.15, 0.25, 0.3
UNTOLD_SHARE, RAGGED_SHARE = 0.3, 0.15
"""Shares of silhouettes that are unknown, ragged, with holes, or with other foreground."""
TURN_DEG, LARGER, BESIDE_PX = 6.0, 0.12, 0.021 * SIDE_PX
FINE_TINT, EXPOSURE = 0.07, 0.25
"""Sizes of random changes: rotation, logarithm of the size, displacement, logarithms
of a colour's gain and of the exposure."""


class Composite(NamedTuple):
    """One picture, and its ground truth."""

    picture: NDArray[np.uint8]
    """(SIDE_PX, SIDE_PX, 3) blue, green, red."""
    outline: NDArray[np.uint8]
    """(SIDE_PX, SIDE_PX) 255 inside, 0 outside; all UNKNOWN where it is unknown."""
    mask: NDArray[np.uint8]
    """(SIDE_PX, SIDE_PX) 255 where the person is visible, 0 elsewhere, whatever the silhouette
    says; all UNKNOWN for a recorded frame, whose body covers all of it."""
    joints_px: Floats
    """(15, 2) JOINT_NAMES order."""
    inside: NDArray[np.bool_]
    """(15,) which of them are in the picture; none without a person."""
    facing: Floats
    """(2,) as in PictureExample; 0 without a person."""
    stature_px: float
    nobody: bool


Draw = Callable[[], PictureExample]


def composite(
    example: PictureExample,
    other: Draw,
    backdrop: Callable[[], Backdrop],
    rng: np.random.Generator,
    obstructed_share: float = 0.0,
) -> Composite:
    """One of many random pictures of an example.

    Args:
        example: The person.
        other: Gives another person.
        backdrop: Gives a backdrop.
        rng: Source of all choices.
        obstructed_share: Share of the pictures in which furniture, something that is pushed or
            carried, another person or long cloth hides a part of the person. All other choices
            are the same without it.
    """
    aside = rng.spawn(1)[0]
    is_obstructed = bool(aside.random() < obstructed_share)
    if is_obstructed and aside.random() < CLOTH_SHARE:
        example = coated(example, aside)
    nobody = bool(rng.random() < NOBODY_SHARE)
    whole = example.body.astype(np.float32) * np.float32(not nobody)
    coverage, body = whole[..., 3:] / np.float32(255), _lit(whole[..., :3], rng)
    behind = _shadowed(_behind(body, coverage, other, backdrop, rng), coverage, rng)
    picture: Floats = behind * (np.float32(1) - coverage) + body
    mask = (coverage[..., 0] > 0.5).astype(np.uint8)
    layers = _before(Layers(picture, example.outline.copy(), mask), other, rng)
    if rng.random() < HIDDEN_SHARE:
        layers = covered(layers, lambda: _cut(backdrop(), rng), rng)
    if is_obstructed:
        layers = _obstructed(layers, example, other, backdrop, aside)
    layers, joints, facing, larger = _turned(layers, example, rng)
    inside = ((joints > 0) & (joints < SIDE_PX)).all(axis=1)
    edge = _border(rng)
    inside &= ~_beyond(edge, joints)
    shown = _filmed(layers.picture, rng)
    if edge is not None:
        shown[edge], layers.outline[edge], layers.mask[edge] = 0, 0, 0
    told = _told(layers.outline, rng)
    stature_px = example.stature_px * larger
    if nobody:
        inside, facing = np.zeros_like(inside), np.zeros_like(facing)
        told[:] = UNKNOWN if rng.random() < 0.5 else told
    exact = np.full_like(told, UNKNOWN) if mask.all() else layers.mask * np.uint8(255)
    return Composite(shown, told, exact, joints, inside, facing, stature_px, nobody)


def _lit(body: Floats, rng: np.random.Generator) -> Floats:
    gain = np.exp(rng.normal(0.0, EXPOSURE) + rng.normal(0.0, FINE_TINT, 3))
    return np.asarray(body * gain, np.float32)


def _cut(backdrop: Backdrop, rng: np.random.Generator) -> Floats:
    """A part of a backdrop, mirrored or not."""
    top, left = rng.integers(0, BACKDROP_PX - SIDE_PX + 1, 2)
    cut = backdrop[top : top + SIDE_PX, left : left + SIDE_PX].astype(np.float32)
    return cut[:, :: rng.choice([-1, 1])]


def _behind(
    body: Floats,
    coverage: Floats,
    other: Draw,
    backdrop: Callable[[], Backdrop],
    rng: np.random.Generator,
) -> Floats:
    """The background of the person."""
    behind, chance = _cut(backdrop(), rng), rng.random()
    rows, columns = np.nonzero(coverage[..., 0] > 0.9)
    if chance < ALIKE_SHARE and len(rows):
        at = int(rng.integers(len(rows)))
        flat = behind * rng.uniform(0.2, 1.0)
        tint = body[rows[at], columns[at]] + rng.normal(0.0, 8.0, 3) - flat.mean(axis=(0, 1))
        behind = np.asarray(flat + tint, np.float32)
    elif chance < ALIKE_SHARE + PLAIN_SHARE:
        tint = rng.uniform(0, 220) * (1.0 - rng.uniform(0.0, 0.15, 3))
        behind = np.asarray(behind * rng.uniform(0.05, 0.4) + tint, np.float32)
    behind = np.asarray(behind.clip(0, 255), np.float32)
    return _over(behind, _elsewhere(other(), rng)) if rng.random() < BEHIND_SHARE else behind


def _before(layers: Layers, other: Draw, rng: np.random.Generator) -> Layers:
    """Another person before the person; the silhouette stays as it is."""
    if rng.random() >= BEFORE_SHARE:
        return layers
    body = _elsewhere(other(), rng)
    mask = layers.mask * (body[..., 3] < 127.5)
    return Layers(_over(layers.picture, body), layers.outline, mask.astype(np.uint8))


def _elsewhere(other: PictureExample, rng: np.random.Generator) -> Floats:
    """Another person, of another size, in another place: (SIDE_PX, SIDE_PX, 4) as an example's."""
    warp = np.eye(2, 3, dtype=np.float32) * np.float32(rng.uniform(0.4, 1.1))
    warp[:, 2] = rng.uniform(-SIDE_PX / 2, SIDE_PX / 2, 2)
    return cv2.warpAffine(other.body, warp, (SIDE_PX, SIDE_PX)).astype(np.float32)


def _over(picture: Floats, body: Floats) -> Floats:
    return np.asarray(picture * (1.0 - body[..., 3:] / 255) + body[..., :3], np.float32)


def _shadowed(behind: Floats, coverage: Floats, rng: np.random.Generator) -> Floats:
    """The person's own shadow on what stands behind."""
    if rng.random() >= SHADOW_SHARE:
        return behind
    warp = np.array(
        [
            [1.0, rng.normal(0.0, 0.4), rng.normal(0.0, 0.0625 * SIDE_PX)],
            [0.0, rng.uniform(0.3, 1.0), rng.uniform(0.0, 0.52 * SIDE_PX)],
        ],
        np.float32,
    )
    cast = cv2.warpAffine(coverage[..., 0], warp, (SIDE_PX, SIDE_PX))
    soft = cv2.GaussianBlur(cast, (0, 0), SIDE_PX * float(rng.uniform(0.007, 0.042)))[..., None]
    return np.asarray(behind * (1.0 - rng.uniform(0.1, 0.6) * soft), np.float32)


def _obstructed(
    layers: Layers,
    example: PictureExample,
    other: Draw,
    backdrop: Callable[[], Backdrop],
    rng: np.random.Generator,
) -> Layers:
    """A thing before the person, another person partly so, or nothing but the cloth."""
    chance, after = rng.random(), layers
    if chance < THING_SHARE:
        place = Place(example.joints_px, example.stature_px, SIDE_PX)
        after = obstructed(layers, place, _cut(backdrop(), rng), rng)
    elif chance < THING_SHARE + PASSER_SHARE:
        after = hidden_by(layers, beside(other(), rng), bool(rng.random() < 0.5))
    return after if after.mask.sum() >= VISIBLE * layers.mask.sum() else layers


def _turned(
    layers: Layers, example: PictureExample, rng: np.random.Generator
) -> tuple[Layers, Floats, Floats, float]:
    """Random rotation, scale, shift and mirroring of everything, with its joints and facing."""
    larger = float(np.exp(rng.uniform(-LARGER, LARGER)))
    middle = (SIDE_PX / 2 - 0.5, SIDE_PX / 2 - 0.5)
    warp = cv2.getRotationMatrix2D(middle, float(rng.normal(0.0, TURN_DEG)), larger)
    warp[:, 2] += rng.normal(0.0, BESIDE_PX, 2)
    mirrored = rng.random() < 0.5
    if mirrored:
        warp = warp @ np.array([[-1.0, 0.0, SIDE_PX - 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    size = (SIDE_PX, SIDE_PX)
    picture = cv2.warpAffine(layers.picture, warp, size, borderMode=cv2.BORDER_REFLECT_101)
    outline, mask = (
        (cv2.warpAffine(plane * np.uint8(255), warp, size) > 127).astype(np.uint8)
        for plane in (layers.outline, layers.mask)
    )
    joints = (example.joints_px - 0.5) @ warp[:, :2].T + warp[:, 2] + 0.5
    facing = example.facing * (np.array([-1.0, 1.0]) if mirrored else 1.0)
    own = joints[OTHER_SIDE] if mirrored else joints
    layers = Layers(np.asarray(picture, np.float32), outline, mask)
    return layers, own.astype(np.float32), facing.astype(np.float32), larger


def _border(rng: np.random.Generator) -> tuple[slice, slice] | None:
    """Blacken the part of the window beyond the camera's picture."""
    if rng.random() >= BORDER_SHARE:
        return None
    wide, everything = int(rng.uniform(0.03, 0.35) * SIDE_PX), slice(0, SIDE_PX)
    part = slice(0, wide) if rng.random() < 0.5 else slice(SIDE_PX - wide, SIDE_PX)
    return (part, everything) if rng.random() < 0.5 else (everything, part)


def _beyond(edge: tuple[slice, slice] | None, joints: Floats) -> NDArray[np.bool_]:
    """(15,) which joints lie in a part of the window."""
    if edge is None:
        return np.zeros(len(joints), np.bool_)
    (top, bottom), (left, right) = ((part.start, part.stop) for part in edge)
    x, y = joints.T
    return np.asarray((x >= left) & (x <= right) & (y >= top) & (y <= bottom))


def _filmed(picture: Floats, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Camera flaws: coarse, smeared, grey, too dark, noisy, compressed."""
    size = (SIDE_PX, SIDE_PX)
    if rng.random() < COARSE_SHARE:
        few = max(20, int(SIDE_PX / np.exp(rng.uniform(0.0, COARSEST))))
        small = cv2.resize(picture, (few, few), interpolation=cv2.INTER_AREA)
        picture = np.asarray(cv2.resize(small, size), np.float32)
    if rng.random() < SMEARED_SHARE:
        kernel = np.zeros((9, 9), np.float32)
        start = (int(rng.integers(9)), int(rng.integers(9)))
        cv2.line(kernel, start, (4, 4), 1.0, 1)
        picture = np.asarray(cv2.filter2D(picture, -1, kernel / kernel.sum()), np.float32)
    if rng.random() < GREY_SHARE:
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        picture = np.repeat(grey[..., None], 3, axis=2)
    seen = _developed(picture, rng)
    if rng.random() < JPEG_SHARE:
        quality = [cv2.IMWRITE_JPEG_QUALITY, int(rng.uniform(15, 80))]
        packed = cv2.imencode(".jpg", seen, quality)[1]
        return np.asarray(cv2.imdecode(packed, cv2.IMREAD_COLOR), np.uint8)
    return seen


def _developed(picture: Floats, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Gamma, contrast, brightness, tint, noise."""
    curve = float(np.exp(rng.normal(0.0, EXPOSURE)))
    seen = (picture.clip(0, 255) / 255) ** curve * 255
    seen = (seen - 128) * np.exp(rng.normal(0.0, EXPOSURE)) + 128 + rng.normal(0.0, 25.0)
    seen = seen * np.exp(rng.normal(0.0, FINE_TINT, 3))
    noise = rng.standard_normal(picture.shape, np.float32) * np.float32(rng.uniform(0.0, 9.0))
    return np.asarray((seen + noise).clip(0, 255), np.uint8)


def _told(outline: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """The silhouette in the form of the network's input."""
    told, chance = outline * np.uint8(255), rng.random()
    if chance < UNTOLD_SHARE:
        told[:] = UNKNOWN
    elif chance < UNTOLD_SHARE + RAGGED_SHARE:
        told[_blots(int(rng.integers(6, 20)), rng) > rng.uniform(0.4, 1.2)] = 0
        if rng.random() < 0.5:
            told[_blots(10, rng) > 1.6] = 255
        if rng.random() < 0.3:
            (left, top), (wide, high) = (
                rng.integers(0, SIDE_PX, 2),
                rng.integers(SIDE_PX // 12, SIDE_PX // 2, 2),
            )
            told[top : top + high, left : left + wide] = 255
    return told


def _blots(few: int, rng: np.random.Generator) -> Vector:
    """(SIDE_PX, SIDE_PX) smooth noise with that many hills each way."""
    hills = rng.standard_normal((few, few), np.float32)
    return np.asarray(cv2.resize(hills, (SIDE_PX, SIDE_PX)))
