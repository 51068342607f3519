"""The recognizer process: bodies in, the posture's name out."""

import gc
import threading
import time
from collections import deque
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from common.body import ANGLES_IN_POSE
from common.bus import Bus, open_client
from common.config import Settings
from common.messages import Body, Posture
from common.process import READY_S, Heart, Place, process
from common.rate import Pace
from recognizer import spotting
from recognizer.features import ROW_NAMES, rows
from recognizer.model_file import ModelError, load
from recognizer.postures import PostureModel

SHIPPED = Path(__file__).parent / "postures.npz"
"""The model that is used when the settings name none."""
SHIPPED_PAPER = SHIPPED.with_name("postures_paper.npz")
"""The same in `paper` mode: the paper's recogniser, learnt from what that mode tracks."""
HEAR_S = 0.05
MOVING = ("tracking", "predicted")
"""States in which a body's angles say what it does; the opening posture is no motion."""


def step(state: spotting.State, frames: deque[int], body: Body) -> tuple[spotting.State, Posture]:
    """One body more: the judgement of the window that ends with it.

    Args:
        state: Of the window.
        frames: Frame numbers of all steps so far that a window can reach; this one is added.
        body: As the integrator published it.
    """
    state, judged = spotting.step(state, row_of(body))
    frames.append(body.frame)
    newest = state.next_frame - 1
    return state, Posture(
        frame=body.frame,
        captured_s=body.captured_s,
        clock_s=body.clock_s,
        name=judged.name,
        log_likelihoods=judged.log_likelihoods,
        segment=(frames[judged.first - newest - 1], frames[judged.last - newest - 1]),
    )


def row_of(body: Body) -> NDArray[np.float64] | None:
    """What a body shows to the recogniser, (20,); None where it is not followed in a motion."""
    if body.status not in MOVING or not body.pose:
        return None
    angles_deg = np.array([[body.pose[i] for i in ANGLES_IN_POSE]])
    return rows(angles_deg, np.array([body.joints_m]))[0]


def reach(window_frames: int) -> deque[int]:
    """Room for the frame numbers that a window may name."""
    return deque(maxlen=window_frames + 4 * spotting.MISSED_FRAMES)


def run(
    model: PostureModel, settings: Settings, bus: Bus, period_s: float, stop: threading.Event
) -> None:
    """Judge every body that is published until stopped."""
    window = settings.recognizer.window_frames
    state, frames = spotting.init(model, window), reach(window)
    pace = Pace(period_s)
    heart = Heart(bus, "recognizer", pace)
    bodies = bus.subscribe(Body)
    heart.beat("ready")
    while not stop.is_set():
        body = bodies.take(HEAR_S)
        if body is not None:
            state, posture = step(state, frames, body)
            bus.publish(posture)
            pace.done(body.clock_s, time.monotonic())
            heart.beat("running", dropped=bodies.dropped, malformed=bodies.malformed)
    heart.beat("ended", dropped=bodies.dropped, malformed=bodies.malformed)


def model_of(settings: Settings, meant: str = "") -> PostureModel:
    """The model that the settings name, or the one in the package.

    Args:
        settings: Of the run.
        meant: The posture that the run's clip says it shows; "" where it says none.

    Raises:
        ModelError: When the model cannot be used, or does not know that posture.
    """
    shipped = SHIPPED_PAPER if settings.mode == "paper" else SHIPPED
    path = Path(settings.recognizer.model) if settings.recognizer.model else shipped
    model = load(path)
    if meant and meant not in model.names:
        raise ModelError(
            f"{path} was trained on other postures than {meant!r}, which the clip's meta.json "
            f"names (it knows {', '.join(model.names)}): name a model that `tritrack train` made "
            "of it as recognizer.model, or take posture out of the meta.json"
        )
    return model


def main(settings: Settings, period_s: float, place: Place = Place()) -> None:
    """Load the model, name postures until stopped, close.

    Raises:
        ModelError: When the model cannot be used.
        BusError: When the integrator does not answer.
    """
    model = model_of(settings)
    rehearsal = spotting.init(model, settings.recognizer.window_frames)
    for turn_deg in range(spotting.NAMED_FROM_FRAMES + 2):
        rehearsal, _ = spotting.step(rehearsal, np.full(len(ROW_NAMES), 9.0 * turn_deg))
    with (
        process("recognizer", place) as stop,
        open_client(settings.bus, settings.room, READY_S) as bus,
    ):
        bus.announce("recognizer")
        gc.collect()
        gc.freeze()
        run(model, settings, bus, period_s, stop)
