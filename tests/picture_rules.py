"""What a picture is against its background, pixel by pixel: the rules of the passes, in numpy."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from viewer.background.background import BackgroundModel

LUMA = np.array([0.114, 0.587, 0.299])
CELL = 4
Floats = NDArray[np.float64]


class Held(NamedTuple):
    """A picture against a background, pixel by pixel: the rules in doubles."""

    off: Floats
    """(H, W, 3) how it differs under this light."""
    total: Floats
    """(H, W) distance in spreads, squared."""
    unshaded: Floats
    """The same with soft shadows forgiven."""
    shades: NDArray[np.int64]


def held(frame: NDArray[np.uint8], model: BackgroundModel) -> Held:
    gain = model.gain.astype(float)
    due = np.minimum(model.centre * gain, 255.0)
    off = frame - due
    weight = model.weight.astype(float)
    luma = off @ LUMA
    colour = ((off - luma[..., None]) ** 2).sum(axis=-1) * weight[..., 1]
    total = luma**2 * weight[..., 0] + colour
    part = luma / np.maximum(due @ LUMA, 1.0)
    left = ((off - part[..., None] * due) ** 2).sum(axis=-1) * weight[..., 1]
    shaded = (part < 0.0) & (part > -0.3) & (left < 9.0)
    even = frame / gain
    bright = even @ LUMA
    blue, red = (even[..., c] - bright for c in (0, 2))
    shades = np.minimum(bright.astype(int) >> 5, 7) << 8
    for value, shift in ((blue, 4), (red, 0)):
        shades += np.clip((np.trunc(value).astype(int) + 64) >> 3, 0, 15) << shift
    return Held(off, total, np.where(shaded, np.minimum(left, total), total), shades)


def scene(seed: int) -> tuple[NDArray[np.uint8], BackgroundModel]:
    """Noise about a room, a shadow over the left, a thing at the right, and colours of a body."""
    rng = np.random.default_rng(seed)
    centre = rng.uniform(40, 255, (22, 27, 3)).astype(np.float32)
    spread = rng.uniform(1.0, 3.0, (22, 27, 2)).astype(np.float32)
    gain = np.array([0.9, 1.0, 1.1], np.float32)
    shown = np.minimum(centre * gain, 255.0) + rng.normal(0.0, 3.0, centre.shape)
    shown[:, :9] *= rng.uniform(0.6, 1.0, (22, 9, 1))
    shown[5:17, 20:] = rng.uniform(0, 255, 3)
    colours = rng.uniform(-1, 1, 1 << 11).astype(np.float32)
    model = BackgroundModel(centre, 1.0 / spread**2, gain, colours)
    return np.clip(np.rint(shown), 0, 255).astype(np.uint8), model
