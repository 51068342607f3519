"""A plot of a run's angles over time: a walk shows its steps (T26)."""

import io
from typing import Final

import numpy as np
from numpy.typing import NDArray

from animator.scene import LEFT, RIGHT
from common.npz_file import Arrays

SHOWN: Final = {
    "hip, forwards": "hip_x",
    "knee": "knee_x",
    "shoulder, forwards": "shoulder_x",
    "elbow": "elbow_x",
}
"""The angle of each row of the plot, for both sides."""
SIDES: Final = {"left": [each / 255 for each in LEFT], "right": [each / 255 for each in RIGHT]}
"""Their colours, as on every page and in every overlay."""


def angle_plot(poses: Arrays) -> bytes:
    """A PNG of the joints' angles.

    Args:
        poses: The arrays of `poses.npz`: `time_s`, `angles_deg`, `angle_names`.
    """
    from matplotlib.figure import Figure

    names = [str(name) for name in poses["angle_names"]]
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    rows = figure.subplots(len(SHOWN), sharex=True)
    for axes, (title, joint) in zip(rows, SHOWN.items(), strict=True):
        for side, colour in SIDES.items():
            angle_deg = poses["angles_deg"][:, names.index(f"{side[0]}_{joint}")]
            axes.plot(poses["time_s"], angle_deg, color=colour, label=side)
        axes.set(ylabel=f"{title}, deg")
        axes.grid(alpha=0.3)
    rows[0].legend(loc="upper right")
    rows[-1].set(xlabel="time, s", xlim=_span(np.asarray(poses["time_s"])))
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", dpi=100)
    return drawn.getvalue()


def _span(time_s: NDArray[np.float64]) -> tuple[float, float]:
    """From the first to the last moment; not empty even where these are one."""
    first, last = (float(time_s[0]), float(time_s[-1])) if len(time_s) else (0.0, 0.0)
    return first, max(last, first + 0.1)
