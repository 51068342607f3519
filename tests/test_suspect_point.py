"""Which point to look at first, held against points that were moved on purpose."""

import msgspec
import numpy as np
import pytest
from pole_room import PLACES_M, POLE_M, RIG, SIZE, marker_points, pixels, tops_px

from animator.marking.sheet import Mark, Seen, Sheet
from tritrack.marking.marker_sheet import solve_markers
from tritrack.marking.pole_sheet import solve_poles
from tritrack.marking.suspect_point import suspect_point, without


def clicked_poles() -> Sheet:
    """Every top in both pictures, without error."""
    pairs = zip(*(tops_px(camera) for camera in RIG.cameras), PLACES_M, strict=True)
    marks = tuple(Mark("pole", (one, other), place) for one, other, place in pairs)
    return Sheet(marks, {"pole_height_m": POLE_M})


def clicked_markers(count: int = 4) -> Sheet:
    """So many points on every marker, without error."""
    marks = []
    for kind in ("floor", "wall"):
        both = []
        for number, camera in enumerate(RIG.cameras, 1):
            ends = np.array(marker_points(number)[kind])[[0, -1]]
            along = ends[0] + np.linspace(0.0, 1.0, count)[:, None] * (ends[1] - ends[0])
            both.append(pixels(camera, [tuple(place) for place in along.tolist()]))
        marks += [Mark(kind, pair) for pair in zip(*both, strict=True)]
    return Sheet(tuple(marks), {"focal_1_px": 620.0, "focal_2_px": 640.0})


def moved(sheet: Sheet, mark: int, camera: int, by_px: tuple[float, float]) -> Sheet:
    px = list(sheet.marks[mark].px)
    own = px[camera]
    assert own is not None
    px[camera] = (own[0] + by_px[0], own[1] + by_px[1])
    new = msgspec.structs.replace(sheet.marks[mark], px=(px[0], px[1]))
    marks = (*sheet.marks[:mark], new, *sheet.marks[mark + 1 :])
    return msgspec.structs.replace(sheet, marks=marks)


@pytest.mark.parametrize("camera", [0, 1])
@pytest.mark.parametrize("mark", range(len(PLACES_M)))
@pytest.mark.parametrize("by_px", [(4.0, 0.0), (0.0, -3.0), (-2.0, 2.0)])
def test_a_pole_clicked_beside_its_top_is_named(
    camera: int, mark: int, by_px: tuple[float, float]
) -> None:
    """Also where others are as far off, since the fit is drawn to what has leverage."""
    solved = solve_poles(moved(clicked_poles(), mark, camera, by_px), SIZE)
    assert solved.worst_at == (camera, mark)
    assert solved.worst.endswith(f"in camera {camera + 1}")


@pytest.mark.parametrize("camera", [0, 1])
@pytest.mark.parametrize("mark", range(8))
def test_a_point_beside_its_marker_is_named(camera: int, mark: int) -> None:
    by_px = (3.0, 0.0) if mark < 4 else (0.0, 3.0)
    solved = solve_markers(moved(clicked_markers(), mark, camera, by_px), SIZE, (1, 2))
    assert solved.worst_at == (camera, mark)


def test_nothing_is_named_where_nothing_is_off_or_nothing_could_show_it() -> None:
    assert solve_poles(clicked_poles(), SIZE).worst_at is None
    few = clicked_poles()
    for mark in range(2, len(PLACES_M)):
        few = without(without(few, mark, 1), mark, 2)
    assert solve_poles(moved(few, 0, 0, (5.0, 0.0)), SIZE).worst_at is None


def test_where_leaving_out_tells_nothing_it_is_the_farthest_off() -> None:
    """Of three points on a line each may be the one that is off."""
    sheet = moved(clicked_markers(3), 2, 0, (3.0, 0.0))
    worst = solve_markers(sheet, SIZE, (1, 2)).worst_at
    assert worst is not None
    assert worst[0] == 0
    assert worst[1] < 3


def test_a_camera_that_is_not_known_names_none() -> None:
    assert suspect_point(clicked_poles(), (1, 2), lambda *_: Seen(False, "no")) is None
