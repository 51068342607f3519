"""The paper's search for the pose in one view: facing, position, arms, legs (section 3)."""

from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, rest_pose
from common.body.kinematics import ALL_LIMBS
from common.body.observation import Facing, Observation, Search
from common.body.proportions import body_vector, stature, thesis_bdp
from common.bus.messages import Guide, ViewerNumber, place_in_rig
from common.config.part_settings import SearchSettings
from common.method import Method
from common.raster.kernel import CENTRE_X, CENTRE_Y
from common.raster.similarity import Mask
from common.rig.camera import Camera
from viewer.expected_body import ExpectedBody, expected_body
from viewer.paper.arms import facade_arms, flank_arms
from viewer.paper.facing import thresholds_px, upper_body_px, vote
from viewer.paper.legs import facade_legs, flank_legs, squats
from viewer.paper.posed_model import PosedModel, model_over, rotation_of, view_at, yaw_of
from viewer.paper.position import UPRIGHT, located

SQUAT_ANGLES: Final = ("r_hip_x", "l_hip_x", "r_knee_x", "l_knee_x")
FACADE_ANGLES: Final = (
    "r_shoulder_y",
    "r_shoulder_z",
    "l_shoulder_y",
    "l_shoulder_z",
    "r_elbow_x",
    "l_elbow_x",
    "r_hip_z",
    "l_hip_z",
    *SQUAT_ANGLES,
)
FLANK_ANGLES: Final = ("r_shoulder_x", "l_shoulder_x", *SQUAT_ANGLES)


class Found(NamedTuple):
    """One view's own result for a frame."""

    facing: Facing
    """The facing that the search assumes."""
    angles_deg: dict[str, float]
    """The searched pose."""
    squatting: bool


class State(NamedTuple):
    """The state from one frame's search to the next."""

    viewer: ViewerNumber
    rotation: NDArray[np.float64]
    """World to camera, (3, 3)."""
    settings: SearchSettings
    method: Method
    vote: Facing
    """Facing that the view votes for."""
    found: Found | None = None
    """Result of the frame before; None: it had no person."""


def init(
    viewer: ViewerNumber, camera: Camera | None, settings: SearchSettings, method: Method
) -> State:
    """The initial state: viewer 1 starts as the facade, viewer 2 as the flank (P47)."""
    facing: Facing = "facade" if viewer == 1 else "flank"
    return State(viewer, rotation_of(camera, viewer), settings, method, facing)


def step(
    state: State, person: Observation, mask: Mask, guide: Guide | None
) -> tuple[State, Observation]:
    """The person of one silhouette with the pose found in it.

    Args:
        state: From `init` or the step before.
        person: The person without a pose.
        mask: (H, W) the silhouette.
        guide: The integrator's guide after the frame before; None at the start.
    """
    known = expected_body(guide, state.viewer)
    facing = state.vote if guide is None else guide.facing[place_in_rig(state.viewer)]
    if known is not None:
        model = _expected(state, mask, known, facing)
    else:
        model = _at_rest(state, mask, person, guide)
    state, width_px, limits_px = _voted(state, mask, model, known)
    model = located(model, UPRIGHT if state.method.armless_shift else ALL_LIMBS)
    model, squatting = _limbs(state, model, known, facing)
    names = FACADE_ANGLES if facing == "facade" else FLANK_ANGLES
    angles_deg = {name: float(model.pose[POSE_INDEX[name]]) for name in names}
    search = Search(
        (float(model.view[CENTRE_X]), float(model.view[CENTRE_Y])),
        angles_deg,
        squatting,
        float(model.score),
        model.matches,
    )
    person = msgspec.structs.replace(
        person,
        upper_body_px=width_px,
        vote=state.vote,
        thresholds_px=limits_px,
        search=search,
    )
    return state._replace(found=_found(facing, angles_deg, squatting)), person


def _found(facing: Facing, angles_deg: dict[str, float], squatting: bool) -> Found:
    """The start of a search: the facade searches theta_X of legs in squats alone (P33)."""
    if facing == "facade" and not squatting:
        angles_deg = {n: value for n, value in angles_deg.items() if n not in SQUAT_ANGLES}
    return Found(facing, angles_deg, squatting)


def _expected(state: State, mask: Mask, known: ExpectedBody, facing: Facing) -> PosedModel:
    """The model at its predicted place and pose.

    As printed each view starts from its own angles (L1): the fused pose has legs at rest wherever
    the facade lifts none (P53), and a search from there never finds a kick.
    """
    pose, before = np.array(known.pose), state.found
    pose[:3] = 0.0
    if before is not None and before.facing == facing and not state.method.shared_start:
        pose[[POSE_INDEX[name] for name in before.angles_deg]] = [*before.angles_deg.values()]
    view = view_at(state.rotation, known.scale_px_per_m, known.root_px)
    return model_over(mask, body_vector(known.bdp), pose, view)


def _at_rest(state: State, mask: Mask, person: Observation, guide: Guide | None) -> PosedModel:
    """The model at rest, fitted into the silhouette's box: its pose is unknown.

    The body of the guide if one was known before, else the thesis's proportions (T4).
    """
    bdp = thesis_bdp(1.0) if guide is None or guide.bdp is None else guide.bdp
    facing = state.vote if guide is None else guide.facing[place_in_rig(state.viewer)]
    sole = person.box.bottom + 1
    scale = (sole - person.box.top) / stature(bdp)
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]] = yaw_of(facing, state.viewer)
    columns = np.arange(mask.shape[1]) + 0.5
    middle = float(np.average(columns, weights=mask.sum(axis=0)))
    legs_px = (bdp.r_upper_leg.height + bdp.r_lower_leg.height) * scale
    view = view_at(state.rotation, scale, (middle, sole - legs_px))
    return model_over(mask, body_vector(bdp), pose, view)


def _voted(
    state: State, mask: Mask, model: PosedModel, known: ExpectedBody | None
) -> tuple[State, float, tuple[float, float]]:
    """W_u-body and this view's vote; without a guide the start's facing (P24-P26, P47)."""
    if known is None:
        return state, 0.0, (0.0, 0.0)
    torso_px = known.bdp.torso.height * known.scale_px_per_m
    width_px = upper_body_px(mask, float(model.view[CENTRE_Y]), torso_px)
    limits = thresholds_px(known.bdp, known.scale_px_per_m)
    return state._replace(vote=vote(known.facing, width_px, limits)), width_px, limits


def _limbs(
    state: State, model: PosedModel, known: ExpectedBody | None, facing: Facing
) -> tuple[PosedModel, bool]:
    """Arms, then legs, as visible in this facing (P30-P35)."""
    settings, method, wide = state.settings, state.method, known is None
    if facing == "facade":
        model = facade_arms(model, settings, wide, method)
        squatting = False
        if known is not None and known.measured:
            drop_m = (model.view[CENTRE_Y] - known.rest_row_px) / known.scale_px_per_m
            before = state.found is not None and state.found.squatting
            squatting = squats(before, float(drop_m) / stature(known.bdp))
        return facade_legs(model, settings, squatting), squatting
    near = 0 if state.rotation[0] @ [0.0, 0.0, 1.0] > 0.0 else 1
    model = flank_arms(model, settings, near, wide, method)
    return flank_legs(model, settings, near, method), False
