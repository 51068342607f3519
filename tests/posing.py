"""What the tests of the tracking stages share: bodies, and how a viewer sees them."""

from common.body.body import POSE_INDEX, Vector, rest_pose
from common.body.observation import Box
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import ViewerNumber
from common.raster.kernel import draw_body
from common.raster.silhouette_report import box_of
from common.raster.similarity import Mask
from viewer.paper.posed_model import PosedModel, model_over, rotation_of, view_at

BODY = body_vector(thesis_bdp(1.0))
"""The thesis's proportions at stature 1: drawn at 100 px a unit, a model of 100 rows."""
SIZE = (160, 120)
ROOT_PX = (80.0, 64.0)
PX = 100.0


def posed(**angles_deg: float) -> Vector:
    """A standing body with hanging arms and some angles set."""
    pose = rest_pose()
    for name, angle_deg in angles_deg.items():
        pose[POSE_INDEX[name]] = angle_deg
    return pose


def stretched(**angles_deg: float) -> Vector:
    """The opening posture: arms out to the sides."""
    return posed(**{"r_shoulder_z": 90.0, "l_shoulder_z": 270.0, **angles_deg})


def angle(model: PosedModel, name: str) -> float:
    return float(model.pose[POSE_INDEX[name]])


def view(viewer: ViewerNumber, root_px: tuple[float, float] = ROOT_PX, px: float = PX) -> Vector:
    """The paper's camera 1 or 2, the navel at a pixel."""
    return view_at(rotation_of(None, viewer), px, root_px)


def picture(
    pose: Vector,
    viewer: ViewerNumber = 1,
    body: Vector = BODY,
    root_px: tuple[float, float] = ROOT_PX,
    size: tuple[int, int] = SIZE,
) -> Mask:
    """The silhouette that a viewer has of a posed body."""
    return draw_body(body, pose, view(viewer, root_px), size)


def laid_over(
    mask: Mask, pose: Vector, viewer: ViewerNumber = 1, body: Vector = BODY
) -> PosedModel:
    """A model in a pose, where `picture` puts it, laid over a silhouette."""
    return model_over(mask, body, pose, view(viewer))


def box_around(mask: Mask) -> Box:
    """The boundary of a silhouette that is not empty."""
    box = box_of(mask)
    assert box is not None
    return box
