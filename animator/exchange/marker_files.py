"""TRC and C3D: the joints of a run as markers, for movement laboratories."""

import tempfile
from pathlib import Path
from typing import Any, Final

import numpy as np

from animator.exchange import LibraryMissing
from animator.skeleton.bones import Joints
from common.body.body import Vector
from common.body.extremities import ALL_JOINT_NAMES

MM_IN_M: Final = 1000.0
MOST_C3D_FRAMES: Final = 65_535
"""Largest number of frames: the format counts them in 16 bits, and programs silently read no
more."""
INVALID: Final = -1.0
"""Residual that marks a point as not seen."""
TO_FORWARD_X: Final = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""From a run's axes (+x left of a person who faces camera 1, +y up, +z towards it) to OpenSim's
(+x forward, +y up, +z right): a quarter turn about the vertical."""


def forward_x(places_m: Vector) -> Vector:
    """Places (..., 3) of a run in OpenSim's axes."""
    turned: Vector = places_m @ TO_FORWARD_X.T
    return turned


def trc_text(joints_m: Joints, step_s: float, name: str) -> str:
    """A TRC file: the joints as markers of the same names, mm, OpenSim's axes.

    Args:
        joints_m: (n, 15, 3) or (n, 22, 3) in even steps; unknown ones are NaN, "nan" in the file:
            OpenSim writes it so, and refuses rows that end in an empty cell.
        step_s: Seconds per frame.
        name: Name of the file, which its first line repeats.
    """
    rate_hz, frames, markers = f"{1.0 / step_s:.6f}", len(joints_m), joints_m.shape[1]
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits"
        "\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate_hz}\t{rate_hz}\t{frames}\t{markers}\tmm\t{rate_hz}\t1\t{frames}",
        "Frame#\tTime\t" + "\t".join(f"{joint}\t\t" for joint in ALL_JOINT_NAMES[:markers]),
        "\t\t" + "\t".join(f"{axis}{n}" for n in range(1, markers + 1) for axis in "XYZ"),
        "",
    ]
    places_mm = (MM_IN_M * forward_x(joints_m)).reshape(frames, -1)
    rows = (
        "\t".join([str(i + 1), f"{i * step_s:.6f}", *(f"{value:.3f}" for value in row.tolist())])
        for i, row in enumerate(places_mm)
    )
    return "\n".join([*head, *rows, ""])


def c3d_bytes(joints_m: Joints, step_s: float) -> bytes:
    """A C3D file: the joints as points of the same names, mm, OpenSim's axes.

    Args:
        joints_m: (n, 15, 3) or (n, 22, 3) in even steps, at most MOST_C3D_FRAMES; unknown ones are
            NaN, an invalid point in the file.
        step_s: Seconds per frame.

    Raises:
        LibraryMissing: Without ezc3d.
    """
    try:
        import ezc3d
    except ImportError as error:
        raise LibraryMissing("C3D needs ezc3d: pip install 'tritrack[export]'") from error
    places_mm = MM_IN_M * forward_x(joints_m)
    points = np.ones((4, joints_m.shape[1], len(joints_m)))
    points[:3] = places_mm.transpose(2, 1, 0)
    content: Any = ezc3d.c3d()
    content["parameters"]["POINT"]["RATE"]["value"] = [1.0 / step_s]
    content["parameters"]["POINT"]["LABELS"]["value"] = list(ALL_JOINT_NAMES[: joints_m.shape[1]])
    content["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    content["data"]["points"] = points
    unseen = np.isnan(points[:1])
    content["data"]["meta_points"] = {
        "residuals": np.where(unseen, INVALID, 0.0),
        "camera_masks": np.zeros((7, *points.shape[1:]), np.bool_),
    }
    with tempfile.TemporaryDirectory() as folder:  # the library writes only to paths
        path = Path(folder) / "points.c3d"
        content.write(str(path))
        return path.read_bytes()
