"""What the lifting network is told of landmarks, held against places worked out by hand."""

from typing import Any

import msgspec
import numpy as np
import pytest
from glass import in_mirror
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from rolling import ROLLED

from common.body.body import JOINT_NAMES, OTHER_SIDE, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.rig.camera import Camera, Rig, as_row, centre, paper_rig, project
from integrator.proposal.landmark_look import FACED, JOINTS, KNOWN, MIDDLE, STANDS, Shown, look
from integrator.proposal.silhouette_window import FAR_M, LONGEST_S, NEARNESS, USUAL_S, axes_of

TALL_M = 1.75
RIG = paper_rig((320, 240), (300.0, 300.0), (4.0, 5.0))
AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def somebody(x_m: float = 0.0, z_m: float = 0.0) -> NDArray[np.float64]:
    """Joints (15, 3) of who stands with the lower ankle as high as ankles are."""
    pose = rest_pose()
    pose[[POSE_INDEX[name] for name in "xz"]] = x_m, z_m
    found = joints(body_vector(thesis_bdp(TALL_M)), pose)
    found[:, 1] += 0.045 * TALL_M - found[:, 1].min()
    return np.asarray(found)


def shown_by(camera: Camera, joints_m: NDArray[np.float64], **changed: Any) -> Shown:
    """Exact landmarks, all sure."""
    seen = Shown(project(camera, joints_m), np.ones(JOINTS), 0.0, 1.0)
    return seen._replace(**changed)


def both(rig: Rig, joints_m: NDArray[np.float64]) -> tuple[Shown, Shown]:
    one, other = rig.cameras
    return shown_by(one, joints_m), shown_by(other, joints_m)


@given(st.floats(-0.8, 0.8), st.floats(-0.8, 0.8))
def test_where_both_see_the_middle_is_where_it_is(x_m: float, z_m: float) -> None:
    """The mean of four places in a picture is not the place of their mean: near it."""
    body_m = somebody(x_m, z_m)
    seen = look(both(RIG, body_m), RIG, TALL_M, 1 / 15)
    assert seen is not None
    assert seen.middle_m == pytest.approx(body_m[MIDDLE].mean(axis=0), abs=0.03)


@given(st.floats(-0.8, 0.8), st.floats(-1.5, 1.0), st.sampled_from([0, 1]))
def test_an_ankle_on_the_floor_says_how_far_away_somebody_is(
    x_m: float, z_m: float, view: int
) -> None:
    """From beside it is the nearer one, half a hip's breadth before the middle."""
    body_m, camera = somebody(x_m, z_m), RIG.cameras[view]
    views = (shown_by(camera, body_m), None)
    seen = look(views if view == 0 else views[::-1], RIG, TALL_M, 1 / 15)
    assert seen is not None
    assert seen.inputs[KNOWN - 1] == 1.0
    assert np.linalg.norm(seen.middle_m - body_m[MIDDLE].mean(axis=0)) < 0.2


def test_without_ankles_the_size_says_it_roughly() -> None:
    """Within half as far again: who stands with the arms down is less wide than others."""
    body_m, sure = somebody(), np.ones(JOINTS)
    sure[[AT["l_ankle"], AT["r_ankle"]]] = 0.1
    seen = look((shown_by(RIG.cameras[0], body_m, confidence=sure), None), RIG, TALL_M, 1 / 15)
    assert seen is not None
    assert seen.inputs[KNOWN - 1] == 0.0
    assert np.linalg.norm(seen.middle_m - body_m[MIDDLE].mean(axis=0)) < 2.0


@pytest.mark.parametrize(("rise_px", "firm"), [(0.0, 1.0), (40.0, 0.0)])
def test_forty_metres_off_an_ankle_counts_where_the_size_agrees(
    rise_px: float, firm: float
) -> None:
    """Of feet 40 pixels too high the floor would make 120 m, thrice what the size says."""
    camera = paper_rig((640, 480), (2600.0, 2600.0), (40.0, 40.0)).cameras[0]
    body_m = somebody(z_m=0.0)
    body_px = project(camera, body_m)
    body_px[[AT["l_ankle"], AT["r_ankle"]]] -= 0.0, rise_px
    shown = shown_by(camera, body_m, joints_px=body_px)
    seen = look((shown, None), Rig(640, 480, (camera, camera)), TALL_M, 0.1)
    assert seen is not None
    assert seen.inputs[KNOWN - 1] == firm
    assert seen.inputs[KNOWN - 2] == pytest.approx(NEARNESS * TALL_M / FAR_M - 1.0, abs=1e-3)
    assert np.linalg.norm(seen.middle_m - body_m[MIDDLE].mean(axis=0)) < (0.5 if firm else 20.0)


def test_joints_are_told_in_statures_right_of_the_middle_and_above_it() -> None:
    """A level camera 4 m away: what is in the plane of the middle is told as it is, twice."""
    body_m = somebody()
    body_m[:, 2] = 0.0
    seen = look((shown_by(RIG.cameras[0], body_m), None), RIG, TALL_M, 1 / 15)
    assert seen is not None
    told = seen.inputs[: 2 * JOINTS].reshape(-1, 2)
    due = 2.0 * (body_m - body_m[MIDDLE].mean(axis=0))[:, :2] / TALL_M
    assert told == pytest.approx(due, abs=0.03)
    away = centre(RIG.cameras[0]) - seen.middle_m
    assert seen.inputs[STANDS : STANDS + 3] == pytest.approx(
        seen.turn @ away / np.linalg.norm(away), abs=1e-6
    )


