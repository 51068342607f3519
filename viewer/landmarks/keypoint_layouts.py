"""How pose estimators order a body's points, and the order in which ours are read off them."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.extremities import EXTREMITY_NAMES

BODY_POINTS: Final = (
    *("nose", "l_eye", "r_eye", "l_ear", "r_ear"),
    *("l_shoulder", "r_shoulder", "l_elbow", "r_elbow", "l_wrist", "r_wrist"),
    *("l_hip", "r_hip", "l_knee", "r_knee", "l_ankle", "r_ankle"),
)
"""COCO's 17 points, which every layout has."""
POINT: Final = {name: i for i, name in enumerate(BODY_POINTS)}

_COCO_17: Final = tuple(range(17))
_BODY_25: Final = (0, 16, 15, 18, 17, 5, 2, 6, 3, 7, 4, 12, 9, 13, 10, 14, 11)
_COCO_18: Final = (0, 15, 14, 17, 16, 5, 2, 6, 3, 7, 4, 11, 8, 12, 9, 13, 10)
_MEDIAPIPE: Final = (0, 2, 5, 7, 8, 11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28)

LAYOUTS: Final = {17: _COCO_17, 18: _COCO_18, 25: _BODY_25, 26: _COCO_17, 33: _MEDIAPIPE}
"""By how many points a layout has: where it has BODY_POINTS. 17 is COCO's, 18 OpenPose's COCO, 25
its BODY_25, 26 HALPE's, whose first are COCO's, 33 MediaPipe's."""


EXTREMITIES: Final[dict[int, tuple[tuple[int, ...], ...]]] = {
    17: ((0,), (), (), (), (), (), ()),
    18: ((0,), (), (), (), (), (), ()),
    25: ((0,), (21,), (19,), (), (24,), (22,), ()),
    26: ((0,), (24,), (20,), (), (25,), (21,), ()),
    33: ((0,), (29,), (31,), (17, 19), (30,), (32,), (18, 20)),
}
"""By how many points a layout has: those whose middle is each of EXTREMITY_NAMES. Of MediaPipe's
hands the knuckles of index and little finger."""


def extremity_points(points: NDArray[np.floating]) -> NDArray[np.float64]:
    """The places of EXTREMITY_NAMES, (7, 3), among the points of any layout, (n, 3), whose last
    column says how sure each is; what a layout lacks is sure to 0."""
    found = np.zeros((len(EXTREMITY_NAMES), 3))
    for i, at in enumerate(EXTREMITIES[len(points)]):
        if at:
            own = points[list(at)].astype(np.float64)
            found[i] = (*own[:, :2].mean(axis=0), own[:, 2].min())
    return found


def body_points(points: NDArray[np.floating]) -> NDArray[np.float64]:
    """The 17 points of BODY_POINTS, (17, k), among those of any layout, (n, k)."""
    return points[list(LAYOUTS[len(points)])].astype(np.float64)
