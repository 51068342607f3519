"""Looks of the network of landmarks: its file, its logits of a window, two looks as one."""

import os
import threading
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import OTHER_SIDE
from common.config.part_settings import SettingsError
from viewer.landmarks.landmark_window import PLANES, SIDE, Planes

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

CELLS: Final = 48
"""Cells of a joint's map, each way."""
BINS: Final = 16
"""Number of directions that a facing is classified into."""
OWN: Final = "own"
"""What settings call the network in the package."""
SHIPPED: Final = Path(__file__).with_name("landmarks.onnx")
LEAST: Final = 1e-12
"""Of a share of a map, where two looks are joined."""
OUTPUTS: Final = ("maps", "told", "mask")
EXACT: Final = "session.x64quantprecision"
"""What tells onnxruntime to multiply bytes without saturation on processors that lack VNNI: sums of
two products overflow 16 bits there, and the detector of people then sees no one. Where there is
VNNI it changes nothing."""
_READING: Final = threading.Lock()
Logits = NDArray[np.float32]
Seen = tuple[Logits, Logits, Logits]
"""Logits of a look: maps (15, CELLS, CELLS), the outputs of no place (BINS + 1 + 15,), and the
person's mask (CELLS, CELLS)."""


def opened(network: Path = SHIPPED) -> "InferenceSession":
    """A network, on one core; read once, whichever thread asks for it first.

    onnxruntime would report its use to its maker, and keep a file for it, unless it is set not to
    before it is imported: nothing leaves this machine.

    Args:
        network: A file that `tritrack train --what landmarks` wrote.
    """
    with _READING:
        return _read(network)


@lru_cache(maxsize=4)
def _read(network: Path) -> "InferenceSession":
    os.environ["ORT_DISABLE_TELEMETRY"] = "1"
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.add_session_config_entry(EXACT, "1")
    return onnxruntime.InferenceSession(network, options, providers=["CPUExecutionProvider"])


def network_of(landmarks: str) -> Path:
    """The file of the network that a run's settings name."""
    return SHIPPED if landmarks == OWN else Path(landmarks)


def refuse_no_network(landmarks: str) -> None:
    """Say that a file is no network of ours.

    Raises:
        SettingsError: With its name.
    """
    try:
        session = opened(network_of(landmarks))
        (taken,) = session.get_inputs()
        known = (taken.name, taken.shape) == ("planes", [1, PLANES, SIDE, SIDE])
        known &= tuple(each.name for each in session.get_outputs()) == OUTPUTS
    except Exception as error:  # whatever keeps a foreign file from its work is for the user
        raise SettingsError(f"{landmarks} is no network: {error}") from error
    if not known or taken.type != "tensor(uint8)":
        raise SettingsError(
            f"{landmarks} is no network of landmarks of this version: "
            "tritrack train --what landmarks writes one"
        )


def seen(planes: Planes, network: Path) -> Seen:
    """What a network says of a window, (1, PLANES, SIDE, SIDE)."""
    maps, told, mask = opened(network).run(None, {"planes": planes})
    return maps[0], told[0], mask[0]


def seen_twice(planes: Planes, network: Path) -> Seen:
    """The same of a window and of its mirror image, as one."""
    mirrored = np.ascontiguousarray(planes[..., ::-1])
    return _joined(seen(planes, network), _turned(*seen(mirrored, network)))


def _turned(maps: Logits, told: Logits, mask: Logits) -> Seen:
    """What was seen in the mirror, as it is before it: left is right there."""
    bins, nobody, sure = np.split(told, (BINS, BINS + 1))
    own = bins[-np.arange(BINS) % BINS], nobody, sure[OTHER_SIDE]
    return maps[OTHER_SIDE][..., ::-1], np.concatenate(own), mask[..., ::-1]


def _joined(first: Seen, second: Seen) -> Seen:
    """Two looks as one: the mean of the shares of maps, and of the logits of all else."""
    shares = [np.exp(maps - _total(maps)) for maps, _, _ in (first, second)]
    maps = np.log(np.maximum(0.5 * (shares[0] + shares[1]), np.float32(LEAST)))
    return maps, 0.5 * (first[1] + second[1]), 0.5 * (first[2] + second[2])


def _total(maps: Logits) -> Logits:
    """(15, 1, 1) by how much the logits of each map are too large to be those of shares."""
    best = maps.max(axis=(1, 2), keepdims=True)
    return best + np.log(np.exp(maps - best).sum(axis=(1, 2), keepdims=True))
