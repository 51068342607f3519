"""The assumed rig, held against a pinhole: who stands there is as high as was assumed."""

import numpy as np
import pytest
from staging import observation

from common.body.observation import Box, Observation
from common.rig.camera import as_paper_rig, project
from integrator.rig.assumed_rig import FOCAL_SHARE, assumed_rig


def standing_person(viewer: int, top: int, bottom: int) -> Observation:

    return observation(box=Box(70, 90, top, bottom))


@pytest.mark.parametrize("stature_m", [1.5, 1.75])
def test_the_person_is_as_high_as_assumed_and_stands_on_the_floor(stature_m: float) -> None:
    """C1: rows 20 to 109 in view 1, 30 to 99 in view 2; the person stands at the origin."""
    rig = assumed_rig(standing_person(1, 20, 109), standing_person(2, 30, 99), stature_m)
    body = np.array([[0.0, 0.0, 0.0], [0.0, stature_m, 0.0]])
    for camera, (top, bottom) in zip(rig.cameras, ((20, 110), (30, 100)), strict=True):
        pixels = project(camera, body)
        assert pixels[:, 1] == pytest.approx([bottom, top])
        assert pixels[:, 0] == pytest.approx([80.0, 80.0])


def test_it_is_a_rig_of_the_papers_kind_with_a_lens_of_44_degrees() -> None:
    """C1: level cameras along -z and +x."""
    rig = assumed_rig(standing_person(1, 20, 109), standing_person(2, 30, 99), 1.75)
    paper = as_paper_rig(rig)
    assert paper is not None
    assert paper.focal_1_px == paper.focal_2_px == FOCAL_SHARE * 160
    assert paper.distance_1_m / paper.distance_2_m == pytest.approx(70 / 90)
    angle_deg = 2 * np.degrees(np.arctan(80 / paper.focal_1_px))
    assert angle_deg == pytest.approx(44.0, abs=1.0)


def test_one_camera_serves_for_both_where_there_is_one() -> None:
    only = standing_person(1, 20, 109)
    rig = assumed_rig(only, only, 1.75)
    assert rig.cameras[0].K == rig.cameras[1].K
    assert (rig.width, rig.height) == (160, 120)
