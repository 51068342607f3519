"""The orders of points, held against the names that their makers give them."""

import numpy as np
import pytest

from viewer.landmarks.keypoint_layouts import BODY_POINTS, LAYOUTS, body_points

BODY_25 = """Nose Neck RShoulder RElbow RWrist LShoulder LElbow LWrist MidHip RHip RKnee RAnkle LHip
    LKnee LAnkle REye LEye REar LEar LBigToe LSmallToe LHeel RBigToe RSmallToe RHeel"""
COCO_18 = """Nose Neck RShoulder RElbow RWrist LShoulder LElbow LWrist RHip RKnee RAnkle LHip
    LKnee LAnkle REye LEye REar LEar"""
COCO_17 = """Nose LEye REye LEar REar LShoulder RShoulder LElbow RElbow LWrist RWrist LHip RHip
    LKnee RKnee LAnkle RAnkle"""
HALPE_26 = COCO_17 + " Head Neck Hip LBigToe RBigToe LSmallToe RSmallToe LHeel RHeel"
MEDIAPIPE = """Nose LEyeInner LEye LEyeOuter REyeInner REye REyeOuter LEar REar LMouth RMouth
    LShoulder RShoulder LElbow RElbow LWrist RWrist LPinky RPinky LIndex RIndex LThumb RThumb LHip
    RHip LKnee RKnee LAnkle RAnkle LHeel RHeel LFootIndex RFootIndex"""


@pytest.mark.parametrize(
    "names", [BODY_25, COCO_18, COCO_17, HALPE_26, MEDIAPIPE], ids=[25, 18, 17, 26, 33]
)
def test_each_layout_is_told_by_its_count_and_read_by_its_makers_names(names: str) -> None:
    order = names.split()
    assert len(order) in LAYOUTS
    places = body_points(np.arange(len(order), dtype=np.float64)[:, None])[:, 0].astype(int)
    ours = [name.replace("_", "").lower() for name in BODY_POINTS]
    assert [order[place].lower() for place in places] == ours
