"""Points clicked on the page: solved as the typed command does, kept, saved, and by a real pointer.

The pictures are drawn by a rig that is known, so that what the page finds can be held against it.
"""

import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import msgspec
import numpy as np
import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import open_tab, saved
from pole_room import (
    DISTANCES_M,
    FOCALS_PX,
    POLE_M,
    RIG,
    SIZE,
    marker_points,
    pixels,
    tops_px,
    write_films,
)
from rich.console import Console
from test_live import Looking
from test_sheet import POLES
from test_stills import Camera
from test_suspect_point import clicked_markers, clicked_poles, moved
from waiting import until
from websockets.sync.client import connect
from websockets.sync.connection import Connection

from animator.marking.marking_page import MarkingPage
from animator.marking.sheet import (
    Hello,
    Marked,
    Pictures,
    Save,
    Seen,
    Sheet,
    Shown,
    Solved,
)
from animator.page.wish_page import Told
from calibration.paper.calibration import read_points, run_markers, run_poles
from calibration.paper.poles import Poles
from common.body.observation import Pixel
from common.config.part_settings import PageSettings
from common.rig.camera import as_paper_rig
from common.rig.rig_file import CalibrationError, load_rig
from tritrack.marking import marking
from tritrack.marking.marker_sheet import marker_method, markers_of, markers_text
from tritrack.marking.marking import (
    HEAD,
    Asked,
    KeptPoints,
    answered,
    kept_points,
    mark_markers,
    mark_poles,
)
from tritrack.marking.marking_method import MarkingMethod
from tritrack.marking.pole_sheet import pole_method, poles_text, sheet_of_poles
from tritrack.marking.stills import Album, Film, Running

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
QUIET = Console(quiet=True)
SOFT = ("--disable-gpu",)
SIZES = {"desk": (1400, 900), "phone": (390, 844)}


def test_points_are_kept_as_soon_as_a_file_of_them_can_be_read(tmp_path: Path) -> None:
    path = tmp_path / "poles.toml"
    method = pole_method(SIZE, None, tmp_path / "calibration.json")
    sheet = clicked_poles()
    untold = msgspec.structs.replace(sheet, numbers={"pole_height_m": None})
    shown = answered(method, Marked(untold, "me", 1), KeptPoints(path, HEAD))
    assert (shown.well, path.exists()) == (False, False)
    assert (
        shown.kept == "points not kept yet: say how tall the poles are, from the floor to the top"
    )
    shown = answered(method, Marked(sheet, "me", 2), KeptPoints(path, HEAD))
    assert (shown.kept, shown.well, shown.by, shown.count) == (
        *("points kept in poles.toml", True),
        *("me", 2),
    )
    assert sheet_of_poles(read_points(path, Poles)).marks == sheet.marks
    assert path.read_text().startswith(HEAD)


