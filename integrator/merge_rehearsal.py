"""Made-up reports, merged once, so that all is compiled and loaded before the first real ones."""

from typing import Final

import numpy as np

from common.body import POSE_INDEX, rest_pose
from common.camera import Rig, paper_rig
from common.config import Settings
from common.kernel import draw_body, view_of
from common.messages import Box, Report, ViewerNumber
from common.proportions import body_vector, thesis_bdp
from common.wire import pack
from integrator import merge
from integrator.pairing import Pair

VIEWERS: Final[tuple[ViewerNumber, ...]] = (1, 2)


def rehearse(settings: Settings, size: tuple[int, int]) -> None:
    """Merge three pairs of reports of somebody who stands, in a calibrated room and in another.

    Args:
        settings: Of the run.
        size: (width, height) of the working picture.
    """
    known = _rig(size)
    for rig in (known, None):
        state = merge.init(rig, 1.0, settings)
        for index in range(3):
            first, second = (_report(viewer, index, size, known) for viewer in VIEWERS)
            state, _, _ = merge.step(state, Pair(first, second))


def _rig(size: tuple[int, int]) -> Rig:
    return paper_rig(size, (1.25 * size[0],) * 2, (4.5, 4.5))


def _report(viewer: ViewerNumber, index: int, size: tuple[int, int], rig: Rig) -> Report:
    width, height = size
    pose = rest_pose()
    pose[POSE_INDEX["y"]] = 1.0
    view = view_of(rig.cameras[viewer - 1])
    mask = draw_body(body_vector(thesis_bdp(1.75)), pose, view, size)
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return Report(
        frame=index,
        captured_s=float(index),
        clock_s=float(index),
        viewer=viewer,
        width=width,
        height=height,
        silhouette=pack(mask),
        box=Box(int(columns[0]), int(columns[-1]), int(rows[0]), int(rows[-1])),
        root_px=(width / 2, height / 2),
    )
