"""Exports in a run folder: made from its poses, and removed when these are rewritten."""

from pathlib import Path
from typing import Final, Literal

Format = Literal["bvh", "gltf", "usd", "trc", "mot", "c3d", "csv"]
OWN_NAMES: Final[dict[Format, str]] = {
    "bvh": "body.bvh",
    "gltf": "body.glb",
    "usd": "body.usdc",
    "trc": "markers.trc",
    "mot": "body.mot",
    "c3d": "markers.c3d",
    "csv": "poses.csv",
}
"""Default file name in the run folder, by format."""
EXPORTS: Final = (*OWN_NAMES.values(), "body.osim")
"""Including the model that belongs to OpenSim's motion."""


def remove_exports(folder: Path) -> None:
    """Remove the exports of the run folder's previous poses.

    Raises:
        OSError: When a file cannot be removed.
    """
    for name in EXPORTS:
        (folder / name).unlink(missing_ok=True)