def test_confidence_and_facing_are_told_about_zero() -> None:
    sure = np.linspace(0.0, 1.0, JOINTS)
    shown = shown_by(
        RIG.cameras[0], somebody(), confidence=sure, facing_deg=90.0, facing_confidence=0.5
    )
    seen = look((shown, None), RIG, TALL_M, 1 / 15)
    assert seen is not None
    assert seen.inputs[2 * JOINTS : FACED] == pytest.approx(2.0 * sure - 1.0)
    assert seen.inputs[FACED:STANDS] == pytest.approx([0.0, 0.5, 0.0], abs=1e-6)


def test_which_way_somebody_faces_is_not_heard_of_who_lies() -> None:
    """It is said about the trunk there, not about the vertical."""
    body_m = somebody()
    lying_m = np.stack([body_m[:, 1] - 0.8, 0.1 + body_m[:, 0], body_m[:, 2]], axis=1)
    seen = look((shown_by(RIG.cameras[0], lying_m, facing_deg=40.0), None), RIG, TALL_M, 1 / 15)
    assert seen is not None
    assert seen.inputs[FACED:STANDS] == pytest.approx([0.0, 0.0, -1.0])


def test_what_is_told_does_not_depend_on_where_the_room_begins() -> None:
    """Two rolled cameras, all moved across the floor."""
    moved_m = np.array([3.0, 0.0, -7.0])
    cameras = tuple(
        msgspec.structs.replace(one, t=as_row(one.t - np.array(one.R) @ moved_m))
        for one in ROLLED.cameras
    )
    there = msgspec.structs.replace(ROLLED, cameras=cameras)
    here_m = somebody()
    one = look(both(ROLLED, here_m), ROLLED, TALL_M, 1 / 15)
    other = look(both(there, here_m + moved_m), there, TALL_M, 1 / 15)
    assert one is not None
    assert other is not None
    assert other.inputs == pytest.approx(one.inputs, abs=1e-4)
    assert other.middle_m == pytest.approx(one.middle_m + moved_m, abs=1e-6)


def test_a_room_in_a_mirror_is_told_as_the_room() -> None:
    """Left limbs are right ones there, and the frame is left-handed."""
    body_m = somebody(0.3, -0.2)
    body_m[AT["l_wrist"]] += [0.2, 0.4, 0.1]
    glass = in_mirror(RIG)
    beyond_m = (body_m * [-1.0, 1.0, 1.0])[OTHER_SIDE]
    one = look(both(RIG, body_m), RIG, TALL_M, 1 / 15)
    other = look(both(glass, beyond_m), glass, TALL_M, 1 / 15)
    assert one is not None
    assert other is not None
    assert other.mirrored != one.mirrored
    assert other.inputs == pytest.approx(one.inputs, abs=1e-5)


def test_two_that_look_apart_show_no_one_body() -> None:
    """What they show together is behind one of them, or at its lens."""
    first, second = both(RIG, somebody())
    apart = second._replace(joints_px=second.joints_px + np.array([4000.0, 0.0]))
    assert look((first, apart), RIG, TALL_M, 1 / 15) is None


def test_from_straight_above_nothing_is_told() -> None:
    """No way is up in such a picture."""
    K = ((300.0, 0.0, 160.0), (0.0, 300.0, 120.0), (0.0, 0.0, 1.0))
    R = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
    above = Camera("above", K, R, as_row(-np.array(R) @ [0.0, 4.0, 0.0]))
    shown = shown_by(above, somebody())
    shown.joints_px[MIDDLE] = 160.0, 120.0
    assert look((shown, None), Rig(320, 240, (above, above)), TALL_M, 1 / 15) is None


def test_each_view_says_how_near_it_is_and_how_long_ago_the_look_before_was() -> None:
    """Stature over distance, times NEARNESS, about 0; sixths of the longest gap that is told."""
    for tall_m in (1.0, TALL_M):
        seen = look(both(RIG, somebody()), RIG, tall_m, 2 * USUAL_S)
        assert seen is not None
        for n, camera in enumerate(RIG.cameras):
            far_m = np.linalg.norm(centre(camera) - seen.middle_m)
            assert seen.inputs[n * KNOWN + STANDS + 3] == pytest.approx(
                NEARNESS * tall_m / far_m - 1.0, abs=1e-6
            )
        assert seen.inputs[-2:].tolist() == [1.0, 1.0]
    late = look(both(RIG, somebody()), RIG, TALL_M, 99.0)
    assert late is not None
    assert late.inputs[-2] == pytest.approx(LONGEST_S / USUAL_S - 1.0)


def test_the_frame_is_camera_1s_where_both_see_and_that_of_the_view_that_is_alone() -> None:
    first, second = both(RIG, somebody())
    one, other = RIG.cameras
    for views, axes in (
        ((first, second), axes_of(one, other)),
        ((first, None), axes_of(one, one)),
        ((None, second), axes_of(other, other)),
    ):
        seen = look(views, RIG, TALL_M, 1 / 15)
        assert seen is not None
        assert seen.turn == pytest.approx(axes)
        assert seen.inputs[-1] == (1.0 if None not in views else 0.0)
