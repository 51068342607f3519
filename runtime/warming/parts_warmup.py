"""Warm-up: all code that the parts of a run execute before their first frames."""

import io
from contextlib import redirect_stdout, suppress
from multiprocessing.connection import Connection

import cv2
import numpy as np

from common.bus.process import settle
from common.config.settings import Settings
from common.method import METHODS
from integrator.integrator_warmup import warm_up as warm_integrator
from recognizer import __main__ as recognizer_process
from runtime.warming.first_compilation import SIZE
from viewer import track
from viewer.background.background import learn
from viewer.viewer_warmup import warm_up as warm_viewer


def compile_parts(_words: Connection) -> None:
    """Compile what the parts execute before their first frames, silently: a worker's job."""
    with redirect_stdout(io.StringIO()):
        warm_up()


def warm_up() -> None:
    """Execute all that a part executes in the default mode before its first frame.

    No library may start a thread here: forks would lack it.
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