def test_a_folder_that_is_gone_costs_no_click(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    method = pole_method(SIZE, None, tmp_path / "calibration.json")
    kept = KeptPoints(tmp_path / "file" / "poles.toml", HEAD)
    shown = answered(method, Marked(clicked_poles(), "me", 1), kept)
    assert not shown.well
    assert "cannot write" in shown.kept
    assert shown.solved.whole


def test_remarks_at_the_head_of_a_file_stay(tmp_path: Path) -> None:
    path = tmp_path / "poles.toml"
    assert kept_points(path) == KeptPoints(path, HEAD)
    path.write_text("# Our gym, by Ana.\n\n# North wall.\nwidth = 640\n# not this\nheight = 480\n")
    assert kept_points(path).head == "# Our gym, by Ana.\n\n# North wall.\n"
    with pytest.raises(CalibrationError, match="keeps points as TOML"):
        kept_points(tmp_path / "poles.json")


def test_points_of_other_pictures_are_not_gone_on_with(tmp_path: Path) -> None:
    """Places without points are: their size was a guess."""
    clip, path = write_films(tmp_path / "room"), tmp_path / "poles.toml"
    asked = Asked(clip, path, free_port())
    measured = read_points(Path(__file__).parents[1] / "configs" / "poles.toml", Poles)
    path.write_text(poles_text(msgspec.structs.replace(measured, width=1280, height=960)))
    with pytest.raises(CalibrationError, match="1280x960 pictures, these have 640x480"):
        mark_poles(asked, tmp_path / "calibration.json", QUIET)


def test_markers_of_other_pictures_are_not_gone_on_with_and_a_file_without_any_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was clicked before stands on the sheet; nothing is asked for but the page."""
    path, album = tmp_path / "markers.toml", Album(SIZE, {n: Film((), ()) for n in (1, 2)})
    served: list[tuple[MarkingMethod, Asked, str]] = []
    monkeypatch.setattr(marking, "open_album", lambda *_: nullcontext(album))
    monkeypatch.setattr(
        marking, "_serve", lambda m, _a, asked, _p, writes, _: served.append((m, asked, writes))
    )
    asked, sheet = Asked(tmp_path, path, 1), clicked_markers()
    path.write_text(markers_text(markers_of(sheet, (1280, 960), (1, 2))))
    with pytest.raises(CalibrationError, match="1280x960 pictures, these have 640x480"):
        mark_markers(asked, QUIET)
    path.write_text(markers_text(markers_of(sheet, SIZE, (1, 2))))
    mark_markers(asked, QUIET)
    method, said, writes = served[-1]
    assert (method.name, method.start.marks, said, writes) == ("markers", sheet.marks, asked, "")
    path.write_text("width = 1280\nheight = 960\ncameras = []\n")
    mark_markers(asked, QUIET)
    assert all(not any(mark.px) for mark in served[-1][0].start.marks)
    path.unlink()
    mark_markers(asked, QUIET)
    assert len(served) == 3


def test_poles_want_both_cameras(tmp_path: Path) -> None:
    clip = write_films(tmp_path / "room")
    (clip / "cam2.avi").unlink()
    with pytest.raises(CalibrationError, match="has one view"):
        mark_poles(Asked(clip, tmp_path / "poles.toml", free_port()), tmp_path / "out.json", QUIET)


class Wishing:
    """A page on which browsers wish something; what it is asked to show and to tell."""

    def __init__(self, *wishes: Any) -> None:
        self.wishes = list(wishes)
        self.shown: list[Shown] = []
        self.told: list[tuple[str, bool]] = []
        self.closed = False

    def next_wish(self) -> Any:
        return self.wishes.pop(0) if self.wishes else None

    def show(self, shown: Shown) -> None:
        self.shown.append(shown)

    def tell(self, told: Told) -> None:
        self.told.append((told.text, told.well))

    def close(self) -> None:
        self.closed = True


def hello_of(method: MarkingMethod, writes: str = "out.json") -> Hello:
    pictures = tuple(Pictures(n, f"cam{n}", ("one",), (0,), runs=False) for n in (1, 2))
    return Hello("room", 0, method.name, SIZE, pictures, method.numbers, method.hints, writes)


def test_wishes_are_done_in_their_order_and_a_calibration_is_of_what_was_shown_before_it(
    tmp_path: Path,
) -> None:
    method = pole_method(SIZE, None, tmp_path / "out.json")
    first, second = clicked_poles(), moved(clicked_poles(), 0, 0, (1.0, 0.0))
    page: Any = Wishing(Marked(first, "ann", 1), Save(), Marked(second, "bob", 2))
    kept = KeptPoints(tmp_path / "poles.toml", HEAD)
    nothing = Shown(method.start, "", 0, method.solve(method.start), "", True)
    shown, saved = marking._hear(page, method, hello_of(method), nothing, kept)
    assert [each.sheet for each in page.shown] == [first, second]
    assert (shown.sheet, shown.by, shown.count) == (second, "bob", 2)
    assert saved == first
    assert page.told == [("written to out.json", True)]
    assert (tmp_path / "out.json").exists()
    assert sheet_of_poles(read_points(kept.path, Poles)).marks == second.marks
    again, none = marking._hear(page, method, hello_of(method), shown, kept)
    assert (again, none) == (shown, None)


def test_a_wish_that_cannot_be_done_is_told_and_what_was_shown_stays(tmp_path: Path) -> None:
    method = marker_method(SIZE, None, (1, 2))
    nothing = Shown(method.start, "", 0, method.solve(method.start), "", True)
    kept = KeptPoints(tmp_path / "markers.toml", HEAD)
    outside = moved(clicked_markers(), 2, 0, (5000.0, 0.0))
    for wish, says in (
        (Marked(outside, "ann", 1), "point 3 is outside the picture"),
        (Save(), "markers give no whole calibration: there is nothing to save but points"),
    ):
        page: Any = Wishing(wish)
        shown, saved = marking._hear(page, method, hello_of(method, ""), nothing, kept)
        ((text, well),) = page.told
        assert says in text
        assert not well
        assert (shown, saved, page.shown) == (nothing, None, [])


@pytest.mark.parametrize("port", [None, 4321])
def test_the_page_is_served_until_it_is_stopped_and_its_result_is_of_the_newest_points(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, port: int | None
) -> None:
    method = pole_method(SIZE, None, tmp_path / "out.json")
    album = Album(SIZE, {n: Film((b"one", b"two"), (0, 7)) for n in (1, 2)})
    newest = moved(clicked_poles(), 0, 0, (1.0, 0.0))
    page: Any = Wishing(Marked(clicked_poles(), "ann", 1), Save(), Marked(newest, "ann", 2))
    opened_with: list[Any] = []
    waits = iter([False, False, True])

    def opening(*given: Any) -> Any:
        opened_with.append(given)
        return page

    stop = SimpleNamespace(wait=lambda seconds: next(waits))
    monkeypatch.setattr(marking, "MarkingPage", opening)
    monkeypatch.setattr(marking, "process", lambda name, _: nullcontext(stop))
    console = Console(record=True, width=200, file=io.StringIO())
    asked = Asked(tmp_path / "room", tmp_path / "poles.toml", port)
    settings = PageSettings(port=8123)
    result = marking._serve(method, album, asked, settings, "out.json", console)
    ((hello, jpeg, at, _),) = opened_with
    assert (hello.title, hello.size, hello.writes) == ("room", SIZE, "out.json")
    assert (hello.method, hello.numbers, hello.pictures) == (
        "poles",
        method.numbers,
        album.pictures,
    )
    assert jpeg(2, 1) == b"two"
    assert at == (port or 8123)
    assert f":{port or 8123}" in console.export_text()
    assert page.shown[0].sheet == method.start
    assert page.closed
    assert (result.saved, result.newest) == (clicked_poles(), newest)
    assert len(result.rows) == 2


def test_a_page_without_enough_points_has_no_rows_and_one_whose_camera_fails_is_closed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    method = pole_method(SIZE, None, tmp_path / "out.json")
    page: Any = Wishing()
    waits = [False, True]
    stop = SimpleNamespace(wait=lambda _: waits.pop(0))
    monkeypatch.setattr(marking, "MarkingPage", lambda *_: page)
    monkeypatch.setattr(marking, "process", lambda *_: nullcontext(stop))
    asked = Asked(tmp_path / "room", tmp_path / "poles.toml", 1)
    album = Album(SIZE, {n: Film((), ()) for n in (1, 2)})
    result = marking._serve(method, album, asked, PageSettings(), "out.json", QUIET)
    assert (result.rows, result.saved, result.newest) == ((), None, method.start)
    waits[:] = [False, True]
    page.closed = False
    broken: Any = SimpleNamespace(size=SIZE, pictures=(), jpeg=None, refuse_fault=lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        marking._serve(method, broken, asked, PageSettings(), "out.json", QUIET)
    assert page.closed


class Command(NamedTuple):
    """`tritrack calibrate ... --page` while it runs."""

    process: "subprocess.Popen[str]"
    address: str
    folder: Path

    def ended(self) -> tuple[str, str]:
        """What it printed, once Ctrl-C has ended it well."""
        self.process.send_signal(signal.SIGINT)
        out, errors = self.process.communicate(timeout=30)
        assert self.process.returncode == 0, errors
        assert "Traceback" not in errors
        return out, errors


@contextmanager
def opened(folder: Path, method: str, *more: str) -> Iterator[Command]:
    """The command over films of the room, its page open."""
    clip = write_films(folder / "room")
    points = str(folder / f"{method}.toml")
    command = [sys.executable, "-m", "tritrack", "calibrate", method, points, "--page", str(clip)]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"}
    with subprocess.Popen(
        [*command, "--port", str(free_port()), *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    ) as process:
        try:
            assert process.stderr is not None
            told = next(line for line in process.stderr if "the page is at" in line)
            address = re.search(r"http://\S+\d", told)
            assert address is not None
            yield Command(process, address[0], folder)
        finally:
            process.kill()


def say(browser: Connection, sheet: Sheet, count: int) -> dict[str, Any]:
    """Say a sheet as the page does; what is shown then."""
    content = msgspec.to_builtins(Marked(sheet, "test", count))
    browser.send(json.dumps(content))
    return heard(browser, "shown")


def heard(browser: Connection, kind: str) -> dict[str, Any]:
    told: dict[str, Any] = json.loads(browser.recv(timeout=20))
    assert told["kind"] == kind, told
    return told


@pytest.mark.slow
def test_poles_said_to_the_page_are_solved_saved_and_repeated_by_the_typed_command(
    tmp_path: Path,
) -> None:
    out = tmp_path / "calibration.json"
    with opened(tmp_path, "poles", "--out", str(out), "--json") as command:
        with connect(command.address.replace("http", "ws") + "/live") as browser:
            assert heard(browser, "hello")["writes"] == "calibration.json"
            heard(browser, "shown")
            for bad, says in (
                ("[", "load it anew"),
                (json.dumps({"type": "marked", "sheet": 3}), "load it anew"),
            ):
                browser.send(bad)
                told = heard(browser, "told")
                assert not told["well"]
                assert says in told["text"]
            browser.send('{"type": "save"}')
            assert "say how tall the poles are" in heard(browser, "told")["text"]
            outside = moved(clicked_poles(), 2, 0, (5000.0, 0.0))
            browser.send(json.dumps(msgspec.to_builtins(Marked(outside, "test", 1))))
            assert "point 3 is outside the picture" in heard(browser, "told")["text"]
            shown = say(browser, moved(clicked_poles(), 3, 1, (6.0, 0.0)), 2)
            assert shown["solved"]["worst"] == "pole D at x 1, z -1 m in camera 2"
            shown = say(browser, clicked_poles(), 3)
            assert shown["solved"]["whole"]
            assert shown["count"] == 3
            assert not out.exists()
            browser.send('{"type": "save"}')
            assert heard(browser, "told") == {
                "kind": "told",
                "text": "written to calibration.json",
                "well": True,
            }
        printed, errors = command.ended()
    assert f"written to {out}" in errors
    facts = json.loads(printed)
    again = run_poles(tmp_path / "poles.toml", tmp_path / "typed.json")
    assert facts == list(msgspec.to_builtins(again.cameras))
    assert out.read_bytes() == (tmp_path / "typed.json").read_bytes()
    assert as_paper_rig(load_rig(out)) == pytest.approx((*FOCALS_PX, *DISTANCES_M), rel=1e-6)


@pytest.mark.slow
def test_changes_after_the_calibration_was_saved_are_told_with_the_cure(tmp_path: Path) -> None:
    out, points = tmp_path / "calibration.json", tmp_path / "poles.toml"
    with opened(tmp_path, "poles", "--out", str(out)) as command:
        with connect(command.address.replace("http", "ws") + "/live") as browser:
            heard(browser, "hello")
            heard(browser, "shown")
            say(browser, clicked_poles(), 1)
            browser.send('{"type": "save"}')
            heard(browser, "told")
            say(browser, moved(clicked_poles(), 0, 0, (1.0, 0.0)), 2)
        _, errors = command.ended()
    assert f"tritrack calibrate poles {points} --out {out} --force" in errors
    run_poles(points, out, replace=True)


@pytest.mark.slow
def test_markers_said_to_the_page_are_told_as_by_the_typed_command(tmp_path: Path) -> None:
    sheet = moved(clicked_markers(), 0, 0, (1.0, 0.0))
    with opened(tmp_path, "markers", "--json") as command:
        with connect(command.address.replace("http", "ws") + "/live") as browser:
            assert heard(browser, "hello")["writes"] == ""
            heard(browser, "shown")
            assert say(browser, sheet, 1)["kept"] == "points kept in markers.toml"
            browser.send('{"type": "save"}')
            assert not heard(browser, "told")["well"]
        printed, _ = command.ended()
    typed = run_markers(tmp_path / "markers.toml")
    assert json.loads(printed) == list(msgspec.to_builtins(typed))


@pytest.mark.slow
def test_a_page_that_nobody_clicked_on_says_so(tmp_path: Path) -> None:
    with opened(tmp_path, "poles", "--out", str(tmp_path / "calibration.json")) as command:
        _, errors = command.ended()
    assert "no calibration was saved" in errors
    assert not (tmp_path / "calibration.json").exists()
    assert not (tmp_path / "poles.toml").exists()


class Clicking(NamedTuple):
    """A person with a pointer before the page."""

    looking: Looking

    def box(self, selector: str) -> tuple[float, float, float, float]:
        """Where an element is in the window: left, top, width, height."""
        found = self.looking.ask(
            f"(() => {{ const e = document.querySelector('{selector}');"
            "e.scrollIntoView({ block: 'nearest' }); const b = e.getBoundingClientRect();"
            "return [b.x, b.y, b.width, b.height].join() })()"
        )
        left, top, width, height = (float(value) for value in found.split(","))
        return left, top, width, height

    def chosen(self) -> list[float]:
        """Where the picked point is told to be, once all that was done is drawn."""
        self.looking.drawn()
        text = self.looking.ask("document.querySelector('#chosen').textContent")
        return [float(value) for value in text.rpartition(": ")[2].split(",")]

    def press(self, x: float, y: float) -> None:
        """Click at whole pixels of the screen, as a pointer does."""
        for kind, buttons in (("mouseMoved", 0), ("mousePressed", 1), ("mouseReleased", 0)):
            self.looking.tab.call(
                "Input.dispatchMouseEvent",
                type=kind,
                x=round(x),
                y=round(y),
                button="none" if kind == "mouseMoved" else "left",
                buttons=buttons,
                clickCount=1,
            )

    def picture(self, at: Pixel) -> None:
        """Click where the whole picture shows a pixel."""
        left, top, width, height = self.box("#view")
        scale = min(width / SIZE[0], height / SIZE[1])
        x, y = ((at[n] - SIZE[n] / 2) * scale for n in (0, 1))
        self.press(left + width / 2 + x, top + height / 2 + y)

    def loupe(self, at: Pixel) -> None:
        """Click where the loupe shows a pixel: it shows the picked point in its middle."""
        now = self.chosen()
        left, top, width, height = self.box("#loupe")
        self.press(left + width / 2 + 8 * (at[0] - now[0]), top + height / 2 + 8 * (at[1] - now[1]))

    def key(self, key: str, code: int = 0, shift: bool = False) -> None:
        for kind in ("keyDown", "keyUp"):
            text = {"text": key} if len(key) == 1 and kind == "keyDown" else {}
            self.looking.tab.call(
                "Input.dispatchKeyEvent",
                type=kind,
                key=key,
                windowsVirtualKeyCode=code,
                modifiers=8 if shift else 0,
                **text,
            )

    def type(self, selector: str, value: float) -> None:
        """Fill in a number."""
        self.looking.ask(f"document.querySelector('{selector}').focus()")
        self.looking.tab.call("Input.insertText", text=str(value))
        self.looking.ask("document.activeElement.blur()")

    def points(self, points: Sequence[Pixel], camera: int) -> None:
        """Click the next points in a camera's picture, each put right in the loupe."""
        self.looking.ask(f"document.querySelectorAll('#cameras button')[{camera}].click()")
        for at in points:
            self.looking.drawn()
            before = self.looking.ask("document.body.dataset.picked")
            self.picture(at)
            assert self.looking.until(f"!['', '{before}'].includes(document.body.dataset.picked)")
            self.loupe(at)

    def is_told(self, words: str, camera: int) -> bool:
        """Whether these words come to stand in what is told of a camera."""
        told = f"document.querySelectorAll('#result > div')[{camera}].innerText"
        return bool(self.looking.until(f"{told}.includes('{words}')"))


@contextmanager
def clicking(address: str, size: tuple[int, int]) -> Iterator[Clicking]:
    with open_tab(str(CHROMIUM), SOFT) as tab:
        looking = Looking(tab, address, size)
        ready = (
            "document.body?.dataset.loaded === '2' && document.body.dataset.picked !== undefined"
        )
        assert looking.until(ready), "the pictures do not come"
        yield Clicking(looking)


needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium: the page is not clicked")


@pytest.mark.slow
@needs_browser
@pytest.mark.parametrize("window", SIZES)
def test_poles_clicked_in_a_browser_give_the_rig(tmp_path: Path, window: str) -> None:
    """Focal lengths within 0.2 %, distances within 1 cm, each top within a quarter of a pixel."""
    out = tmp_path / "calibration.json"
    with opened(tmp_path, "poles", "--out", str(out)) as command:
        with clicking(command.address, SIZES[window]) as person:
            looking = person.looking
            prompt = looking.ask("document.querySelector('#next').innerText")
            assert prompt == "next: pole A at x 0, z 0 m · the top of the pole"
            for camera, one in enumerate(RIG.cameras):
                person.points(tops_px(one), camera)
            assert person.is_told("how tall the poles are", 0)
            person.type("#pole_height_m", POLE_M)
            where = saved(looking.tab.screenshot(), tmp_path / "poles.png")
            assert looking.until("!document.querySelector('#save').disabled"), f"look at {where}"
            looking.ask("document.querySelector('#save').click()")
            assert looking.until("document.querySelector('#told').innerText.includes('written')")
            assert looking.ask("document.documentElement.scrollWidth <= innerWidth"), "too wide"
            own = (command.address, command.address.replace("http", "ws"), "data:")
            assert [each for each in looking.tab.asked if not each.startswith(own)] == []
        command.ended()
    found = as_paper_rig(load_rig(out))
    assert found is not None
    assert found[:2] == pytest.approx(FOCALS_PX, rel=0.002)
    assert found[2:] == pytest.approx(DISTANCES_M, abs=0.01)
    kept = read_points(tmp_path / "poles.toml", Poles).poles
    for number, one in enumerate(RIG.cameras, 1):
        tops = np.array([getattr(pole, f"cam{number}_px") for pole in kept])
        assert tops == pytest.approx(np.array(tops_px(one)), abs=0.25)


@pytest.mark.slow
@needs_browser
def test_markers_clicked_in_a_browser_tell_the_aim(tmp_path: Path) -> None:
    """Cameras that are aimed: within 0.1 degrees (P42); on a phone, whose page is the same."""
    with opened(tmp_path, "markers", "--json") as command:
        with clicking(command.address, SIZES["phone"]) as person:
            for number, camera in enumerate(RIG.cameras, 1):
                for kind, world in marker_points(number).items():
                    first = 0 if kind == "floor" else 4
                    person.looking.ask(
                        "document.querySelectorAll('#points li:not(.head)')"
                        f"[{first}].querySelectorAll('.px')[{number - 1}].click()"
                    )
                    person.points(pixels(camera, world), number - 1)
                person.type(f"#focal_{number}_px", FOCALS_PX[number - 1])
            assert person.looking.until(
                "document.querySelector('#result').innerText.split('yaw').length === 3"
            )
        printed, _ = command.ended()
    for aim in json.loads(printed):
        for key in ("yaw_deg", "pitch_deg", "roll_deg", "skew_deg"):
            assert abs(aim[key]) < 0.1, aim


@pytest.mark.slow
@needs_browser
def test_all_is_done_by_keyboard_too(tmp_path: Path) -> None:
    """Place, move, leave out, undo, take away, zoom, change picture and camera, save."""
    with opened(tmp_path, "poles", "--out", str(tmp_path / "calibration.json")) as command:
        with clicking(command.address, SIZES["desk"]) as person:
            looking = person.looking
            row = "document.querySelectorAll('#points li:not(.head)')[{}]"
            cell = row + ".querySelectorAll('.px')[{}].ariaLabel"
            person.type("#pole_height_m", POLE_M)
            person.key("Enter", 13)
            assert looking.until(f"{cell.format(0, 0)}.includes('camera 1: 320, 240')")
            person.key("ArrowRight", 39)
            person.key("ArrowUp", 38, shift=True)
            assert looking.until(f"{cell.format(0, 0)}.includes('320.25, 232')")
            person.key("u")
            assert looking.until(f"{cell.format(0, 0)}.includes('320.25, 240')")
            person.key("n")
            person.key("n")
            person.key("Enter", 13)
            assert looking.until(f"{cell.format(2, 0)}.includes('320, 240')")
            assert "not clicked" in looking.ask(cell.format(1, 0))
            person.key("Delete", 46)
            assert looking.until(f"{cell.format(2, 0)}.includes('not clicked')")
            person.key("2")
            person.key(".")
            assert looking.until("document.querySelector('#clock').innerText === 'frame 1'")
            person.key("+")
            assert looking.until("document.querySelector('#whole').innerText === '1.5×'")
            person.key("0")
            person.key("Enter", 13)
            assert looking.until(f"{cell.format(0, 1)}.includes('camera 2: 320, 240')")
            reached = set()
            for _ in range(60):
                looking.key("Tab", 9)
                reached.add(looking.ask("document.activeElement.id"))
            assert {"view", "scrub", "undo", "in", "out", "whole", "clear"} <= reached
            tree = looking.tab.call("Accessibility.getFullAXTree")["nodes"]
            roles = ("button", "slider", "spinbutton", "textbox")
            pressed = [n for n in tree if n.get("role", {}).get("value") in roles]
            named = [n for n in pressed if n.get("name", {}).get("value") or n.get("ignored")]
            assert len(pressed) > 30
            assert named == pressed
            assert until(lambda: "cam2_px = [320" in (tmp_path / "poles.toml").read_text())
        command.ended()
    kept = read_points(tmp_path / "poles.toml", Poles)
    assert kept.poles[0].cam1_px == (320.25, 240.0)
    assert kept.poles[0].cam2_px == (320.0, 240.0)


@pytest.mark.slow
@needs_browser
def test_a_page_that_is_loaded_anew_has_all_that_was_clicked(tmp_path: Path) -> None:
    with opened(tmp_path, "poles", "--out", str(tmp_path / "calibration.json")) as command:
        with clicking(command.address, SIZES["desk"]) as person:
            person.picture((100.0, 50.0))
            assert person.looking.until("document.body.dataset.shown === '1'")
        with clicking(command.address, SIZES["phone"]) as person:
            label = "document.querySelector('#points .px').ariaLabel"
            assert person.looking.until(f"{label}.includes('camera 1: ')")
        command.ended()


@pytest.mark.slow
@needs_browser
def test_a_finger_places_a_point_and_drags_it(tmp_path: Path) -> None:
    """And the page stays where it is: the drag goes down, as it scrolls."""
    with opened(tmp_path, "poles", "--out", str(tmp_path / "calibration.json")) as command:
        with clicking(command.address, SIZES["phone"]) as person:
            tab, looking = person.looking.tab, person.looking
            tab.call("Emulation.setTouchEmulationEnabled", enabled=True)
            left, top, _, height = person.box("#view")

            def touch(kind: str, *at: float) -> None:
                points = [{"x": left + at[0], "y": top + at[1]}] if at else []
                tab.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)

            touch("touchStart", 100.0, 60.0)
            touch("touchEnd")
            assert looking.until("document.body.dataset.shown === '1'")
            was = person.chosen()
            touch("touchStart", 100.0, 60.0)
            for step in range(1, 11):
                touch("touchMove", 100.0, 60.0 + 8.0 * step)
            touch("touchEnd")
            inside = "(e => e.clientWidth + ',' + e.clientHeight)(document.querySelector('#view'))"
            drawn = [float(value) for value in looking.ask(inside).split(",")]  # rounded
            moved_px = 80.0 * drawn[1] / height / min(drawn[0] / SIZE[0], drawn[1] / SIZE[1])
            assert person.chosen() == pytest.approx([was[0], was[1] + moved_px], abs=0.1)
            assert looking.ask("scrollY") == 0
        command.ended()


