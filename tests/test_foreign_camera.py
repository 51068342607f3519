"""Cameras between conventions: whose axis is up, and where pixels have their centres."""

import msgspec
import numpy as np
import pytest

from calibration.foreign.foreign_camera import axes_with_y_up, our_rig, with_z_up
from common.rig.camera import paper_rig
from common.rig.rig_file import CalibrationError

RIG = paper_rig((320, 240), (400.0, 410.0), (4.0, 4.2))


@pytest.mark.parametrize(
    "up", [(0.1, 0.9, 0.2), (0.1, -0.9, 0.2), (0.0, 0.2, 0.9), (0.3, 0.1, -0.8), (-0.9, 0.0, 0.1)]
)
def test_y_is_the_axis_nearest_to_up_and_the_axes_are_right_handed(
    up: tuple[float, float, float],
) -> None:
    turn = axes_with_y_up(np.array(up))
    axis = int(np.abs(up).argmax())
    assert turn[1, axis] == np.sign(up[axis])
    assert turn @ turn.T == pytest.approx(np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1.0)
    assert turn[2, (axis + 1) % 3] == 1.0


def test_there_and_back_again_is_the_same_rig() -> None:
    theirs = with_z_up(RIG)
    first = theirs[0]
    assert first.K[:2, 2].tolist() == [RIG.cameras[0].K[0][2] - 0.5, RIG.cameras[0].K[1][2] - 0.5]
    assert first.size_px == (320, 240)
    assert pytest.approx(np.array(RIG.cameras[0].R)[:, 1]) == first.R @ [0.0, 0.0, 1.0]
    back = our_rig(theirs, "x")
    assert (back.width, back.height) == (320, 240)
    for one, other in zip(back.cameras, RIG.cameras, strict=True):
        assert one.name == other.name
        for part in ("K", "R", "t"):
            assert np.array(getattr(one, part)) == pytest.approx(np.array(getattr(other, part)))
    assert msgspec.structs.replace(back, cameras=RIG.cameras) == RIG


def test_no_camera_and_pictures_of_two_shapes_are_told_with_the_cure() -> None:
    with pytest.raises(CalibrationError, match=r"x\.toml holds no camera in a form that is known"):
        our_rig([], "x.toml")
    first, second = with_z_up(RIG)
    other = second._replace(size_px=(640, 360))
    with pytest.raises(CalibrationError, match=r"cam1 320x240, cam2 640x360: choose with --camera"):
        our_rig([first, other], "x.toml")


def test_a_camera_of_another_size_is_scaled_to_the_first_ones() -> None:
    """Twice as large: a pixel's middle (x, y) of it is ((x + .5) / 2, (y + .5) / 2) of ours."""
    first, second = with_z_up(RIG)
    K = second.K.copy()
    K[:2] *= 2.0
    K[:2, 2] += 0.5
    rig = our_rig([first, second._replace(K=K, size_px=(640, 480))], "x.toml")
    assert (rig.width, rig.height) == (320, 240)
    for one, other in zip(rig.cameras, RIG.cameras, strict=True):
        assert np.array(one.K) == pytest.approx(np.array(other.K))
