"""Silhouettes from a file: sequences of masks, the form of action databases."""

import zipfile
import zlib
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from common.bus.messages import View
from common.raster.silhouette_report import silhouette_view

MAX_PIXELS: Final = 1 << 30
"""Largest number of pixels of a sequence: 50,000 frames at 160x120."""
RATE_HZ: Final = 25.0
"""Frame rate of mask files, which record none; the databases were recorded for television."""
SHAPE: Final = "__shape"
"""Suffix of the array that holds a sequence's unpacked shape, after the sequence's name."""


class MaskFileError(ValueError):
    """A file of masks that cannot be used: the text names it and the cure."""


class MaskSequence(NamedTuple):
    """Silhouettes of one clip."""

    name: str
    reports: list[View]


def is_mask_file(path: Path) -> bool:
    """Whether an argument names masks: `FILE.npz`, or `FILE.npz#SEQUENCE`."""
    return path.name.partition("#")[0].endswith(".npz")


def read_masks(path: Path, rate_hz: float = RATE_HZ) -> MaskSequence:
    """A sequence of masks.

    Args:
        path: `FILE.npz`, where it holds one sequence, or `FILE.npz#SEQUENCE`. A sequence is an
            array of (n, H, W) masks, or of rows packed by numpy.packbits beside an array with its
            name and `__shape` that holds (n, H, W).
        rate_hz: Frames a second.

    Raises:
        MaskFileError: When it does not exist, or is no sequence of masks.
    """
    file_name, _, wanted = str(path).partition("#")
    try:
        with np.load(file_name, allow_pickle=False) as arrays:
            names = [name for name in arrays.files if not name.endswith(SHAPE)]
            name = wanted or (names[0] if len(names) == 1 else "")
            if name not in names:
                some = ", ".join(names[:4])
                raise MaskFileError(
                    f"{file_name} has {len(names)} sequences ({some} ...), none is {wanted!r}: "
                    f"name one as {file_name}#{names[0] if names else 'NAME'}"
                )
            masks = _unpacked(arrays, name, file_name)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        if isinstance(error, MaskFileError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise MaskFileError(
            f"cannot read the masks {file_name}: {reason}; name an .npz of packed masks"
        ) from error
    reports = [silhouette_view(1, mask, i, i / rate_hz) for i, mask in enumerate(masks)]
    return MaskSequence(wanted or Path(file_name).stem, reports)


def _unpacked(arrays: Any, name: str, file_name: str) -> Any:
    masks = arrays[name]
    if name + SHAPE in arrays.files:
        shape = tuple(int(n) for n in arrays[name + SHAPE].ravel())
        due = len(shape) == 3 and masks.dtype == np.uint8 and masks.ndim == 3
        if not due or masks.shape != (shape[0], shape[1], (shape[2] + 7) // 8):
            raise MaskFileError(f"{file_name}: {name} is {masks.shape}, no packed masks of {shape}")
        masks = np.unpackbits(masks, axis=2, count=shape[2])
    if masks.ndim != 3 or not all(masks.shape) or masks.size > MAX_PIXELS:
        raise MaskFileError(f"{file_name}: {name} has shape {masks.shape}, not frames x H x W")
    return masks.astype(np.bool_)
