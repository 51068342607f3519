"""How many rooms of two cameras one machine serves: missed deadlines, processor, memory, latency.

Run from the checkout: .venv/bin/python benchmarks/rooms.py [--rooms 1 2 5 10] [--size 160x120 ...]
[--seconds 20] [--together] [--json] [--plot FILE]. Each room plays a made-up take of its own, 15
frames a second.
"""

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final, NamedTuple

import psutil
from prometheus_client.parser import text_string_to_metric_families
from rich.console import Console

from common.config.picture_size import size_of
from runtime.live.table import table_of_rows
from synth.write import ClipSet, write_set

SETTLE_S: Final = 5.0
"""After the last room runs: what comes late from the starts is over then."""
PATIENCE_S: Final = 240.0
END_S: Final = 60.0
SITE: Final = """
[[site]]
name = "room_{number}"
together = {together}
[site.settings]
clip = "{clip}"
size = "{size}"
page = {{ port = 0 }}
bus = {{ endpoint = "auto" }}
"""


class Wanted(NamedTuple):
    """What is to be served."""

    clip: Path
    size: str
    rooms: int
    seconds: float
    together: bool
    """The parts of a room are one process."""


class Served(NamedTuple):
    """What so many rooms took, over the time that was measured."""

    size: str
    rooms: int
    running: int
    """Rooms that ran when the measurement began, at the latest four minutes after the start."""
    fps: float
    """Bodies a second and room, of 15."""
    missed_percent: float
    """Of the frames of all processes, those whose work ended more than a frame late."""
    hurried_percent: float
    """Of the viewers' frames, those that came too late for a look at more than their outline."""
    p50_ms: float
    """From capture to the body, the median of the rooms' own over their last half minute."""
    p99_ms: float
    """The same, of the slowest room."""
    cores: float
    """Processor time a second, of all processes."""
    pss_mb: float
    """Memory a room: what processes share is counted once."""
    load: float
    """Of the machine, a minute's average; others work there too."""


class Reading(NamedTuple):
    """What was counted so far."""

    at_s: float
    cpu_s: dict[int, float]
    """By process."""
    bodies: float
    missed: float
    hurried: float


