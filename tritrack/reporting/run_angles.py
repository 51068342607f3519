"""The angles of a run, as courses for its pages."""

from typing import Final

import numpy as np

from animator.clinical.clinical_angles import NAMES
from animator.clinical.clinical_run import ClinicalRun, clinical_run
from animator.report.report_page import AngleCourse
from common.npz_file import Arrays

SHOWN: Final = {
    "hip_flexion": "hip flexion",
    "hip_adduction": "hip adduction",
    "hip_rotation": "hip rotation inwards",
    "knee_angle": "knee flexion",
    "ankle_angle": "ankle dorsiflexion",
    "arm_flex": "shoulder flexion",
    "arm_add": "shoulder adduction",
    "arm_rot": "shoulder rotation inwards",
    "shoulder_elv": "arm elevation",
    "elbow_flex": "elbow flexion",
    "pelvis_tilt": "trunk tilt backwards",
    "pelvis_list": "trunk list to the right",
    "pelvis_rotation": "turned to the left",
    "lumbar_bending": "trunk bending to the right",
    "lumbar_rotation": "trunk rotation to the left",
}
"""The charts in their order: name in files, and in words."""
SIDES: Final = {"left": "_l", "right": "_r", "trunk": ""}
"""By the look of a curve, the ending of an angle's name."""


def courses_of(poses: Arrays) -> list[AngleCourse]:
    """The clinical angles of a run's rows, with their bands."""
    run = clinical_run(poses)
    return [_course(run, name, title) for name, title in SHOWN.items()]


def _course(run: ClinicalRun, name: str, title: str) -> AngleCourse:
    at = {look: f"{name}{end}" for look, end in SIDES.items() if f"{name}{end}" in NAMES}
    column = {look: NAMES.index(own) for look, own in at.items()}
    return AngleCourse(
        title,
        name,
        {look: run.angles_deg[:, n] for look, n in column.items()},
        {look: tuple(np.moveaxis(run.bands_deg[:, n, ::-1], 1, 0)) for look, n in column.items()},
    )
