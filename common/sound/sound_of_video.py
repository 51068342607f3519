"""The sound of a video, by PyAV (the extra `video`), in a process of its own.

`python -m common.sound.sound_of_video VIDEO` writes its samples to the standard output.
"""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import numpy as np

from common.body.body import Vector

RATE_HZ: Final = 8_000
"""Sample rate to which a sound is brought."""
PATIENCE_S: Final = 60.0
"""Seconds after which a process that still reads is given up."""
LONGEST_S: Final = 600.0
"""Seconds of a sound that are read: more tell no more."""
TICKS_HZ: Final = 1_000_000
"""Time unit of a container, per second."""


def can_hear() -> bool:
    """Whether sounds can be read with what is installed."""
    return find_spec("av") is not None


def sound_of(video: Path) -> Vector | None:
    """The sound of a video, (n,) samples at RATE_HZ from the beginning of its pictures.

    None where it has none, or where nothing is installed that reads it. It is read in a process of
    its own, which a broken file may end.
    """
    if not can_hear():
        return None
    asked = [sys.executable, "-P", "-m", __name__, str(video)]
    try:
        read = subprocess.run(asked, capture_output=True, timeout=PATIENCE_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    samples = np.frombuffer(read.stdout[: len(read.stdout) // 4 * 4], np.float32)
    return samples.astype(np.float64) if read.returncode == 0 and len(samples) else None


def main() -> None:
    """Write the samples of the named video's first sound, float32, to the standard output."""
    import av

    left = round(LONGEST_S * RATE_HZ)
    with av.open(sys.argv[1]) as container:
        if not container.streams.audio:
            return
        sound = container.streams.audio[0]
        graph = _graph(sound)
        for frame in container.decode(sound):
            frame.pts = None if frame.pts is None else frame.pts - _begin(container, sound)
            graph.push(frame)
            left -= _written(graph, left)
            if left <= 0:
                return
        graph.push(None)
        _written(graph, left)


def _graph(sound: Any) -> Any:
    """What makes one channel of RATE_HZ of a sound, with silence where it has gaps; what comes
    before time 0 is cut off."""
    from av.filter import Graph

    graph = Graph()
    steps = [
        graph.add_abuffer(template=sound),
        graph.add("aresample", f"{RATE_HZ}:async=1:first_pts=0"),
        graph.add("aformat", "sample_fmts=flt:channel_layouts=mono"),
        graph.add("abuffersink"),
    ]
    graph.link_nodes(*steps).configure()
    return graph


def _begin(container: Any, sound: Any) -> int:
    """Time of the first picture in the sound's time unit, that of the file where it has none."""
    for view in container.streams.video:
        if view.start_time is not None:
            return round(view.start_time * view.time_base / sound.time_base)
    return round((container.start_time or 0) / TICKS_HZ / sound.time_base)


def _written(graph: Any, left: int) -> int:
    """Write what the graph has ready; the number of samples."""
    from av.error import BlockingIOError, EOFError

    number = 0
    while True:
        try:
            samples = graph.pull().to_ndarray()[0]
        except (BlockingIOError, EOFError):
            return number
        sys.stdout.buffer.write(samples[: max(0, left - number)].astype("<f4").tobytes())
        number += len(samples)


if __name__ == "__main__":
    main()
