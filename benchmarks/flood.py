"""What a live run loses while somebody on its bus, who has no keys, floods it with large messages.

Run from the checkout: .venv/bin/python benchmarks/flood.py [--only FLOOD...] [--json]
"""

import argparse
import json
import os
import tempfile
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import zenoh
from rich.console import Console

from common.bus.live_bus import NUMBER_BYTES
from common.bus.message_codec import MAX_BYTES
from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from runtime.live.free_ports import free_settings
from runtime.live.session import live
from runtime.live.table import table_of_rows
from runtime.store.past_run import open_run
from tritrack import demo

HZ: Final = 15.0
WORD: Final = "overheard"
"""The word of the run, which the flood has or lacks."""
REPORTS: Final = "tritrack/room/viewer/1/report"


class Flood(NamedTuple):
    """What is said, fifteen times a second."""

    name: str
    key: str = REPORTS
    size: int = 0
    """Bytes of each message; 0: nothing is said."""
    has_word: bool = False
    times: int = 1
    """Messages each time."""


FLOODS: Final = (
    Flood("nothing"),
    Flood("2 MB on the reports' key", size=2_000_000),
    Flood("2 MB there, with the run's word", size=2_000_000, has_word=True),
    Flood("1 MB there, taken in by Zenoh", size=MAX_BYTES + 1),
    Flood("the same with the run's word", size=MAX_BYTES + 1, has_word=True),
    Flood("1 MB that is decoded, with the word", size=MAX_BYTES, has_word=True),
    Flood("2 MB on a key that nobody hears", key="tritrack/room/nothing", size=2_000_000),
    Flood("100 of 1 kB on the reports' key", size=1000, times=100),
)


class Outcome(NamedTuple):
    """What came of a run that was flooded."""

    name: str
    flooded: int
    """Messages that were sent while it ran."""
    said: int
    """Reports of both viewers."""
    skipped: int
    """Frames that the viewers had no time for."""
    lost: int
    """Reports that never came to the integrator, by their numbers."""
    late: int
    """Reports that came when their instant was merged: a want of cores, not of room on the bus."""
    missing: int
    """Frames of the clip without a row in the run."""
    foreign: int
    """Messages that the integrator dropped since they lacked the run's word."""
    malformed: int
    """Those that it dropped since they are none."""
    p99_ms: float
    """From capture to the body."""
    memory_mb: float
    """Of the integrator at its end."""


def flooded(clip: Path, folder: Path, flood: Flood, **changes: Any) -> Outcome:
    """A live run on a clip, flooded from its start to its end.

    Args:
        clip: Folder of a clip.
        folder: Empty; for the run.
        flood: Is said meanwhile.
        changes: Of the settings.
    """
    bus = BusSettings(endpoint="auto", session=WORD)
    page = PageSettings(port=0)
    settings = free_settings(Settings(clip=str(clip), page=page, bus=bus, **changes))
    over, sent = threading.Event(), [0]
    pouring = threading.Thread(target=pour, args=(settings.bus.endpoint, flood, over, sent))
    pouring.start()
    try:
        facts = live(settings, folder, Console(quiet=True))
    finally:
        over.set()
        pouring.join()
    hub, viewers = (
        facts["processes"]["integrator"],
        [told for name, told in facts["processes"].items() if name.startswith("viewer")],
    )
    said = sum(viewer["frames"] for viewer in viewers)
    frames = max(viewer["frames"] + viewer["dropped"] for viewer in viewers)
    return Outcome(
        flood.name,
        sent[0],
        said,
        sum(viewer["dropped"] for viewer in viewers),
        hub["dropped"],
        hub["late"],
        frames - len(open_run(folder).poses["frame"]),
        hub["foreign"],
        hub["malformed"],
        hub["latency_p99_ms"],
        hub["memory_mb"],
    )


def pour(endpoint: str, flood: Flood, over: threading.Event, sent: list[int]) -> None:
    """Say it until the run is over, as a program that found the bus; counts what is sent."""
    session = entered(endpoint, over)
    if session is None or not flood.size:
        return
    payload = b"x" * flood.size
    number = 0
    with session:
        while not over.wait(1.0 / HZ):
            for _ in range(flood.times):
                number += 1
                word = number.to_bytes(NUMBER_BYTES, "big") + WORD.encode()
                session.put(flood.key, payload, attachment=word if flood.has_word else None)
                sent[0] += 1


def entered(endpoint: str, over: threading.Event) -> zenoh.Session | None:
    """A session on a run's bus, once that is there."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    while not over.is_set():
        try:
            return zenoh.open(config)
        except zenoh.ZError:
            time.sleep(0.1)
    return None


def main(arguments: Sequence[str] | None = None) -> None:
    """Make a clip, flood a run on it in every way, print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="*", choices=[flood.name for flood in FLOODS])
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args(arguments)
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory(prefix="tritrack-flood-") as folder:
        clip = demo.made_clip(Path(folder))
        for number, flood in enumerate(FLOODS):
            if given.only is None or flood.name in given.only:
                rows.append(flooded(clip, Path(folder) / str(number), flood)._asdict())
                Console(stderr=True).print(" | ".join(str(value) for value in rows[-1].values()))
    print(json.dumps(rows, indent=1)) if given.json else Console(width=160).print(
        table_of_rows(rows)
    )


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
