"""Synthetic frames that compile and load everything before the first real one."""

import msgspec
import numpy as np

from common.body.body import POSE_INDEX, rest_pose
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import MOST_VIEWS, Guide
from common.raster.kernel import draw_body
from viewer import track
from viewer.background.image_stack import median, squares
from viewer.captured_frame import CapturedFrame
from viewer.paper.posed_model import view_at
from viewer.silhouette import silhouette


def warm_up(state: track.State, size: tuple[int, int]) -> None:
    """Step through four frames of a person in the opening posture: without a guide, with one, with
    a known body, with a request for the stick body.

    Args:
        state: The initial state; not changed.
        size: (width, height) of the working picture.
    """
    silhouette.warm()
    squares(median(state.silhouette.model.centre[None])[None])  # for an occupied opening
    width, height = size
    view = view_at(state.search.rotation, 0.7 * height, (width / 2, 0.55 * height))
    pose = rest_pose()
    pose[POSE_INDEX["r_shoulder_z"]], pose[POSE_INDEX["l_shoulder_z"]] = 90.0, 270.0
    person = draw_body(body_vector(thesis_bdp(1.0)), pose, view, size)
    background = np.clip(state.silhouette.model.centre, 0, 255).astype(np.uint8)
    picture = np.where(person[:, :, None], 255 - background, background).astype(np.uint8)
    guide = Guide(
        frame=0,
        captured_s=0.0,
        clock_s=0.0,
        frames=(0,) * MOST_VIEWS,
        status="tracking",
        bdp=thesis_bdp(1.0),
        facing=("facade", "flank") * (MOST_VIEWS // 2),
        scale_px_per_m=(0.7 * height,) * MOST_VIEWS,
        root_px=((width / 2, 0.55 * height),) * MOST_VIEWS,
        rest_row_px=(0.0,) * MOST_VIEWS,
        moves=(False,) * MOST_VIEWS,
        pose=tuple(pose.tolist()),
    )
    measured = msgspec.structs.replace(guide, measured=True)
    asked = msgspec.structs.replace(measured, stick=True)
    for index, given in enumerate((None, guide, measured, asked)):
        unlike = picture ^ np.uint8(index % 2)  # otherwise the camera would seem frozen
        state, _ = track.step(state, CapturedFrame(index, 0.0, 0.0, unlike), given)
