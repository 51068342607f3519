"""Joints proposed from both silhouettes of one instant, by a network taught on made-up people."""

import math
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body import Vector
from common.camera import Camera, Rig
from integrator.perspective import triangulate

Mask = NDArray[np.bool_]

ROWS, COLUMNS = 48, 40
"""Cells of the window that is looked at in each view."""
UP, DOWN, ASIDE = 0.75, 0.63, 0.56
"""How far the window reaches from the middle of the silhouette, in statures: raised arms above,
feet below, stretched arms aside."""

JOINTS: Final = tuple(
    f"{side}_{name}"
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    for side in "lr"
)
"""What is proposed."""
SHOULDERS, HIPS = slice(0, 2), slice(6, 8)
HIPS_OFF: Final = (0.0, 0.009, 0.020)
"""How far left, up and before the true hips of r01 and r04 the network finds them, in statures:
made-up people have their hips nearer to the front of their outline."""

MIRRORED: Final = [i ^ 1 for i in range(len(JOINTS))]

ACROSS_DEG: Final = 12.0
"""How far two cameras may be from looking at right angles."""


SHIPPED: Final = Path(__file__).with_name("proposals.npz")


class Look(NamedTuple):
    """What both views show, and where that is."""

    cells: NDArray[np.float32]
    """(INPUTS,)"""
    middle_m: Vector
    """(3,) of the body, world."""
    turn: Vector
    """(3, 3) rows: the axes of the frame of the proposal in the world."""
    mirrored: bool


class Network(NamedTuple):
    """Weights of a perceptron of three layers on principal components."""

    mean: NDArray[np.float32]
    components: NDArray[np.float32]
    weights: tuple[NDArray[np.float32], ...]
    biases: tuple[NDArray[np.float32], ...]


INPUTS: Final = 2 * ROWS * COLUMNS + 6


def axes_of(rig: Rig) -> Vector | None:
    """Axes of the proposals' frame, rows (3, 3): x right in camera 1, y up, z towards it.

    None for cameras that do not look at right angles, level, camera 2 along +x.
    """
    first, second = (np.array(camera.R)[2] for camera in rig.cameras)
    backward = -np.array([first[0], 0.0, first[2]])
    size = float(np.linalg.norm(backward))
    if size < math.cos(math.radians(2 * ACROSS_DEG)):
        return None
    backward /= size
    right = np.array([backward[2], 0.0, -backward[0]])
    if float(second @ right) < math.cos(math.radians(ACROSS_DEG)):
        return None
    return np.stack([right, [0.0, 1.0, 0.0], backward])


def look(masks: tuple[Mask, Mask], rig: Rig, stature_m: float, facade: int) -> Look | None:
    """Both silhouettes as the network wants them; None where it was not taught to look.

    Args:
        masks: Of both views, (H, W), neither empty.
        rig: Two cameras.
        stature_m: Of the person.
        facade: 0 or 1: which view sees the facade. With 1 all is mirrored, so that it is as
            with 0.
    """
    turn = axes_of(rig)
    if turn is None:
        return None
    middles = (_middle(masks[0]), _middle(masks[1]))
    middle_m = triangulate((rig.cameras[0], rig.cameras[1]), middles)
    parts, places = [], []
    for mask, camera in zip(masks, rig.cameras, strict=True):
        cells, place = _cells(mask, camera, middle_m, stature_m)
        parts.append(cells[:, ::-1] if facade else cells)
        places.append(place * ([-1.0, 1.0, 1.0] if facade else [1.0, 1.0, 1.0]))
    if facade:
        parts.reverse()
        places.reverse()
    cells = np.concatenate([*(part.ravel() for part in parts), *places])
    return Look(cells.astype(np.float32), middle_m, turn, bool(facade))


def _middle(mask: Mask) -> tuple[float, float]:
    columns, rows = mask.sum(axis=0), mask.sum(axis=1)
    area = columns.sum()
    return (
        float(columns @ np.arange(0.5, len(columns)) / area),
        float(rows @ np.arange(0.5, len(rows)) / area),
    )


