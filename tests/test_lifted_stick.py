"""Stick bodies of one view put into the world, held against the camera that saw them."""

from types import SimpleNamespace
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from staging import RIG

from common.rig.camera import centre, project
from integrator.single.lifted_stick import in_world

CAMERA = RIG.cameras[0]
PIXELS = np.random.default_rng(3).uniform((20.0, 10.0), (140.0, 110.0), (15, 2))
DEPTHS_M = np.linspace(-0.3, 0.3, 15)
"""How much nearer than the body's middle each joint is."""
PX_PER_M = 55.0


def lifted(as_printed: bool) -> np.ndarray:
    sight: Any = SimpleNamespace(camera=CAMERA, method=SimpleNamespace(stick_lifting=as_printed))
    joints_m = np.zeros((15, 3))
    joints_m[:, 2] = DEPTHS_M
    stick: Any = SimpleNamespace(joints_m=joints_m)
    return in_world(sight, PIXELS, stick, PX_PER_M)


def depths_m(places_m: np.ndarray) -> np.ndarray:
    return np.asarray((places_m - centre(CAMERA)) @ np.array(CAMERA.R)[2])


@pytest.mark.parametrize("as_printed", [True, False], ids=["thesis", "default"])
def test_joints_stand_at_the_depth_that_the_size_of_a_metre_tells(as_printed: bool) -> None:
    due_m = CAMERA.K[1][1] / PX_PER_M - DEPTHS_M
    assert depths_m(lifted(as_printed)) == pytest.approx(due_m)


def test_by_default_each_joint_is_shown_where_it_was_seen() -> None:
    assert project(CAMERA, lifted(False)) == pytest.approx(PIXELS)


def test_as_printed_all_rays_are_met_at_one_depth() -> None:
    """Scaled orthography (T19): joints lie as in the picture, however near they are."""
    across_m = (lifted(True) - centre(CAMERA)) @ np.array(CAMERA.R)[:2].T
    assert across_m == pytest.approx((PIXELS - np.array(CAMERA.K)[:2, 2]) / PX_PER_M)


def test_a_lens_that_bends_lines_is_undone_first() -> None:
    """Pixels by OpenCV's own projection of what stands there."""
    lens = (-0.25, 0.08, 0.002, -0.001, 0.0)
    camera = msgspec.structs.replace(CAMERA, distortion=lens)
    sight: Any = SimpleNamespace(camera=camera, method=SimpleNamespace(stick_lifting=False))
    stick: Any = SimpleNamespace(joints_m=np.stack([0 * DEPTHS_M, 0 * DEPTHS_M, DEPTHS_M], axis=1))
    found = in_world(sight, PIXELS, stick, PX_PER_M)
    own = np.array(camera.R) @ found.T + np.array(camera.t)[:, None]
    seen = cv2.projectPoints(own.T, np.zeros(3), np.zeros(3), np.array(camera.K), np.array(lens))
    assert seen[0][:, 0] == pytest.approx(PIXELS, abs=0.05)
