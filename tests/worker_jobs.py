"""What workers of a test do: of few imports, for each worker imports it anew."""

import os
import time
from multiprocessing.connection import Connection
from pathlib import Path

from common.platform.platforms import platform


def sleeps(word: str, words: Connection) -> None:
    """A worker that does not hear that it shall end."""
    Path(word).write_text(str(os.getpid()))
    time.sleep(600.0)


def heeds(word: str, words: Connection) -> None:
    """A worker that ends in order when it is asked to."""
    ended: list[int] = []
    with platform().asked_to_end(lambda: ended.append(1)):
        Path(word).write_text(str(os.getpid()))
        while not ended:
            time.sleep(0.01)
    words.send("ended in order")
    raise SystemExit(5)


def says(words: Connection) -> None:
    """A worker that says how it began."""
    words.send((os.environ["OMP_NUM_THREADS"], os.environ.get("LEFT", "")))
