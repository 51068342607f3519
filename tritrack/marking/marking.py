"""Markers or poles clicked on a page: its pictures, answers and files, until Ctrl-C."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
from rich.console import Console

from animator.marking.marking_page import MarkingPage
from animator.marking.sheet import Hello, Marked, Save, Sheet, SheetError, Shown, refuse_sheet
from animator.page.door import entrance_of, invitation_of
from animator.page.wish_page import Told
from calibration.paper.calibration import read_points, write_text
from calibration.paper.markers import Markers
from calibration.paper.poles import Poles
from common.bus.process import ProcessContext, process
from common.config import config_file
from common.config.part_settings import PageSettings
from common.rig.rig_file import CalibrationError
from tritrack.marking.marker_sheet import marker_method
from tritrack.marking.marking_method import MarkingMethod
from tritrack.marking.pole_sheet import pole_method
from tritrack.marking.stills import Album, open_album

LOOK_S: Final = 0.02
"""Interval at which browsers' messages are read, seconds."""
HEAD: Final = "# Points clicked on the page; the centre of the top-left pixel is (0.5, 0.5).\n\n"


class Asked(NamedTuple):
    """The command-line options."""

    clip: Path
    """A clip folder, or a settings file."""
    points: Path
    """The file of points, read and written."""
    port: int | None
    """Port of the page; None: the settings'."""


class KeptPoints(NamedTuple):
    """The file of points."""

    path: Path
    head: str
    """Remarks at its head."""


class Result(NamedTuple):
    """The result when the page is closed."""

    rows: Sequence[msgspec.Struct]
    """By camera; empty where the points do not suffice."""
    saved: Sheet | None
    """The points of the last written calibration."""
    newest: Sheet


def mark_markers(asked: Asked, console: Console) -> Result:
    """Show the page of the line markers until Ctrl-C.

    Raises:
        CalibrationError, ClipError, SettingsError, PageError, Undecodable, DecoderDied: When an
            input is unusable.
    """
    before = read_points(asked.points, Markers) if asked.points.exists() else None
    settings = config_file.load(asked.clip)
    with open_album(settings, console) as album:
        if before is not None:
            refuse_other_size(asked.points, before, album.size, bool(before.cameras))
        method = marker_method(album.size, before, tuple(album.views))
        return _serve(method, album, asked, settings.page, "", console)


def mark_poles(asked: Asked, out: Path, console: Console) -> Result:
    """Show the page of the poles until Ctrl-C; `out` is the calibration file that it saves.

    Raises:
        As `mark_markers`.
    """
    before = read_points(asked.points, Poles) if asked.points.exists() else None
    settings = config_file.load(asked.clip)
    with open_album(settings, console) as album:
        if len(album.views) < 2:
            raise CalibrationError(f"{asked.clip} has one view: poles are of two cameras")
        if before is not None:
            clicked = any(pole.cam1_px or pole.cam2_px for pole in before.poles)
            refuse_other_size(asked.points, before, album.size, clicked)
        method = pole_method(album.size, before, out)
        return _serve(method, album, asked, settings.page, out.name, console)


def refuse_other_size(
    path: Path, before: Markers | Poles, size: tuple[int, int], clicked: bool
) -> None:
    """Refuse points that belong to other pictures.

    Raises:
        CalibrationError: When there are points for pictures of another size.
    """
    if clicked and (before.width, before.height) != size:
        raise CalibrationError(
            f"{path} has points of {before.width}x{before.height} pictures, these have "
            "{}x{}: name another file to keep the points in".format(*size)
        )


def answered(method: MarkingMethod, marked: Marked, kept: KeptPoints) -> Shown:
    """The result of a sheet; its points are saved in the file once its numbers suffice."""
    sheet = marked.sheet
    try:
        write_text(kept.path, kept.head + method.text(sheet))
        told, well = f"points kept in {kept.path.name}", True
    except CalibrationError as error:
        told, well = f"points not kept yet: {error}", False
    return Shown(sheet, marked.by, marked.count, method.solve(sheet), told, well)


def kept_points(path: Path) -> KeptPoints:
    """The file of the points, with its existing remarks.

    Raises:
        CalibrationError: When it would be JSON, which has no remarks.
    """
    if path.suffix == ".json":
        raise CalibrationError(f"the page keeps points as TOML: name another file than {path}")
    if not path.exists():
        return KeptPoints(path, HEAD)
    lines = path.read_text("utf-8").splitlines(keepends=True)
    first = next((n for n, line in enumerate(lines) if line.strip() and line[0] != "#"), len(lines))
    return KeptPoints(path, "".join(lines[:first]))


def _serve(
    method: MarkingMethod,
    album: Album,
    asked: Asked,
    page_settings: PageSettings,
    writes: str,
    console: Console,
) -> Result:
    """The page, until Ctrl-C or a camera's end."""
    entrance = entrance_of(page_settings)
    port = asked.port or page_settings.port
    kept = kept_points(asked.points)
    hello = Hello(
        title=asked.clip.resolve().name,
        run=0,
        method=method.name,
        size=album.size,
        pictures=album.pictures,
        numbers=method.numbers,
        hints=method.hints,
        writes=writes,
    )
    shown = Shown(method.start, "", 0, method.solve(method.start), "nothing clicked yet", True)
    saved: Sheet | None = None
    with process("mark", ProcessContext()) as stop:
        page = MarkingPage(hello, album.jpeg, port, entrance)
        page.show(shown)
        address = invitation_of(entrance, port)
        console.print(f"the page is at {address}; Ctrl-C ends it", highlight=False, soft_wrap=True)
        try:
            while not stop.wait(LOOK_S):
                album.refuse_fault()
                shown, written = _hear(page, method, hello, shown, kept)
                saved = written or saved
        finally:
            page.close()
    return Result(method.rows(shown.sheet) if shown.solved.whole else (), saved, shown.sheet)


def _hear(
    page: MarkingPage, method: MarkingMethod, hello: Hello, shown: Shown, kept: KeptPoints
) -> tuple[Shown, Sheet | None]:
    """Process the browsers' requests; returns the present sheet, and that of the last written
    calibration."""
    saved = None
    try:
        while (wish := page.next_wish()) is not None:
            if isinstance(wish, Save):
                page.tell(Told(_written(method, shown.sheet, hello.writes), well=True))
                saved = shown.sheet
            else:
                refuse_sheet(wish.sheet, hello)
                shown = answered(method, wish, kept)
                page.show(shown)
    except (SheetError, CalibrationError) as error:
        page.tell(Told(str(error), well=False))
    return shown, saved


def _written(method: MarkingMethod, sheet: Sheet, name: str) -> str:
    if method.write is None:
        raise SheetError("markers give no whole calibration: there is nothing to save but points")
    method.write(sheet)
    return f"written to {name}"
