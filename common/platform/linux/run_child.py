"""Start of a child: `python -m common.platform.linux.run_child MODULE PIPE [PICTURE]`.

PICTURE: number of its open memory, height, width. Requests come on the standard input.
"""

import mmap
import os
import sys
from importlib import import_module

from common.platform.linux.own_process import be_shown_as, end_with_pipe
from common.platform.platform import Asker, Picture


def run(module: str, answers: int, picture: Picture | None = None) -> None:
    """Let a module answer requests on the standard input, until its asker is gone.

    Args:
        module: Its `main` is called with the Asker.
        answers: Number of the open file for its answers.
        picture: Shared with the asker.
    """
    be_shown_as(module.rpartition(".")[2])
    end_with_pipe(0)
    with os.fdopen(os.dup(0), "rb") as requests, os.fdopen(answers, "wb") as said:
        import_module(module).main(Asker(requests, said, picture))


def picture_of(memory: int, height: int, width: int) -> Picture:
    """The picture in a memory, read-only."""
    import numpy as np

    shared = mmap.mmap(memory, 3 * width * height, access=mmap.ACCESS_READ)
    return np.frombuffer(shared, np.uint8).reshape(height, width, 3)


if __name__ == "__main__":
    told = sys.argv[1]
    pipe, *shared = map(int, sys.argv[2:])
    run(told, pipe, picture_of(*shared) if shared else None)