@pytest.mark.slow
@needs_browser
def test_a_camera_that_runs_is_seen_live_until_it_is_held() -> None:
    """Its pictures are never of one grey for long."""
    camera = Camera()
    album = Album((64, 48), {1: Running(camera, 0, (64, 48))})
    hello = msgspec.structs.replace(POLES, size=album.size, pictures=album.pictures)
    page = MarkingPage(hello, album.jpeg, free_port())
    page.show(Shown(Sheet((), {}), "", 0, Solved((Seen(False, ""),), ()), "", True))
    grey = "document.querySelector('#view').getContext('2d').getImageData(99, 99, 1, 1).data[0]"
    try:
        with open_tab(str(CHROMIUM), SOFT) as tab:
            looking = Looking(tab, page.address, SIZES["desk"])
            assert looking.until("document.body?.dataset.loaded === '1'")
            assert looking.until("!document.querySelector('#hold').hidden")
            first = looking.until(grey)
            assert looking.until(f"Math.abs({grey} - {first}) > 20")
            looking.ask("document.querySelector('#hold').click()")
            held = [looking.ask(grey)]
            while len(set(held[-3:])) > 1 or len(held) < 3:  # one may be on its way
                time.sleep(0.3)
                held.append(looking.ask(grey))
                assert len(held) < 60
            time.sleep(1.0)
            assert looking.ask(grey) == held[-1]
    finally:
        page.close()
        camera.stop()


