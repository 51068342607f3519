"""The names of our packages: ten at the top of a checkout, one in the wheel."""

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
"""The packages; `hatch_build.py` moves all of them into one in the wheel."""
ROOT: Final = Path(__file__).resolve().parents[__name__.count(".")]
"""The folder that holds PACKAGES: the checkout, or `site-packages`."""
