"""A live run from its settings to its run folder."""

import logging
import signal
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import msgspec
from rich.console import Console
from rich.live import Live as LiveDisplay

from common.clips import Clip, open_clip
from common.config import BusSettings, PageSettings, Settings
from common.messages import Posture, Pulse
from common.process import Place
from tritrack.launch import Heard, live_parts, run
from tritrack.offline import both_cameras
from tritrack.runs import write_postures, write_run
from tritrack.table import table_of

log = logging.getLogger(__name__)


def live(settings: Settings, out: Path, console: Console) -> dict[str, Any]:
    """Run the processes on a clip or on cameras until it ends or Ctrl-C; write the run folder.

    Returns:
        What the run's summary tells.

    Raises:
        ClipError, PartFailed, BusError, RunError: When something cannot be worked with; what was
            tracked until then is written first.
    """
    clip = open_clip(settings)
    for warning in clip.warnings:
        console.print(f"[yellow]warning:[/] {warning}")
    clip = msgspec.structs.replace(clip, rig=both_cameras(clip))
    place = Place(supervised=True, log=out / "log.txt")
    parts = live_parts(settings, clip, place)
    names = [part.name for part in parts]
    title = f"{clip.name}: {settings.mode} mode, {clip.views[0].fps / clip.every:g} frames a second"
    began = time.monotonic()
    heard = Heard([], [], {}, [])
    announced = False

    with (
        _stopped_by_signals() as stop,
        LiveDisplay(table_of(names, {}, title), console=console, refresh_per_second=4) as display,
    ):

        def show(pulses: dict[str, Pulse]) -> None:
            nonlocal announced
            page = pulses.get("animator")
            if page is not None and page.detail and not announced:
                display.console.print(f"the page: [link]{page.detail}[/link]")
                announced = True
            display.update(table_of(names, pulses, title))

        try:
            run(parts, settings, stop, show, heard)
        finally:
            facts = _facts(heard, clip, time.monotonic() - began)
            write_run(out, heard.bodies, settings, facts)
            write_postures(out, heard.postures, performed(heard.postures))
    return facts


def performed(postures: list[Posture]) -> str:
    """The posture of a whole clip: the last name given, by a window that saw most of it."""
    return next((posture.name for posture in reversed(postures) if posture.name), "")


def free_settings(settings: Settings) -> Settings:
    """The same settings with an endpoint and a page on ports that nobody holds."""
    bus, page = _free_port(), _free_port()
    return msgspec.structs.replace(
        settings,
        bus=BusSettings(endpoint=f"tcp/127.0.0.1:{bus}"),
        page=PageSettings(port=page) if settings.page.port else settings.page,
    )


def _facts(heard: Heard, clip: Clip, seconds: float) -> dict[str, Any]:
    source = heard.cameras[-1].scale_source if heard.cameras else None
    warnings = [*clip.warnings]
    warnings += [
        pulse.detail
        for name, pulse in sorted(heard.pulses.items())
        if name.startswith("viewer") and pulse.detail
    ]
    return {
        "clip": clip.name,
        "performer": clip.meta.performer,
        "posture_meant": clip.meta.posture,
        "seconds": {"all": round(seconds, 3)},
        "scale_source": source,
        "posture": performed(heard.postures),
        "warnings": warnings,
        "processes": {
            name: {
                key: round(value, 3) if isinstance(value, float) else value
                for key, value in msgspec.to_builtins(pulse).items()
                if key not in ("protocol", "process", "detail")
            }
            for name, pulse in sorted(heard.pulses.items())
        },
    }


@contextmanager
def _stopped_by_signals() -> Iterator[threading.Event]:
    stop = threading.Event()

    def end(_number: int, _frame: FrameType | None) -> None:
        stop.set()

    before = {number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _free_port() -> int:
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))
        return int(door.getsockname()[1])