@pytest.mark.slow
@needs_browser
def test_near_by_a_click_is_finer_and_drags_move_points_or_the_picture(tmp_path: Path) -> None:
    """The wheel comes nearer to what is under the pointer, which stays there."""
    with opened(tmp_path, "poles", "--out", str(tmp_path / "calibration.json")) as command:
        with clicking(command.address, SIZES["desk"]) as person:
            looking, tab = person.looking, person.looking.tab
            left, top, width, height = person.box("#view")
            inside = "(e => e.clientWidth + ',' + e.clientHeight)(document.querySelector('#view'))"
            drawn = [float(value) for value in looking.ask(inside).split(",")]  # rounded
            scale = min(drawn[0] / SIZE[0], drawn[1] / SIZE[1])
            x, y = round(left + width / 2 + 150 * scale), round(top + height / 2 - 100 * scale)
            middle = ((x - left - width / 2) / width, (y - top - height / 2) / height)
            under = [SIZE[n] / 2 + middle[n] * drawn[n] / scale for n in (0, 1)]

            def mouse(kind: str, dx: float = 0.0, dy: float = 0.0) -> None:
                held = {"button": "left", "buttons": 1, "clickCount": 1}
                tab.call("Input.dispatchMouseEvent", type=kind, x=x + dx, y=y + dy, **held)

            wheel = {"deltaX": 0, "deltaY": -416}  # e^(416/300): four times
            tab.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, **wheel)
            assert looking.until("document.querySelector('#whole').innerText === '4.0×'")
            person.press(x, y)
            assert looking.until("document.body.dataset.shown === '1'")
            assert person.chosen() == pytest.approx(under, abs=0.01)
            mouse("mousePressed")
            mouse("mouseMoved", 20.0, 8.0)
            mouse("mouseMoved", 40.0, -24.0)
            mouse("mouseReleased", 40.0, -24.0)
            there = [under[0] + 40 / (4 * scale), under[1] - 24 / (4 * scale)]
            assert person.chosen() == pytest.approx(there, abs=0.05)
            mouse("mousePressed", -200.0)
            mouse("mouseMoved", -150.0)
            mouse("mouseMoved", -100.0)
            mouse("mouseReleased", -100.0)
            moved_by_hand = person.chosen()
            assert moved_by_hand == pytest.approx(there, abs=0.05), "the picture moved, not it"
            person.press(x, y)
            assert looking.until("document.body.dataset.picked === '1'")
            left_of_it = (under[0] - 100 / (4 * scale), under[1])
            assert person.chosen() == pytest.approx(left_of_it, abs=0.05)
        command.ended()


@pytest.mark.slow
@needs_browser
def test_nothing_can_be_clicked_before_the_points_that_are_asked_for_are_known() -> None:
    """Or a click would put an empty sheet in the place of one that was kept."""
    album = Album((64, 48), {1: Running(Camera(), 0, (64, 48))})
    hello = msgspec.structs.replace(POLES, size=album.size, pictures=album.pictures)
    page = MarkingPage(hello, album.jpeg, free_port())
    prompt = "document.querySelector('#next').innerText"
    try:
        with open_tab(str(CHROMIUM), SOFT) as tab:
            looking = Looking(tab, page.address, SIZES["desk"])
            assert looking.until("document.querySelector('#words')?.innerText === 'ready'")
            time.sleep(0.5)
            looking.key("n")
            looking.key("Enter", 13)
            assert looking.ask(prompt) == ""
            assert looking.ask("document.querySelectorAll('#adding button').length") == 0
            assert page.next_wish() is None
            page.show(Shown(clicked_poles(), "", 0, Solved((Seen(False, ""),), ()), "", True))
            assert looking.until(f"{prompt}.startsWith('all points are there')")
    finally:
        page.close()