def _cells(
    mask: Mask, camera: Camera, middle_m: Vector, stature_m: float
) -> tuple[NDArray[np.float64], Vector]:
    """How much of each cell is covered, (ROWS, COLUMNS); where the window is in the picture."""
    at = np.array(camera.R) @ middle_m + np.array(camera.t)
    K = np.array(camera.K)
    scale = stature_m / at[2]
    sums = cv2.integral(mask.astype(np.uint8))
    u = K[0, 0] * (at[0] / at[2] + scale * np.linspace(-ASIDE, ASIDE, COLUMNS + 1)) + K[0, 2]
    v = K[1, 1] * (at[1] / at[2] + scale * np.linspace(-UP, DOWN, ROWS + 1)) + K[1, 2]
    lines = _between(_between(sums.astype(np.float64), v).T, u).T
    covered = np.diff(np.diff(lines, axis=0), axis=1)
    cell_px = (u[1] - u[0]) * (v[1] - v[0])
    return covered / cell_px, np.array([at[0] / at[2], at[1] / at[2], scale])


def _between(table: NDArray[np.float64], at: Vector) -> NDArray[np.float64]:
    """Rows of a table at places between them."""
    inside = np.clip(at, 0.0, len(table) - 1.0)
    low = np.minimum(inside.astype(int), len(table) - 2)
    share = (inside - low)[:, None]
    return table[low] * (1.0 - share) + table[low + 1] * share


@lru_cache(maxsize=1)
def shipped() -> Network:
    """The network that is installed with the program."""
    return load(SHIPPED)


def load(path: Path) -> Network:
    """Read a network that `save` wrote."""
    with np.load(path, allow_pickle=False) as file:
        layers = sum(name.startswith("weights") for name in file.files)
        return Network(
            file["mean"].astype(np.float32),
            file["components"].astype(np.float32),
            tuple(file[f"weights{i}"].astype(np.float32) for i in range(layers)),
            tuple(file[f"biases{i}"].astype(np.float32) for i in range(layers)),
        )


def save(network: Network, path: Path) -> None:
    """Write a network, in half precision: finer than it was learnt."""
    parts = {"mean": network.mean, "components": network.components}
    for i, (weights, biases) in enumerate(zip(network.weights, network.biases, strict=True)):
        parts |= {f"weights{i}": weights, f"biases{i}": biases}
    halves: dict[str, Any] = {name: part.astype(np.float16) for name, part in parts.items()}
    with path.open("wb") as file:
        np.savez(file, **halves)


def run(network: Network, cells: NDArray[np.float32]) -> NDArray[np.float32]:
    """Outputs (n, 3 * joints) for inputs (n, INPUTS)."""
    values: Any = (cells - network.mean) @ network.components
    for weights, bias in zip(network.weights[:-1], network.biases[:-1], strict=True):
        values = (values @ weights + bias).clip(min=0.0)
    out: NDArray[np.float32] = values @ network.weights[-1] + network.biases[-1]
    return out


def proposed(network: Network, seen: Look, stature_m: float) -> NDArray[np.float64]:
    """The joints, (12, 3), world metres."""
    out = run(network, seen.cells[None])[0].reshape(-1, 3).astype(np.float64)
    return placed(out, seen, stature_m)


def placed(out: NDArray[np.float64], seen: Look, stature_m: float) -> NDArray[np.float64]:
    """What the network says, (12, 3) statures from the middle, as world metres."""
    if seen.mirrored:
        out = swapped(out)
    return seen.middle_m + stature_m * out @ seen.turn


def aimed(joints_m: NDArray[np.float64], seen: Look, stature_m: float) -> NDArray[np.float64]:
    """What the network should say: the reverse of `placed`."""
    out: NDArray[np.float64] = (joints_m - seen.middle_m) @ seen.turn.T / stature_m
    return swapped(out) if seen.mirrored else out


def swapped(out: NDArray[np.float64]) -> NDArray[np.float64]:
    """A pose as the mirror between the cameras shows it: x for -z, and left for right."""
    return (out * [-1.0, 1.0, -1.0])[MIRRORED][:, [2, 1, 0]]
