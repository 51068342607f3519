"""The angles of a run, as courses for its pages."""

from typing import Final

from animator.report.report_page import AngleCourse
from common.npz_file import Arrays

SHOWN: Final = {
    "hip, forwards": "hip_x",
    "knee": "knee_x",
    "shoulder, forwards": "shoulder_x",
    "elbow": "elbow_x",
}
"""The angle of each chart."""


def courses_of(poses: Arrays) -> list[AngleCourse]:
    """The angles of a run's rows."""
    names = [str(name) for name in poses["angle_names"]]
    return [
        AngleCourse(
            title,
            joint,
            {
                side: poses["angles_deg"][:, names.index(f"{side[0]}_{joint}")]
                for side in ("left", "right")
            },
            {},
        )
        for title, joint in SHOWN.items()
    ]
