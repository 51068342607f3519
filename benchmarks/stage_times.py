"""Where a frame's milliseconds go: processor time of each stage from two pictures to a posture.

Run from the checkout: .venv/bin/python benchmarks/stage_times.py CLIP... [--size 320x240]. All
stages run in one process, one after the other, on one core; what a live run adds, the ways between
processes and waiting for a core, is not in it. "critical path" is what a posture waits for: the
slower viewer, and all that follows it but the search for people, which is made after the report.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from rich.console import Console
from soak import CAMERAS, HZ, Steps
from threadpoolctl import threadpool_limits

from common.bus.instant import Instant
from common.bus.message_codec import decode, encode
from common.bus.messages import Body, Guide, View
from common.bus.process import settle
from common.config.settings import Settings
from common.video.clips import open_clip
from integrator import merge
from recognizer import __main__ as recognizer_process
from runtime.live.table import table_of_rows
from viewer import track
from viewer.captured_frame import CapturedFrame

STAGES: Final = (
    *("viewer 1", "viewer 2", "reports coded", "integrator", "body coded", "recogniser"),
    "people searched",
)
WARM: Final = 15
"""Frames of each clip that are not counted: in these the body is measured, once a run."""


def main() -> None:
    """Time all clips, print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="+", type=Path)
    parser.add_argument("--size", default="320x240")
    given = parser.parse_args()
    cv2.setNumThreads(1)
    taken = [row for clip in given.clips for row in list(timed(clip, given.size))[WARM:]]
    ms = 1e3 * np.array(taken)
    path = np.maximum(ms[:, 0], ms[:, 1]) + ms[:, 2:-1].sum(axis=1)
    rows = [
        {"ms of": name, "p50": _at(values, 50), "p90": _at(values, 90), "p99": _at(values, 99)}
        for name, values in zip([*STAGES, "critical path"], [*ms.T, path], strict=True)
    ]
    Console().print(table_of_rows(rows))
    Console().print(f"{len(ms)} frames")


def timed(clip: Path, size: str) -> Iterator[list[float]]:
    """Seconds of processor time of each of STAGES, frame by frame."""
    settings = Settings(clip=str(clip), size=size)
    steps = Steps(open_clip(settings), settings)
    settle()
    for index, pictures in enumerate(zip(steps.films[1], steps.films[2], strict=False)):
        at = [time.thread_time()]
        reports = []
        for number, picture in zip(CAMERAS, pictures, strict=True):
            frame = CapturedFrame(index, index / HZ, index / HZ, picture)
            viewer, report = track.step(steps.viewers[number], frame, steps.guide)
            steps.viewers[number] = viewer
            reports.append(report)
            at.append(time.thread_time())
        first, second = (decode(encode(report), View) for report in reports)
        at.append(time.thread_time())
        steps.integrator, body, guide = merge.step(steps.integrator, Instant((first, second)))
        at.append(time.thread_time())
        steps.guide, heard = decode(encode(guide), Guide), decode(encode(body), Body)
        at.append(time.thread_time())
        steps.recogniser, _ = recognizer_process.step(steps.recogniser, heard)
        at.append(time.thread_time())
        for number, viewer in steps.viewers.items():
            steps.viewers[number] = track.finished(viewer)
        at.append(time.thread_time())
        yield np.diff(at).tolist()


def _at(values: np.ndarray, percent: float) -> str:
    return f"{np.percentile(values, percent):.2f}"


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
