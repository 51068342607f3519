"""Poles on the page: the same answer as the typed command's, from the file that the page keeps."""

from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pole_room import DISTANCES_M, FOCALS_PX, POLE_M, RIG, SIZE, tops_px
from test_suspect_point import clicked_poles

from animator.marking.sheet import Mark, Sheet, Solved
from common.rig.camera import project
from common.rig.rig_file import CalibrationError, load_rig
from integrator.rig.calibration import read_points, run_poles
from integrator.rig.poles import Poles
from tritrack.marking.pole_sheet import (
    NUMBERS,
    START_M,
    pole_method,
    poles_of,
    poles_text,
    sheet_of_poles,
    solve_poles,
)

CONFIGS = Path(__file__).parents[1] / "configs"


def test_tops_without_error_give_the_rig_and_nothing_is_off() -> None:
    solved = solve_poles(clicked_poles(), SIZE)
    assert solved.whole
    for seen, focal_px, distance_m in zip(solved.cameras, FOCALS_PX, DISTANCES_M, strict=True):
        facts = dict(seen.facts)
        assert facts["focal length"].startswith(f"{focal_px:.1f} ± ")
        assert facts["distance"].startswith(f"{distance_m:.3f} ± ")
        assert seen.off_px == pytest.approx([0.0] * 5, abs=1e-6)
    assert solved.plan is not None
    assert [camera[:3] for camera in solved.plan.cameras] == [
        pytest.approx((0.0, DISTANCES_M[0], -90.0)),
        pytest.approx((-DISTANCES_M[1], 0.0, 0.0)),
    ]


def test_poles_are_drawn_from_their_feet_to_their_tops() -> None:
    for seen, camera in zip(solve_poles(clicked_poles(), SIZE).cameras, RIG.cameras, strict=True):
        foot, top = seen.lines_px[1]
        assert foot == pytest.approx(project(camera, [(0.0, 0.0, 1.0)])[0], abs=1e-5)  # type: ignore[arg-type]
        assert top == pytest.approx(tops_px(camera)[1], abs=1e-5)


def test_one_camera_is_told_before_the_other_is_clicked() -> None:
    marks = tuple(Mark("pole", (mark.px[0], None), mark.at_m) for mark in clicked_poles().marks)
    solved = solve_poles(Sheet(marks, {"pole_height_m": POLE_M}), SIZE)
    assert [seen.known for seen in solved.cameras] == [True, False]
    assert solved.cameras[1].text == "cam2 shows 0 poles: two or more are needed"
    assert not solved.whole


def test_the_height_of_the_poles_is_asked_for() -> None:
    sheet = Sheet(clicked_poles().marks, {"pole_height_m": None})
    solved = solve_poles(sheet, SIZE)
    assert {seen.text for seen in solved.cameras} == {
        "say how tall the poles are, from the floor to the top"
    }
    with pytest.raises(CalibrationError, match="how tall"):
        poles_of(sheet, SIZE)


def test_a_sheet_becomes_a_file_that_the_typed_command_reads_alike(tmp_path: Path) -> None:
    """And back: the page goes on with a file of poles, typed or its own."""
    out, sheet = tmp_path / "calibration.json", clicked_poles()
    method = pole_method(SIZE, None, out)
    points = tmp_path / "poles.toml"
    points.write_text(method.text(sheet))
    assert method.write is not None
    method.write(sheet)
    again = run_poles(points, tmp_path / "typed.json")
    assert again.cameras == tuple(method.rows(sheet))
    assert out.read_bytes() == (tmp_path / "typed.json").read_bytes()
    assert load_rig(out).cameras == load_rig(tmp_path / "typed.json").cameras
    assert sheet_of_poles(read_points(points, Poles)).marks == sheet.marks


def test_the_example_of_poles_comes_back_as_it_is() -> None:
    measured = read_points(CONFIGS / "poles.toml", Poles)
    sheet = sheet_of_poles(measured)
    assert poles_of(sheet, (measured.width, measured.height)) == measured
    assert msgspec.toml.decode(poles_text(measured), type=Poles) == measured


def test_a_tape_and_a_pole_that_one_camera_does_not_show_are_kept(tmp_path: Path) -> None:
    first, *others = clicked_poles().marks
    hidden = Mark("pole", (first.px[0], None), first.at_m)
    numbers = {"pole_height_m": POLE_M, "distance_1_m": 4.2, "distance_2_m": None}
    measured = poles_of(Sheet((hidden, *others), {**numbers}), SIZE)
    assert (measured.distance_1_m, measured.distance_2_m) == (4.2, None)
    assert measured.poles[0].cam2_px is None
    assert msgspec.toml.decode(poles_text(measured), type=Poles) == measured


def test_the_page_begins_with_the_papers_poles() -> None:
    start = pole_method(SIZE, None, Path("calibration.json")).start
    assert [mark.at_m for mark in start.marks] == list(START_M)
    assert START_M[:3] == ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0))


places = st.tuples(st.floats(-20, 20), st.floats(-20, 20))
points = st.none() | st.tuples(st.floats(0, 640), st.floats(0, 480))
numbers = st.none() | st.floats(0.01, 100.0)


@given(
    st.lists(st.builds(Mark, st.just("pole"), st.tuples(points, points), places), max_size=6),
    st.fixed_dictionaries({number.key: numbers for number in NUMBERS}),
)
def test_whatever_is_clicked_is_solved_or_told(
    marks: list[Mark], said: dict[str, float | None]
) -> None:
    solved = solve_poles(Sheet(tuple(marks), said), SIZE)
    assert len(solved.names) == len(marks)
    for seen in solved.cameras:
        assert seen.known or seen.text
    assert msgspec.json.decode(msgspec.json.encode(solved), type=Solved) == solved
