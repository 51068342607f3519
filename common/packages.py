"""Our packages by the names that they have here: ten in a checkout, one in the wheel."""

from pathlib import Path
from typing import Final

PACKAGES: Final = (
    ("tritrack",)
    if __name__.startswith("tritrack.")
    else (
        *("animator", "calibration", "common", "integrator", "lab"),
        *("recognizer", "runtime", "synth", "tritrack", "viewer"),
    )
)
"""Names at the top that are ours: `hatch_build.py` moves all of them below one."""
ROOT: Final = Path(__file__).resolve().parents[__name__.count(".")]
"""Folder of PACKAGES: the checkout, or `site-packages`."""
