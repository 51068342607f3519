"""Whether anything grows or slows down in hours: memory, open files, log, milliseconds a frame.

Run from the checkout: .venv/bin/python benchmarks/soak.py [--frames 1000000 | --live MINUTES]
[--seconds N] [--json] [--plot FILE]. A made-up take of two cameras is played again and again:
through the steps of both viewers, the integrator and the recogniser in one process, or as a live
run at 15 frames a second.
"""

import argparse
import gc
import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import count, cycle
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
import psutil
from rich.console import Console
from threadpoolctl import threadpool_limits

from common.bus.instant import Instant
from common.bus.message_codec import decode, encode
from common.bus.messages import Body, Guide, View, ViewerNumber
from common.bus.process import settle
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from common.method import METHODS
from common.video.clip_facts import Clip
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import Image
from integrator import merge, merge_state
from integrator.merge_state import Start
from recognizer import __main__ as recognizer_process
from runtime.live.free_ports import free_settings
from runtime.live.launch import Heard
from runtime.live.session import live
from synth.write import ClipSet, write_set
from viewer import track
from viewer.captured_frame import CapturedFrame
from viewer.room.background_source import opening_of_view

HZ: Final = 15.0
SIZE: Final = (160, 120)
SAMPLES: Final = 200
SAMPLE_FRAMES: Final = 1000
"""At most so many are between two samples of steps: who stops early has enough of them."""
LIVE_SAMPLE_S: Final = 5.0
SETTLED: Final = 0.33
"""What comes before this share of the samples counts as warming up."""
CAMERAS: Final[tuple[ViewerNumber, ...]] = (1, 2)


class Sample(NamedTuple):
    """How it was at a moment; of live runs over all processes."""

    at_s: float
    """Of the stream: at 15 frames a second."""
    memory_mb: float
    handles: int
    threads: int
    ms: float
    """Of steps: processor time of a frame since the last sample, which other work on the machine
    does not lengthen by its own. Live: the integrator's p99 from capture on."""
    log_bytes: int = 0


def sample_of(processes: Sequence[psutil.Process], at_s: float, ms: float, log: int = 0) -> Sample:
    """These processes now; one that has just ended counts nothing."""
    memory_mb, handles, threads = 0.0, 0, 0
    for one in processes:
        try:
            with one.oneshot():
                memory_mb += one.memory_info().rss / 1e6
                handles += one.num_fds()
                threads += one.num_threads()
        except psutil.Error:
            continue
    return Sample(at_s, memory_mb, handles, threads, ms, log)


def made_clip(folder: Path) -> Path:
    """A take of somebody who walks and raises the arms, of two cameras."""
    return write_set(folder, ClipSet("postures", postures=("walk_slow_bigswing",)), SIZE)[0]


class Steps:
    """Viewers, integrator and recogniser, as a live run has them, without processes and clocks."""

    def __init__(self, clip: Clip, settings: Settings) -> None:
        """Before the first frame."""
        method = METHODS[settings.mode]
        self.films: dict[ViewerNumber, list[Image]] = {}
        self.viewers: dict[ViewerNumber, track.State] = {}
        for view in clip.views:
            with Decoder() as decoder:
                background = opening_of_view(view, settings.silhouette, decoder).background
                pictures = decoder.frames(view.source, view.size)
                self.films[view.number] = [got.picture for got in pictures]
            camera = clip.rig.cameras[view.number - 1] if clip.rig else None
            setup = track.Setup(view.number, camera, settings, method, False)
            self.viewers[view.number] = track.init(setup, background)
        self.integrator = merge_state.init(clip.rig, 1.0 / HZ, settings, method, Start(False))
        model = recognizer_process.model_of(settings)
        self.recogniser = recognizer_process.init(model, settings.recognizer.window_frames)
        self.guide: Guide | None = None

    def see(self, index: int, pictures: dict[ViewerNumber, Image]) -> Body:
        """One instant, each message encoded and decoded as on the bus."""
        at_s, reports = index / HZ, {}
        for number in CAMERAS:
            frame = CapturedFrame(index, at_s, at_s, pictures[number])
            viewer, report = track.step(self.viewers[number], frame, self.guide)
            self.viewers[number] = viewer
            reports[number] = decode(encode(report), View)
        pair = Instant((reports[1], reports[2]))
        self.integrator, body, guide = merge.step(self.integrator, pair)
        self.guide = decode(encode(guide), Guide)
        heard = decode(encode(body), Body)
        self.recogniser, _ = recognizer_process.step(self.recogniser, heard)
        return heard

    def instants(self) -> Iterator[dict[ViewerNumber, Image]]:
        """The take forwards and backwards, for ever."""
        order = range(len(self.films[1]))
        for place in cycle([*order, *reversed(order)]):
            yield {number: self.films[number][place] for number in CAMERAS}


