"""Checks of the installation: each item, its state, and the cure."""

import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final, NamedTuple

from rich.markup import escape
from rich.table import Table

from common.packages import PACKAGES, ROOT

REQUIRED = {
    "numpy": "numpy",
    "opencv-python-headless": "cv2",
    "eclipse-zenoh": "zenoh",
    "hmmlearn": "hmmlearn",
    "filterpy": "filterpy",
    "msgspec": "msgspec",
    "numba": "numba",
}
"""A distribution and its module."""

EXTRAS: Final = (
    ("live page", "viser", "page"),
    ("notes of the retouching page", "tomlkit", "page"),
    ("rooms of busy clips", "scikit-image", "single"),
    ("videos for browsers, sounds", "av", "video"),
    ("learning of postures", "scikit-learn", "learn"),
    ("plots of reports and of angles", "matplotlib", "report"),
    ("C3D files", "ezc3d", "export"),
    ("USD files", "usd-core", "usd"),
    ("recordings", "mcap", "mcap"),
    ("OSC and VMC bridges", "python-osc", "osc"),
    ("LSL bridge", "pylsl", "lsl"),
    ("metrics", "prometheus-client", "metrics"),
    ("keys of a bus", "cryptography", "keys"),
)
"""Optional packages: the use, the distribution, and the extra that installs it."""


class Finding(NamedTuple):
    """One checked item."""

    what: str
    ok: bool
    detail: str
    cure: str = ""
    needed: bool = True
    """False: tritrack works without it, with fewer features."""


def examine() -> list[Finding]:
    """Check all items, one after the other; a failed check does not stop the rest."""
    checks: list[Callable[[], Finding]] = [
        _python,
        *(
            lambda name=name, module=module: _package(name, module)
            for name, module in REQUIRED.items()
        ),
        _own_names,
        _kernel,
        _decoder,
        _bus,
        _model,
        *(lambda row=row: _extra(*row) for row in EXTRAS),
        _mediapipe,
        _browser,
        _cores,
    ]
    return [_tried(check) for check in checks]


def table_of(findings: list[Finding]) -> Table:
    """The findings as a table."""
    table = Table("", "what", "found", "what to do")
    for finding in findings:
        mark = (
            "[green]ok[/]"
            if finding.ok
            else "[red]missing[/]"
            if finding.needed
            else "[yellow]-[/]"
        )
        cure = "" if finding.ok else finding.cure
        table.add_row(mark, *map(escape, (finding.what, finding.detail, cure)))
    return table


def refused(what: str, error: Exception) -> Finding:
    """A check that raised an error, whose text is a fault and, after its last colon, the cure.

    Where there is a semicolon the cure begins after it.
    """
    text = str(error)
    detail, mark, cure = text.partition("; ") if "; " in text else text.rpartition(": ")
    return Finding(what, False, detail, cure) if mark else Finding(what, False, text, "mend that")


def _tried(check: Callable[[], Finding]) -> Finding:
    try:
        return check()
    except Exception as error:
        name = getattr(check, "__name__", "package").strip("_")
        return refused(name, error)


def _python() -> Finding:
    found = ".".join(str(part) for part in sys.version_info[:3])
    return Finding("python", sys.version_info >= (3, 11), found, "install Python 3.11 or newer")


def _package(name: str, module: str) -> Finding:
    try:
        import_module(module)
        return Finding(name, True, version(name))
    except (ImportError, PackageNotFoundError) as error:
        return Finding(name, False, str(error), f"pip install {name}")


def _own_names() -> Finding:
    """Other packages are named common or viewer: none of them may be found instead of ours."""
    places = {name: Path(str(import_module(name).__file__)).resolve() for name in PACKAGES}
    foreign = [name for name, place in places.items() if not place.is_relative_to(ROOT)]
    return Finding(
        "own packages",
        not foreign,
        ", ".join(foreign) or "all from one place",
        "another installed package has the same name: use a virtual environment of its own",
    )


def _kernel() -> Finding:
    from common.raster.kernel import warm

    return Finding("matching kernel", True, f"compiled or loaded in {warm():.1f} s")


def _decoder() -> Finding:
    import cv2
    import numpy as np

    from common.video.decoding import Decoder

    with tempfile.TemporaryDirectory() as folder, Decoder() as decoder:
        path = Path(folder) / "try.avi"
        writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 15, (64, 48))
        for _ in range(3):
            writer.write(np.zeros((48, 64, 3), np.uint8))
        writer.release()
        came = sum(1 for _ in decoder.frames(str(path), (64, 48)))
    return Finding(
        "video decoder", came == 3, f"{came} of 3 frames", "reinstall opencv-python-headless"
    )


def _bus() -> Finding:
    from common.bus.bus import open_client, open_hub
    from common.bus.control_messages import ClockAnswer, ClockQuestion
    from common.config.part_settings import BusSettings
    from runtime.live.free_ports import free_port

    settings = BusSettings(endpoint=f"tcp/127.0.0.1:{free_port()}")
    with open_hub(settings, "doctor") as hub, open_client(settings, "doctor", 5.0) as client:
        hub.answer(ClockQuestion, lambda _: ClockAnswer(now_s=1.0))
        heard = client.ask(ClockQuestion(viewer=1, ready=False), ClockAnswer, 2.0)
    cure = "allow programs to talk over 127.0.0.1"
    return Finding("bus on loopback", heard is not None, "answered" if heard else "silent", cure)


def _model() -> Finding:
    from recognizer.__main__ import SHIPPED
    from recognizer.model_file import load

    model = load(SHIPPED)
    return Finding("posture model", True, f"{len(model.names)} postures")


def _extra(use: str, package: str, extra: str) -> Finding:
    what = f"{use} ({package})"
    try:
        return Finding(what, True, version(package), needed=False)
    except PackageNotFoundError:
        return Finding(what, False, "not installed", f"pip install 'tritrack[{extra}]'", False)


def _mediapipe() -> Finding:
    from common.config.part_settings import SettingsError
    from common.video.clip_facts import ClipView
    from viewer.landmarks.mediapipe_source import INSTALL, MediaPipe

    what = "landmarks = 'mediapipe' (mediapipe)"
    try:
        with MediaPipe(ClipView(1, "", (64, 48), (64, 48), 15.0, 0)) as source:
            source.ready()
        return Finding(what, True, version("mediapipe"), needed=False)
    except (SettingsError, PackageNotFoundError) as error:
        why, _, _ = str(error).partition(f": {INSTALL}")
        return Finding(what, False, why, INSTALL, needed=False)


def _browser() -> Finding:
    path = (
        shutil.which("chromium")
        or shutil.which("chromium-browser")
        or shutil.which("google-chrome")
    )
    detail = path or "none: only the browser tests need one"
    return Finding("browser", path is not None, detail, "install chromium", needed=False)


def _cores() -> Finding:
    cores = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )
    return Finding("cores", cores >= 2, str(cores), "a live run wants two", needed=False)
