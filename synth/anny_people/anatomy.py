"""The common parts of all Anny bodies: shapes, surface, bones."""

from functools import cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

if TYPE_CHECKING:
    import torch

TOPOLOGY: Final = "notoes"
"""Name of Anny's surface without toes."""
FINE: Final = (
    (("head", "neck03"), 0.008),
    (("wrist", "metacarpal", "finger"), 0.008),
    (("foot", "toe"), 0.012),
)
"""Prefixes of the bones where the surface is finer than a picture shows, and the size of a cell,
metres, whose vertices are merged."""


class NoAnny(Exception):
    """The package `anny` is not installed."""


class Anatomy(NamedTuple):
    """A surface on bones, and the model of its shapes."""

    model: "torch.nn.Module"
    """A torch module of the package."""
    kept: NDArray[np.int64]
    """(v,) indices of the vertices in use."""
    faces: NDArray[np.int64]
    """(f, 3) seen from outside anticlockwise."""
    weights: NDArray[np.float64]
    """(v, bones) skinning weights; each row sums to 1."""
    bones: tuple[str, ...]
    parents: tuple[int, ...]
    """Index of the parent bone, which comes earlier; -1 for the first one."""


@cache
def anatomy() -> Anatomy:
    """The model, loaded once per process.

    The package computes this surface's shapes at the first request, in a minute or two, and keeps
    them in `$ANNY_CACHE_DIR`, or else in the user's cache folder.

    Raises:
        NoAnny: Where the package is not installed.

    Source: Bregier et al. 2026, Human mesh modeling for Anny body; its shapes are MakeHuman's.
    """
    try:
        import anny
    except ImportError as error:
        raise NoAnny("Anny's people need its package: pip install 'tritrack[train]'") from error
    model = anny.Anny(topology=TOPOLOGY, phenotypes="all", skinning_method="lbs")
    bones, places = tuple(model.bone_labels), upright(model.template_vertices.numpy())
    weights = np.zeros((len(places), len(bones)))
    rows = np.arange(len(places))[:, None]
    np.add.at(weights, (rows, model.vertex_bone_indices.numpy()), model.vertex_bone_weights.numpy())
    strongest = np.array([_cell_m(name) for name in bones])[weights.argmax(axis=1)]
    kept, faces = _coarser(places, strongest, model.faces.numpy())
    return Anatomy(model, kept, faces, weights[kept], bones, tuple(model.bone_parents))


def upright(places: NDArray[np.float32]) -> NDArray[np.float64]:
    """Anny's axes (z up, facing -y) to ours (y up, facing z); x is the body's left in both."""
    return np.stack([places[:, 0], places[:, 2], -places[:, 1]], axis=1).astype(np.float64)


def _cell_m(bone: str) -> float:
    """Size of a cell whose vertices are merged; 0 where each of them stays."""
    return next((size for names, size in FINE if bone.startswith(names)), 0.0)


def _coarser(
    places: NDArray[np.float64], cells_m: Vector, faces: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The kept vertices, the middle one of each cell, and the faces between those."""
    keys = np.zeros((len(places), 4), np.int64)
    keys[:, 3] = np.arange(len(places))
    merged = cells_m > 0.0
    keys[merged] = 0
    keys[merged, :3] = np.floor(places[merged] / cells_m[merged, None]) + 10_000
    _, group = np.unique(keys, axis=0, return_inverse=True)
    group = group.reshape(-1)
    counts = np.bincount(group)
    middles = np.stack([np.bincount(group, places[:, k]) for k in range(3)], axis=1)
    off = np.linalg.norm(places - (middles / counts[:, None])[group], axis=1)
    nearest = np.lexsort((off, group))
    kept = nearest[np.searchsorted(group[nearest], np.arange(len(counts)))]
    found = group[faces]
    distinct = (found != np.roll(found, 1, axis=1)).all(axis=1)
    return kept, found[distinct]