def served(wanted: Wanted) -> Served:
    """Serve so many rooms for a while."""
    rooms = wanted.rooms
    with tempfile.TemporaryDirectory() as folder, _service(Path(folder), wanted) as (own, address):
        running = _until_running(own, address, rooms)
        time.sleep(SETTLE_S)
        before = _read(own, address)
        time.sleep(wanted.seconds)
        after, samples = _read(own, address), _samples(address)
        took_s = after.at_s - before.at_s
        bodies = after.bodies - before.bodies
        p50, p99 = (
            sorted(
                value
                for name, labels, value in samples
                if name == "tritrack_recent_latency_seconds" and labels["quantile"] == quantile
            )
            for quantile in ("0.5", "0.99")
        )
        pss = sum(_pss(each) for each in own.children(recursive=True))
        return Served(
            size=wanted.size,
            rooms=rooms,
            running=running,
            fps=bodies / took_s / rooms,
            missed_percent=100.0 * (after.missed - before.missed) / max(4 * bodies, 1.0),
            hurried_percent=100.0 * (after.hurried - before.hurried) / max(2 * bodies, 1.0),
            p50_ms=1000.0 * p50[len(p50) // 2] if p50 else 0.0,
            p99_ms=1000.0 * p99[-1] if p99 else 0.0,
            cores=sum(s - before.cpu_s.get(pid, 0.0) for pid, s in after.cpu_s.items()) / took_s,
            pss_mb=pss / rooms / 1e6,
            load=os.getloadavg()[0],
        )


@contextmanager
def _service(folder: Path, wanted: Wanted) -> Iterator[tuple[psutil.Process, str]]:
    """`tritrack serve` and its address."""
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{door.getsockname()[1]}"
    sites = (
        SITE.format(
            number=n,
            clip=wanted.clip,
            size=wanted.size,
            together=str(wanted.together).lower(),
        )
        for n in range(1, wanted.rooms + 1)
    )
    (folder / "sites.toml").write_text(f'metrics = "{address}"\n{"".join(sites)}')
    command = [sys.executable, "-m", "tritrack", "serve", str(folder / "sites.toml")]
    own = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield psutil.Process(own.pid), address
    finally:
        own.send_signal(signal.SIGTERM)
        try:
            own.wait(END_S)
        except subprocess.TimeoutExpired:
            own.kill()
            own.wait()


def _until_running(own: psutil.Process, address: str, rooms: int) -> int:
    """Wait until all rooms run, or for so long; how many do."""
    until_s = time.monotonic() + PATIENCE_S
    running = 0
    while running < rooms and time.monotonic() < until_s and own.is_running():
        time.sleep(0.5)
        running = _asked(address, "/healthz").count(": running,")
    return running


def _asked(address: str, path: str) -> str:
    try:
        with urllib.request.urlopen(f"http://{address}{path}", timeout=10) as answer:
            return str(answer.read().decode())
    except urllib.error.HTTPError as error:
        return str(error.read().decode())
    except OSError:
        return ""


def _samples(address: str) -> list[tuple[str, dict[str, str], float]]:
    families = text_string_to_metric_families(_asked(address, "/metrics"))
    return [(one.name, one.labels, one.value) for each in families for one in each.samples]


def _read(own: psutil.Process, address: str) -> Reading:
    found = _samples(address)

    def total(wanted: str) -> float:
        return sum(value for name, _, value in found if name == wanted)

    cpu_s = {each.pid: _cpu_s(each) for each in [own, *own.children(recursive=True)]}
    missed, hurried = (
        total(f"tritrack_{name}_total") for name in ("missed_deadlines", "hurried_frames")
    )
    return Reading(time.monotonic(), cpu_s, total("tritrack_frames_total"), missed, hurried)


def _cpu_s(one: psutil.Process) -> float:
    try:
        times = one.cpu_times()
    except psutil.Error:
        return 0.0
    return float(times.user + times.system)


def _pss(one: psutil.Process) -> float:
    try:
        return float(one.memory_full_info().pss)
    except psutil.Error:
        return 0.0


def plot(found: Sequence[Served], path: Path) -> None:
    """Draw misses, latency, processor and memory over the number of rooms, a line for each size."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 5.6), layout="constrained")
    shown = {
        "missed_percent": "missed deadlines, %",
        "p99_ms": "p99, ms",
        "cores": "cores",
        "pss_mb": "MB a room",
    }
    drawn = zip(figure.subplots(2, 2).flat, shown.items(), strict=True)
    for axes, (name, said) in drawn:
        for size in dict.fromkeys(one.size for one in found):
            own = [one for one in found if one.size == size]
            axes.plot([o.rooms for o in own], [getattr(o, name) for o in own], ".-", label=size)
        axes.set(xlabel="rooms", ylabel=said, ylim=(0.0, None))
        axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=110)


def main() -> None:
    """Serve more and more rooms, and show what it took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, nargs="+", default=[1, 2, 5, 10])
    parser.add_argument("--size", nargs="+", default=["160x120", "320x240"])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--together", action="store_true", help="one process a room")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--plot", type=Path, help="a picture of it (needs matplotlib)")
    given = parser.parse_args()
    found: list[Served] = []
    with tempfile.TemporaryDirectory() as folder:
        for size in given.size:
            (clip,) = write_set(Path(folder, size), ClipSet("stream", seed=90_010), size_of(size))
            for rooms in given.rooms:
                wanted = Wanted(clip, size, rooms, given.seconds, given.together)
                found.append(served(wanted))
                print(found[-1], file=sys.stderr, flush=True)
    if given.plot:
        plot(found, given.plot)
    rows = [one._asdict() for one in found]
    if given.json:
        print(json.dumps(rows, indent=1))
    else:
        Console().print(table_of_rows(rows))


if __name__ == "__main__":
    main()
