"""Poles on the page: the same answer as the typed command's, from the file that the page keeps."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pole_room import DISTANCES_M, FOCALS_PX, POLE_M, RIG, SIZE, tops_px
from test_suspect_point import clicked_poles, moved

from animator.marking.sheet import Mark, Sheet, Solved
from calibration.paper.calibration import read_points, run_poles
from calibration.paper.poles import Poles
from common.rig.camera import project
from common.rig.rig_file import CalibrationError, load_rig
from tritrack.marking import pole_sheet
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


def test_cameras_are_drawn_as_wide_as_they_see_and_poles_where_they_stand() -> None:
    plan = solve_poles(clicked_poles(), SIZE).plan
    assert plan is not None
    widths = [2 * np.degrees(np.arctan2(SIZE[0] / 2, focal_px)) for focal_px in FOCALS_PX]
    assert [camera[3] for camera in plan.cameras] == pytest.approx(widths, abs=1e-3)
    due = [(*(mark.at_m or ()), n) for n, mark in enumerate(clicked_poles().marks)]
    assert list(plan.marks) == due


def test_a_top_beside_where_it_should_be_is_off_by_its_distance_from_there() -> None:
    sheet = moved(clicked_poles(), 2, 1, (3.0, -4.0))
    seen = solve_poles(sheet, SIZE).cameras[1]
    for mark, expected, off_px in zip(sheet.marks, seen.expected_px, seen.off_px, strict=True):
        top = mark.px[1]
        assert top is not None
        assert expected is not None
        assert off_px == pytest.approx(np.hypot(top[0] - expected[0], top[1] - expected[1]))
    assert max(off for off in seen.off_px if off is not None) > 1.0


def test_what_is_known_of_a_camera_is_told_with_its_units() -> None:
    known: Any = SimpleNamespace(
        focal_px=612.34,
        focal_sd_px=1.25,
        distance_m=4.1234,
        distance_sd_m=0.0156,
        height_m=1.2,
        off_centre_px=-3.42,
        misfit_px=0.567,
    )
    assert pole_sheet._facts(known) == (
        ("focal length", "612.3 ± 1.2 px"),
        ("distance", "4.123 ± 0.016 m"),
        ("height", "1.200 m"),
        ("axis off centre", "-3.4 px"),
        ("misfit", "0.57 px"),
    )


def test_poles_are_lettered_and_numbered_after_the_alphabet() -> None:
    names = [pole_sheet._name(n, Mark("pole", at_m=(0.5, -1.25))) for n in (0, 25, 26, 40)]
    assert names == [f"pole {name} at x 0.5, z -1.25 m" for name in ("A", "Z", "27", "41")]
