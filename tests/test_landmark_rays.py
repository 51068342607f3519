"""Landmarks as rays: through the camera and each joint, and nothing of a view that has none."""

import msgspec
import numpy as np
import pytest
from staging import RIG, observation

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks, Observation
from common.bus.messages import ViewerNumber
from common.rig.camera import centre, project
from integrator.landmarks.landmark_rays import AT, rays_of
from integrator.proposal.network_weights import JOINTS

rng = np.random.default_rng(5)
JOINTS_M, SECOND_M = rng.uniform(-0.5, 0.5, (2, 15, 3)) + np.array([0.0, 1.0, 0.0])
SURE, LESS = rng.uniform(0.1, 0.9, (2, 15))


def report(viewer: ViewerNumber, *, second: bool = False, landmarks: bool = True) -> Observation:
    """A view that sees these joints, and others where it may see them too."""
    camera = RIG.cameras[viewer - 1]
    shown = Landmarks(
        tuple(map(tuple, project(camera, JOINTS_M).tolist())),
        tuple(SURE.tolist()),
        facing_deg=10.0 * viewer,
        facing_confidence=0.3 * viewer,
    )
    if second:
        shown = msgspec.structs.replace(
            shown,
            second_px=tuple(map(tuple, project(camera, SECOND_M).tolist())),
            second_confidence=tuple(LESS.tolist()),
        )
    return observation(landmarks=shown if landmarks else None)


def towards(viewer: ViewerNumber, places_m: np.ndarray) -> np.ndarray:
    along = places_m[AT] - centre(RIG.cameras[viewer - 1])
    return np.asarray(along / np.linalg.norm(along, axis=1, keepdims=True))


def test_rays_lead_from_each_camera_through_the_twelve_joints() -> None:
    found = rays_of(RIG, (report(1), report(2, second=True)))
    assert found is not None
    assert [JOINT_NAMES[i] for i in AT] == list(JOINTS)
    for view, number in enumerate((1, 2)):
        assert found.centres_m[view] == pytest.approx(centre(RIG.cameras[view]))
        assert found.directions[view] == pytest.approx(towards(number, JOINTS_M), abs=1e-9)
        assert found.confidence[view] == pytest.approx(SURE[AT])
        assert found.rotations[view] == pytest.approx(np.array(RIG.cameras[view].R))
    assert found.others[1] == pytest.approx(towards(2, SECOND_M), abs=1e-9)
    assert found.others_confidence[1] == pytest.approx(LESS[AT])
    assert not found.others[0].any()
    assert not found.others_confidence[0].any()
    assert found.facing_deg == (10.0, 20.0)
    assert found.facing_confidence == pytest.approx((0.3, 0.6))


@pytest.mark.parametrize("blind", [None, report(1, landmarks=False)], ids=["nobody", "outline"])
def test_a_view_without_landmarks_says_nothing(blind: Observation | None) -> None:
    found = rays_of(RIG, (blind, report(2)))
    assert found is not None
    assert not found.confidence[0].any()
    assert not found.directions[0].any()
    assert found.confidence[1] == pytest.approx(SURE[AT])
    assert found.facing_confidence == pytest.approx((0.0, 0.6))
    assert rays_of(RIG, (blind, None)) is None
