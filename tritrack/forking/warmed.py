"""What the parts of a run are forked from: everything imported, compiled code loaded.

Imported by the zygote alone (`zygote.py`), and the work is done as it is imported: multiprocessing
gives its server no other moment.
"""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from typing import Final

import cv2
import numpy as np

from common.cache_folder import mark_of_all
from common.config.settings import Settings
from common.method import METHODS
from common.parent_death import end_with
from common.settled import settle
from common.video import decoder
from integrator import __main__ as integrator_process
from integrator.integrator_warmup import warm_up as warm_integrator
from recognizer import __main__ as recognizer_process
from viewer import __main__ as viewer_process
from viewer import track
from viewer.background.background import learn
from viewer.viewer_warmup import warm_up as warm_viewer

PID = os.getpid()
"""Of who forks the parts."""
FIRST_RUN: Final = f"{__package__.removesuffix('.forking')}.first_run"
PROCESSES: Final = (viewer_process, integrator_process, recognizer_process, decoder)
SIZE: Final = (160, 120)
"""Of the pictures that are made up; what is compiled does for any."""


def compile_first() -> None:
    """Let all be compiled that is not: a part that met it in the midst of a run would stand still.

    In a process of its own, as it begins threads; it ends with this one, and hears no Ctrl-C.
    """
    if not mark_of_all().exists():
        command = [sys.executable, "-P", "-m", FIRST_RUN, str(os.getpid())]
        subprocess.run(command, stdout=subprocess.DEVNULL, start_new_session=True, check=False)


def warm_up() -> None:
    """Pass through all that a part passes through in the default mode before its first frame.

    No library may begin a thread here: forks would lack it.
    """
    cv2.setNumThreads(1)
    settings = Settings()
    warm_integrator(settings, SIZE)
    width, height = SIZE
    empty = [np.full((height, width, 3), 100 + tone, dtype=np.uint8) for tone in (0, 1)]
    setup = track.Setup(1, None, settings, METHODS[settings.mode], False)
    warm_viewer(track.init(setup, learn(empty)), SIZE)
    model = recognizer_process.model_of(settings)
    recognizer_process.warm_up(model, settings.recognizer.window_frames)
    with suppress(ImportError):  # the page is an extra
        from animator import __main__ as animator_process

        animator_process.warm_up()
    settle()


def begin(starter: int) -> None:
    """Fork from now on, and end with who started this process, by its number, not before.

    SIGTERM waits in each fork until that can heed it: said to all processes of a service, as by
    systemd, it must not end who forks, and all forks with it.
    """
    global PID  # noqa: PLW0603 - a fork that forks in its turn has it anew
    PID = os.getpid()
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
    end_with(starter)


begin(os.getppid())
compile_first()
warm_up()
