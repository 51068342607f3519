"""The sound of a video, by the program ffmpeg where there is one."""

import shutil
import subprocess
from pathlib import Path
from typing import Final

import numpy as np

from common.body.body import Vector

RATE_HZ: Final = 8_000
"""Sample rate to which a sound is brought."""
PATIENCE_S: Final = 60.0
"""Seconds after which a program that still reads is given up."""
LONGEST_S: Final = 600.0
"""Seconds of a sound that are read: more tell no more."""


def has_program() -> bool:
    """Whether sounds can be read on this machine."""
    return shutil.which("ffmpeg") is not None


def sound_of(video: Path) -> Vector | None:
    """The sound of a video, (n,) samples at RATE_HZ from the beginning of its pictures.

    None where it has none, or where there is no program to read it.
    """
    program = shutil.which("ffmpeg")
    if program is None:
        return None
    asked = [program, "-v", "error", "-nostdin", "-protocol_whitelist", "file,pipe"]
    asked += ["-i", f"file:{video}", "-map", "0:a:0", "-t", f"{LONGEST_S:.0f}", "-ac", "1"]
    asked += ["-af", f"aresample={RATE_HZ}:async=1:first_pts=0", "-f", "f32le", "pipe:1"]
    try:
        told = subprocess.run(asked, capture_output=True, timeout=PATIENCE_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    samples = np.frombuffer(told.stdout[: len(told.stdout) // 4 * 4], np.float32)
    return samples.astype(np.float64) if told.returncode == 0 and len(samples) else None
