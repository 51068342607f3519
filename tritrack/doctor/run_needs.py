"""Checks of a live run's needs on this machine: ports, pictures, disk, clock."""

import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from common.config.settings import Settings
from common.method import METHODS
from common.video.clips import open_clip
from runtime.live.free_ports import refuse_held_endpoint, refuse_held_metrics, refuse_held_page
from runtime.steps.method_cameras import (
    refuse_everyone_unmeasured,
    refuse_too_many,
    refuse_uncalibrated,
)
from tritrack.doctor.installation import Finding, refused

LEAST_BYTES: Final = 1 << 30
"""Disk space for an hour of recording, bytes: both silhouettes at 320x240, 9.6 kB each, at 15
Hz."""
ZONE_S: Final = 86_400.0
"""Tolerance of dates, as unpacked files may have another time zone."""


def examine_run(settings: Settings, out: Path) -> list[Finding]:
    """Check all items, one after the other; a failed check does not stop the rest.

    Args:
        settings: The run's settings.
        out: The run's folder.
    """
    looks: list[tuple[str, Callable[[], str | None]]] = [
        ("port of the bus", lambda: refuse_held_endpoint(settings)),
        ("port of the page", lambda: refuse_held_page(settings)),
        ("pictures", lambda: _pictures(settings)),
    ]
    if settings.metrics:
        looks.insert(2, ("port of the metrics", lambda: refuse_held_metrics(settings.metrics)))
    return [*(_looked(what, look) for what, look in looks), _disk(out), _clock(time.time())]


def _looked(what: str, look: Callable[[], str | None]) -> Finding:
    try:
        return Finding(what, True, look() or "free")
    except Exception as error:
        return refused(what, error)


def _pictures(settings: Settings) -> str:
    """Each camera or video is opened."""
    clip = open_clip(settings)
    refuse_too_many(clip, METHODS[settings.mode])
    refuse_uncalibrated(clip)
    refuse_everyone_unmeasured(clip, settings)
    views = ", ".join(
        f"view {view.number}: {view.source_size[0]}x{view.source_size[1]}, {view.fps:.4g} a second"
        for view in clip.views
    )
    return (
        f"{views}; {'calibrated' if clip.rig else 'no calibration: it is computed from the person'}"
    )


def _disk(out: Path) -> Finding:
    place = next(path for path in (out.resolve(), *out.resolve().parents) if path.exists())
    free = shutil.disk_usage(place).free
    detail = f"{free / 1e9:.1f} GB free at {place}"
    return Finding("disk", free >= LEAST_BYTES, detail, "free 1 GB, or name another --out")


def _clock(now_s: float) -> Finding:
    """A clock that was never set is earlier than all installed files."""
    made_s = Path(__file__).stat().st_mtime
    shown = time.strftime("%Y-%m-%d %H:%M", time.localtime(now_s))
    cure = "set this host's clock: it shows a time before tritrack was installed, and keys go by it"
    return Finding("clock", now_s > made_s - ZONE_S, shown, cure)