def soaked(frames: int, seconds: float, folder: Path) -> list[Sample]:
    """So many frames through the steps, or as many as fit into so many seconds."""
    settings = Settings(clip=str(made_clip(folder)))
    steps, own = Steps(open_clip(settings), settings), psutil.Process()
    every = max(1, min(frames // SAMPLES, SAMPLE_FRAMES))
    settle()
    found: list[Sample] = []
    began_s, since_s = time.perf_counter(), time.process_time()
    with suppress(KeyboardInterrupt):  # what there is until then is told
        for index, pictures in zip(count(), steps.instants(), strict=False):
            if index == frames or time.perf_counter() - began_s > seconds:
                break
            steps.see(index, pictures)
            if (index + 1) % every == 0:
                gc.collect()
                took_s = time.process_time() - since_s
                found.append(sample_of([own], index / HZ, 1e3 * took_s / every))
                since_s = time.process_time()
    return found


def lived(minutes: float, folder: Path) -> tuple[list[Sample], dict[str, Any]]:
    """A live run of so many minutes, and what its summary tells."""
    clip = made_clip(folder)
    lengthened(clip, minutes)
    settings = free_settings(Settings(clip=str(clip), page=PageSettings(port=0)))
    out, own = folder / "out", psutil.Process()
    found: list[Sample] = []

    def tell(heard: Heard) -> None:
        hub = heard.pulses.get("integrator")
        at_s = found[-1].at_s if found else -LIVE_SAMPLE_S
        if hub is None or hub.state != "running" or hub.frames / HZ < at_s + LIVE_SAMPLE_S:
            return
        everybody = [own, *own.children(recursive=True)]
        log = (out / "log.txt").stat().st_size
        found.append(sample_of(everybody, hub.frames / HZ, hub.latency_p99_ms, log))

    facts = live(settings, out, Console(quiet=True), tell=tell)
    return found, facts


def lengthened(clip: Path, minutes: float) -> None:
    """Play both films of a clip forwards and backwards for so long."""
    meta = clip / "meta.json"
    meta.write_text(json.dumps({**json.loads(meta.read_text()), "fps": HZ}))
    for path in sorted(clip.glob("cam*.avi")):
        with Decoder() as decoder:
            film = [got.picture for got in decoder.frames(str(path), SIZE)]
        writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), HZ, SIZE)
        for index, picture in enumerate(cycle([*film, *reversed(film)])):
            if index >= 60 * HZ * minutes:
                break
            writer.write(picture)
        writer.release()


def verdict(found: Sequence[Sample]) -> dict[str, Any]:
    """What grew, from when it had warmed up to the end."""
    settled = found[int(SETTLED * len(found)) :]
    hours = np.array([one.at_s for one in settled]) / 3600.0
    slope = np.polyfit(hours, [one.memory_mb for one in settled], 1)[0]
    third = max(1, len(settled) // 3)
    first, last = settled[:third], settled[-third:]
    return {
        "frames": round(found[-1].at_s * HZ) + 1,
        "hours of the stream": round(found[-1].at_s / 3600.0, 2),
        "memory MB": [round(settled[0].memory_mb, 1), round(settled[-1].memory_mb, 1)],
        "MB an hour": round(float(slope), 2),
        "handles": [settled[0].handles, settled[-1].handles],
        "threads": [settled[0].threads, settled[-1].threads],
        "ms": [round(float(np.median([one.ms for one in each])), 2) for each in (first, last)],
        "log bytes": [settled[0].log_bytes, settled[-1].log_bytes],
    }


def plot(found: Sequence[Sample], path: Path) -> None:
    """Draw memory, open files and milliseconds over the hours of the stream."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 5.6), layout="constrained")
    hours = [one.at_s / 3600.0 for one in found]
    drawn: dict[str, list[float]] = {
        "memory, MB": [one.memory_mb for one in found],
        "open files": [float(one.handles) for one in found],
        "ms a frame": [one.ms for one in found],
    }
    for axes, (name, values) in zip(figure.subplots(3, 1, sharex=True), drawn.items(), strict=True):
        axes.plot(hours, values, ".-", markersize=3, linewidth=0.8)
        axes.set_ylabel(name)
        axes.set_ylim(0.0, 1.15 * max(values))
        axes.grid(alpha=0.3)
    axes.set_xlabel("hours of the stream")
    figure.savefig(path, dpi=110)


def main(arguments: Sequence[str] | None = None) -> None:
    """Soak, print what grew."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=1_000_000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--live", type=float, default=0.0, metavar="MINUTES")
    parser.add_argument("--json", action="store_true", help="Every sample too.")
    parser.add_argument("--plot", type=Path, metavar="FILE")
    given = parser.parse_args(arguments)
    told: dict[str, Any] = {}
    with tempfile.TemporaryDirectory(prefix="tritrack-soak-") as folder:
        if given.live:
            found, facts = lived(given.live, Path(folder))
            told["processes"] = facts["processes"]
        else:
            found = soaked(given.frames, given.seconds, Path(folder))
    told = {**verdict(found), **told}
    if given.plot:
        plot(found, given.plot)
    if given.json:
        told["samples"] = [one._asdict() for one in found]
    print(json.dumps(told, indent=1))


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
