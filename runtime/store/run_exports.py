"""What is exported beside a run: of its poses, and gone when they are written anew."""

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
"""The file in the run folder where no other is asked for."""
EXPORTS: Final = (*OWN_NAMES.values(), "body.osim")
"""With the model that goes with the motion of OpenSim."""


def remove_exports(folder: Path) -> None:
    """Remove what was exported of the poses that stood in a run folder before.

    Raises:
        OSError: When a file cannot be removed.
    """
    for name in EXPORTS:
        (folder / name).unlink(missing_ok=True)
