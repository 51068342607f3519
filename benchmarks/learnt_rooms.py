"""How far the room of a clip that is never empty is from the true one, in grey levels (T7).

Run from the checkout: .venv/bin/python benchmarks/learnt_rooms.py CLIPS... [--size 160x120]

The first frames of each clip, which show the room, are withheld; both cameras count.
"""

import argparse
import os
from pathlib import Path
from typing import Final

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import cv2
import numpy as np

from common.config.settings import Settings
from common.video.clips import open_clip
from common.video.decoding import Decoder
from viewer.background.occluded_background import learn_uncovered

EMPTY: Final = 8
"""Frames at the start that show the room alone; the one after is left out too."""
EVERY: Final = 2
"""Of the others so many are looked at."""


def main() -> None:
    cv2.setNumThreads(1)
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="+", type=Path, help="clip folders that open empty")
    parser.add_argument("--size", default="160x120", help="of the working picture")
    given = parser.parse_args()
    off: list[float] = []
    with Decoder() as decoder:
        for path in given.clips:
            for view in open_clip(Settings(clip=str(path), size=given.size), decoder).views:
                film = [got.picture for got in decoder.frames(view.source, view.size)]
                true = np.median(film[:EMPTY], axis=0)
                room = learn_uncovered(film[EMPTY + 1 :: EVERY])
                off.append(float(np.abs(room.centre - true).mean(axis=2)[~room.uncertain].mean()))
                flagged = room.uncertain.mean()
                print(f"{path.name}, camera {view.number}: {off[-1]:.2f}, flagged {flagged:.3f}")
    print(f"{len(off)} views: mean {np.mean(off):.2f}, worst {max(off):.2f}")


if __name__ == "__main__":
    main()
