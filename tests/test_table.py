"""What a person sees of a run."""

import io
from collections.abc import Callable

import pytest
from rich.console import Console

from common.bus.control_messages import Pulse
from runtime.live.table import table_of, table_of_rows
from runtime.terminal import bar, complain, counted, json_text, warn


def printed(thing: object, width: int = 80) -> list[str]:
    paper = io.StringIO()
    Console(file=paper, width=width).print(thing)
    return [line.rstrip() for line in paper.getvalue().splitlines()]


def running(name: str, **more: object) -> Pulse:
    return Pulse(process=name, state="running", **more)  # type: ignore[arg-type]


def test_every_process_has_a_line_from_the_start() -> None:
    lines = printed(table_of(["integrator", "viewer 1"], {"viewer 1": running("viewer 1")}, "run"))
    assert [line.split()[:2] for line in lines if "integrator" in line] == [
        ["integrator", "starting"]
    ]
    assert ["viewer 1" in line and "running" in line for line in lines].count(True) == 1


def test_a_viewer_stands_with_the_name_of_its_camera_where_that_has_one() -> None:
    names = ["integrator", "viewer 1", "viewer 2"]
    lines = printed(table_of(names, {}, "run", ("[red] door", "camera 2")), width=120)
    assert [line.split("starting")[0].strip() for line in lines if "starting" in line] == [
        "integrator",
        "viewer 1 ([red] door)",
        "viewer 2",
    ]


def test_numbers_stand_under_their_names() -> None:
    pulse = running(
        "viewer 1",
        frames=69,
        fps=14.96,
        deadline_misses=3,
        dropped=4,
        late=5,
        latency_p50_ms=1.24,
        latency_p99_ms=12.0,
        memory_mb=219.6,
    )
    lines = printed(table_of(["viewer 1"], {"viewer 1": pulse}, "run"))
    row = next(line for line in lines if "viewer 1" in line)
    assert row.split() == ["viewer", "1", "running", "69", "15.0", "3", "9", "1.2", "12.0", "220"]


def test_the_table_fits_a_terminal_of_80_columns_uncut() -> None:
    names = ["integrator", "recognizer", "animator", "viewer 1", "viewer 2"]
    pulses = {
        name: running(name, frames=99_999, fps=15.0, latency_p99_ms=999.9, memory_mb=9999.0)
        for name in names
    }
    lines = printed(table_of(names, pulses, "run"))
    assert not any("…" in line for line in lines)


def test_rows_become_columns_by_name() -> None:
    lines = printed(
        table_of_rows([{"name": "cam1", "yaw_deg": 1.505}, {"name": "cam2", "yaw_deg": -0.67}])
    )
    assert [line.split() for line in lines if "cam" in line] == [
        ["cam1", "1.50"],
        ["cam2", "-0.67"],
    ]
    assert any("yaw deg" in line for line in lines)


@pytest.mark.parametrize(("say", "word"), [(warn, "warning"), (complain, "error")])
def test_what_is_said_is_one_line_however_long_and_taken_literally(
    say: Callable[[Console, str], None], word: str
) -> None:
    paper = io.StringIO()
    say(Console(file=paper, width=80), "a\n  file [red]x[/] " + "y" * 200)
    assert paper.getvalue() == f"{word}: a file [red]x[/] {'y' * 200}\n"


def test_where_nobody_looks_on_there_is_no_bar() -> None:
    paper = io.StringIO()
    with bar(Console(file=paper)) as progress:
        assert list(progress.track([1, 2, 3])) == [1, 2, 3]
    assert paper.getvalue() == ""


def test_json_is_strict() -> None:
    assert json_text((float("nan"), {"x": float("-inf")}, 1.5, "NaN")) == (
        '[\n null,\n {\n  "x": null\n },\n 1.5,\n "NaN"\n]'
    )


def test_numbers_of_a_row_have_two_decimals_and_none_is_minus_nought() -> None:
    row = {"name": "cam1", "place_m": (1.6920873965148853e-18, 1.522, -0.001), "late": -0.0}
    (line,) = [line for line in printed(table_of_rows([row])) if "cam1" in line]
    assert line.split() == ["cam1", "0.00", "1.52", "0.00", "0.00"]


@pytest.mark.parametrize(("number", "said"), [(0, "0 bodies"), (1, "1 body"), (2, "2 bodies")])
def test_one_is_not_many(number: int, said: str) -> None:
    assert counted(number, "body", "bodies") == said
    assert counted(number, "clip") == said.replace("bodies", "clips").replace("body", "clip")


def test_names_stand_left_and_numbers_right_in_the_colour_of_their_state() -> None:
    states = ("running", "ended", "ready", "restarting", "given up", "starting")
    pulses = {state: Pulse(process=state, state=state) for state in states}  # type: ignore[arg-type]
    table = table_of([*states, "unheard"], pulses, "run")
    headings = [column.header for column in table.columns]
    assert headings == [
        *("process", "state", "frames", "fps", "missed", "dropped", "p50 ms", "p99 ms", "MB")
    ]
    assert [column.justify for column in table.columns] == ["left", "left", *["right"] * 7]
    assert all(column.no_wrap for column in table.columns)
    assert [*table.columns[1].cells] == [
        *("[green]running[/]", "[dim]ended[/]", "[cyan]ready[/]", "[yellow]restarting[/]"),
        *("[red]given up[/]", "[white]starting[/]", "starting"),
    ]
    assert [[*column.cells][-1] for column in table.columns] == [
        *("unheard", "starting"),
        *[""] * 7,
    ]


def test_rows_have_their_name_left_and_all_else_right() -> None:
    table = table_of_rows([{"name": "cam1", "yaw_deg": 1.5, "frames": 3}])
    assert [column.justify for column in table.columns] == ["left", "right", "right"]
    assert [[*column.cells] for column in table.columns] == [["cam1"], ["1.50"], ["3"]]
    assert [column.header for column in table.columns] == ["name", "yaw deg", "frames"]
    assert table_of_rows([]).columns == []
