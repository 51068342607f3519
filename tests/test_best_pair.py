"""Which two views are taken, held against cameras around a person whose best pair is known."""

import numpy as np
import pytest
from staging import observation

from common.body.observation import Observation
from common.raster.similarity import Mask
from common.rig.camera import Camera, Rig, as_matrix, as_row
from integrator.rig.best_pair import best_pair, two_of

SIZE = (160, 120)


def camera(bearing_deg: float) -> Camera:
    """One that looks at the middle of the room from 4 m."""
    angle = np.radians(bearing_deg)
    place_m = np.array([4.0 * np.sin(angle), 1.0, 4.0 * np.cos(angle)])
    forward = np.array([0.0, 1.0, 0.0]) - place_m
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    R = np.stack([right, np.cross(forward, right), forward])
    K = ((150.0, 0.0, 80.0), (0.0, 150.0, 60.0), (0.0, 0.0, 1.0))
    return Camera(f"{bearing_deg:.0f}", K, as_matrix(R), as_row(-R @ place_m))


def rig(*bearings_deg: float) -> Rig:
    return Rig(*SIZE, tuple(map(camera, bearings_deg)))


SHAPE = (SIZE[1], SIZE[0])


def person(cut: bool = False) -> Mask:
    """An upright silhouette in the middle of a picture."""
    mask: Mask = np.zeros(SHAPE, np.bool_)
    mask[0 if cut else 30 : 95, 74:86] = True
    return mask


def seen(*views: str) -> tuple[Observation | None, ...]:
    """Of each view: `whole`, `cut` or `none`."""
    return tuple(
        None if view == "none" else observation(person(view == "cut"), cut=view == "cut")
        for view in views
    )


def test_the_two_cameras_of_a_rig_are_its_pair_whatever_they_see() -> None:
    assert best_pair((0, 1), rig(0, 90), seen("none", "cut")) == (0, 1)


@pytest.mark.parametrize(
    ("bearings_deg", "pair"),
    [((0, 20, 95), (0, 2)), ((0, 170, 80), (1, 2)), ((0, 40, 130, 200), (1, 2))],
)
def test_views_nearest_to_a_right_angle_are_the_pair(
    bearings_deg: tuple[float, ...], pair: tuple[int, int]
) -> None:
    views = ["whole"] * len(bearings_deg)
    assert best_pair(None, rig(*bearings_deg), seen(*views)) == pair


def test_the_pair_stays_while_both_of_its_views_see_the_whole_person() -> None:
    assert best_pair((0, 1), rig(0, 20, 95), seen("whole", "whole", "whole")) == (0, 1)


def test_a_view_that_loses_the_person_gives_its_place_to_one_that_does_not() -> None:
    around = rig(0, 90, 70)
    assert best_pair((0, 1), around, seen("whole", "none", "whole")) == (0, 2)
    assert best_pair((0, 1), around, seen("whole", "cut", "whole")) == (0, 2)


def test_where_the_person_is_half_outside_one_picture_an_oblique_view_is_worth_more() -> None:
    assert best_pair((0, 2), rig(0, 60, 90), seen("whole", "whole", "cut")) == (0, 1)
    assert best_pair((0, 2), rig(0, 5, 90), seen("whole", "whole", "cut")) == (0, 2)


def test_a_pair_that_is_hardly_worse_than_another_stays() -> None:
    """Both have a view that the person leaves; 60 degrees are worth .87 of 90."""
    around = rig(0, 60, 90)
    assert best_pair((0, 1), around, seen("cut", "whole", "whole")) == (0, 1)
    assert best_pair((0, 2), around, seen("cut", "whole", "whole")) == (0, 2)


def test_a_view_that_is_alone_keeps_another_beside_it() -> None:
    assert best_pair((0, 1), rig(0, 90, 180), seen("none", "none", "whole")) == (0, 2)
    assert best_pair((1, 2), rig(0, 90, 180), seen("whole", "none", "none")) == (0, 1)
    assert best_pair((0, 2), rig(0, 90, 180), seen("whole", "none", "none")) == (0, 2)


def test_where_no_view_sees_anybody_the_pair_stays() -> None:
    assert best_pair((1, 2), rig(0, 90, 180), seen("none", "none", "none")) == (1, 2)


def test_what_takes_two_is_given_the_cameras_and_reports_of_the_pair() -> None:
    three, views = rig(0, 90, 180), seen("whole", "none", "cut")
    own, shown = two_of(three, views, (0, 2))
    assert [camera.name for camera in own.cameras] == ["0", "180"]
    assert shown == (views[0], views[2])


def test_a_rig_of_two_is_its_own_and_an_only_camera_has_nothing_beside_it() -> None:
    two, one = rig(0, 90), rig(0)
    assert two_of(two, seen("whole", "cut"), (0, 1)).rig is two
    assert best_pair(None, one, seen("whole")) == (0, 0)
    own, shown = two_of(one, seen("whole"), (0, 0))
    assert own.cameras == one.cameras * 2
    assert [each is None for each in shown] == [False, True]
