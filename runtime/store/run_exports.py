"""Exports in a run folder: made from its poses, and removed when these are rewritten."""

import re
from pathlib import Path
from typing import Final, Literal

Format = Literal["bvh", "gltf", "fbx", "usd", "trc", "mot", "c3d", "csv", "angles"]
OWN_NAMES: Final[dict[Format, str]] = {
    "bvh": "body.bvh",
    "gltf": "body.glb",
    "fbx": "body.fbx",
    "usd": "body.usdc",
    "trc": "markers.trc",
    "mot": "body.mot",
    "c3d": "markers.c3d",
    "csv": "poses.csv",
    "angles": "angles.csv",
}
"""Default file name in the run folder, by format."""
EXPORTS: Final = (*OWN_NAMES.values(), "body.osim")
"""Including the model that belongs to OpenSim's motion."""
PAGES: Final = ("report.html", "compare.html", "overlay.mp4", "overlay.avi")
"""What is made of a run to look at."""


def name_of_person(path: Path, person: int) -> Path:
    """The file of one of several people: `body.bvh` is `body_person2.bvh`."""
    return path.with_stem(f"{path.stem}_person{person}")


def remove_exports(folder: Path) -> None:
    """Remove what was made of the run folder's previous poses: exports, those of each person among
    them, and pages.

    Raises:
        OSError: When a file cannot be removed.
    """
    for path in list(folder.iterdir()):
        if re.sub(r"_person[1-9]\d*(?=\.)", "", path.name) in (*EXPORTS, *PAGES):
            path.unlink(missing_ok=True)
