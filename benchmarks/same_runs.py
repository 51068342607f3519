"""Whether two checkouts give the same runs: every array of `poses.npz`, byte for byte.

    .venv/bin/python benchmarks/same_runs.py BEFORE AFTER CLIP... [--size 160x120 320x240]

Each clip is tracked by both checkouts, with this Python and its libraries, in every way below.
What differs, and what only the first writes, is named; the exit code is then 1. What only the
second writes is new, and no difference.
"""

import argparse
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

WAYS: Final = {
    "default": (),
    "paper": ("--mode", "paper"),
    "view 1": ("--views", "1"),
    "view 2": ("--views", "2"),
    "thesis": ("--mode", "thesis", "--views", "1"),
}
"""How each clip is tracked, by the options of `tritrack track`."""
AT_ONCE: Final = 20
"""Clips of one command: its start counts once."""


def tracked(checkout: Path, clips: Sequence[Path], options: Sequence[str], out: Path) -> None:
    """Track clips into run folders by what lies in a checkout."""
    command = [sys.executable, "-m", "tritrack", "track", *map(str, clips), "--out", str(out)]
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    done = subprocess.run(
        [*command, *options],
        cwd=checkout,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 3):  # 3: written, but hardly to be believed
        sys.exit(f"{checkout}: exit code {done.returncode}\n{done.stderr}")


def differences(before: Path, after: Path) -> Iterator[str]:
    """What differs in two run folders' poses."""
    with (
        np.load(before / "poses.npz", allow_pickle=False) as first,
        np.load(after / "poses.npz", allow_pickle=False) as second,
    ):
        for name in sorted(first.files):
            if name not in second.files:
                yield f"{name} is only in the first"
            elif (first[name].dtype, first[name].tobytes()) != (
                second[name].dtype,
                second[name].tobytes(),
            ):
                yield name


def main() -> None:
    """Compare, and print a line for each way and size."""
    asked = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    asked.add_argument("before", type=Path)
    asked.add_argument("after", type=Path)
    asked.add_argument("clips", type=Path, nargs="+")
    asked.add_argument("--size", nargs="+", default=["160x120", "320x240"])
    given = asked.parse_args()
    clips = [clip.resolve() for clip in given.clips if clip.is_dir()]
    odd = 0
    for size in given.size:
        for way, options in WAYS.items():
            same = 0
            for some in (clips[n : n + AT_ONCE] for n in range(0, len(clips), AT_ONCE)):
                with TemporaryDirectory() as folder:
                    outs = [Path(folder, name) for name in ("before", "after")]
                    for checkout, out in zip((given.before, given.after), outs, strict=True):
                        tracked(checkout.resolve(), some, [*options, "--size", size], out)
                    for clip in some:
                        found = list(differences(*(out / clip.name for out in outs)))
                        same += not found
                        if found:
                            print(f"  {clip.name}: {', '.join(found)}")
            odd += len(clips) - same
            print(f"{size} {way}: {same} of {len(clips)} runs are the same", flush=True)
    sys.exit(1 if odd else 0)


if __name__ == "__main__":
    main()
