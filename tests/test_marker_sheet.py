"""Line markers on the page: the same answer as the typed command's, and what it is told by."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pole_room import SIZE
from test_suspect_point import clicked_markers, moved

from animator.marking.sheet import Kind, Mark, Sheet, Solved
from calibration.paper.calibration import read_points, run_markers
from calibration.paper.markers import Markers
from common.rig.rig_file import CalibrationError
from tritrack.marking import marker_sheet
from tritrack.marking.marker_sheet import (
    marker_method,
    markers_of,
    markers_text,
    sheet_of_markers,
    solve_markers,
)

CONFIGS = Path(__file__).parents[1] / "configs"
BOTH = (1, 2)


def test_aimed_cameras_are_told_to_be_so() -> None:
    solved = solve_markers(clicked_markers(), SIZE, BOTH)
    assert solved.whole
    for seen in solved.cameras:
        assert dict(seen.facts)["yaw"].startswith("0.00°")
        assert seen.off_px == pytest.approx([0.0] * 8, abs=1e-6)
        floor, wall = seen.lines_px
        assert np.array(floor) == pytest.approx(np.array([(320.0, 0.0), (320.0, 480.0)]))
        assert np.array(wall) == pytest.approx(np.array([(0.0, 240.0), (640.0, 240.0)]))


def test_the_example_of_markers_is_read_kept_and_told_as_the_typed_command_does(
    tmp_path: Path,
) -> None:
    example = read_points(CONFIGS / "markers.toml", Markers)
    sheet = sheet_of_markers(example, BOTH)
    assert markers_of(sheet, SIZE, BOTH) == example
    kept = tmp_path / "markers.toml"
    kept.write_text(markers_text(example))
    assert read_points(kept, Markers) == example
    method = marker_method(SIZE, example, BOTH)
    assert tuple(method.rows(method.start)) == run_markers(kept)
    facts = dict(method.solve(sheet).cameras[0].facts)
    first = run_markers(kept)[0]
    assert facts["yaw"] == f"{first.yaw_deg:.2f}° too far right"
    assert facts["pitch"] == f"{-first.pitch_deg:.2f}° too far down"
    assert facts["roll"] == f"{first.roll_deg:.2f}° clockwise"


def test_a_files_cameras_are_told_apart_by_their_names() -> None:
    """A file of camera 2 alone, on a page of both, or of it alone."""
    example = read_points(CONFIGS / "markers.toml", Markers)
    alone = msgspec.structs.replace(example, cameras=example.cameras[1:])
    both = sheet_of_markers(alone, BOTH)
    assert both.numbers["focal_2_px"] == 640.0
    assert {mark.px[1] is not None for mark in both.marks} == {True}
    assert markers_of(sheet_of_markers(example, (2,)), SIZE, (2,)) == alone


def test_a_camera_that_looks_to_the_right_is_drawn_so() -> None:
    """Camera 1 looks along -z and has +x at its right, camera 2 along +x and has +z there."""
    example = read_points(CONFIGS / "markers.toml", Markers)
    plan = solve_markers(sheet_of_markers(example, BOTH), SIZE, BOTH).plan
    assert plan is not None
    assert [camera[2] for camera in plan.cameras] == pytest.approx([-90.0 + 1.5, -0.7], abs=0.1)


def test_a_point_is_off_by_its_distance_from_the_line_and_its_foot_is_on_it() -> None:
    seen = solve_markers(moved(clicked_markers(), 1, 0, (3.0, 0.0)), SIZE, BOTH).cameras[0]
    for mark, at, off_px in zip(
        moved(clicked_markers(), 1, 0, (3.0, 0.0)).marks, seen.expected_px, seen.off_px, strict=True
    ):
        own = mark.px[0]
        assert own is not None
        assert at is not None
        assert ((own[0] - at[0]) ** 2 + (own[1] - at[1]) ** 2) ** 0.5 == pytest.approx(off_px)


def test_what_is_missing_is_told() -> None:
    sheet = clicked_markers()
    numbers = {**sheet.numbers, "focal_2_px": None}
    half = Sheet((*sheet.marks[:1], *sheet.marks[4:]), numbers)
    one, other = solve_markers(half, SIZE, BOTH).cameras
    assert one.text == "floor_px of cam1 is no line: give two points or more"
    assert other.text == "say the focal length of camera 2, in pixels of these pictures"
    with pytest.raises(CalibrationError, match="focal length of camera 2"):
        markers_text(markers_of(half, SIZE, BOTH))


def test_one_camera_alone_is_aimed_too() -> None:
    sheet = clicked_markers()
    method = marker_method(SIZE, None, (2,))
    assert [number.key for number in method.numbers] == ["focal_2_px"]
    solved = method.solve(sheet)
    assert len(solved.cameras) == 1
    assert solved.whole
    assert [view.name for view in markers_of(sheet, SIZE, (2,)).cameras] == ["cam2"]
    assert method.write is None


kinds: st.SearchStrategy[Kind] = st.sampled_from(["floor", "wall"])
points = st.none() | st.tuples(st.floats(0, 640), st.floats(0, 480))


@given(
    st.lists(st.builds(Mark, kinds, st.tuples(points, points)), max_size=8),
    st.fixed_dictionaries(
        {key: st.none() | st.floats(0.01, 1e4) for key in ("focal_1_px", "focal_2_px")}
    ),
)
def test_whatever_is_clicked_is_solved_or_told(
    marks: list[Mark], said: dict[str, float | None]
) -> None:
    solved = solve_markers(Sheet(tuple(marks), said), SIZE, BOTH)
    for seen in solved.cameras:
        assert seen.known or seen.text
    assert msgspec.json.decode(msgspec.json.encode(solved), type=Solved) == solved


def test_an_aim_is_told_by_the_side_it_errs_to() -> None:
    aims: list[Any] = [
        SimpleNamespace(yaw_deg=yaw, pitch_deg=pitch, roll_deg=roll, skew_deg=0.256)
        for yaw, pitch, roll in ((1.234, -0.5, 2.0), (-1.234, 0.5, -2.0))
    ]
    assert [dict(marker_sheet._facts(aim)) for aim in aims] == [
        {
            "yaw": "1.23° too far right",
            "pitch": "0.50° too far down",
            "roll": "2.00° clockwise",
            "markers off square": "0.26°",
        },
        {
            "yaw": "1.23° too far left",
            "pitch": "0.50° too far up",
            "roll": "2.00° counterclockwise",
            "markers off square": "0.26°",
        },
    ]


def test_a_line_is_drawn_from_border_to_border() -> None:
    """x = 10 + y / 2 from the top to the bottom of 640 x 480; y = 40 - x / 4 from side to side."""
    steep, flat = np.array([1.0, -0.5, -10.0]), np.array([0.5, 2.0, -80.0])
    assert marker_sheet._ends(steep, 480, 1) == ((10.0, 0.0), (250.0, 480.0))
    assert marker_sheet._ends(flat, 640, 0) == ((0.0, 40.0), (640.0, -120.0))
    assert marker_sheet._ends(np.array([0.0, 1.0, -5.0]), 480, 1) is None
    assert marker_sheet._ends(np.array([1.0, 0.0, -5.0]), 640, 0) is None


def test_cameras_are_drawn_four_metres_off_whatever_their_distance() -> None:
    aim: Any = SimpleNamespace(yaw_deg=2.5)
    assert marker_sheet._place(1, aim) == (0.0, 4.0, -87.5, 40.0)
    assert marker_sheet._place(2, aim) == (-4.0, 0.0, 2.5, 40.0)


def test_points_are_numbered_marker_by_marker_and_the_worst_names_its_camera() -> None:
    solved = solve_markers(moved(clicked_markers(), 5, 1, (0.0, 3.0)), SIZE, BOTH)
    assert solved.names[0] == "floor marker, point 1"
    assert solved.names[3:6] == (
        "floor marker, point 4",
        "wall marker, point 1",
        "wall marker, point 2",
    )
    assert solved.worst == "wall marker, point 2 in camera 2"
