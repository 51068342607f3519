"""The recognizer process: bodies in, the posture's name out."""

import threading
import time
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLES_IN_POSE
from common.bus import clock
from common.bus.bus import Bus, open_client
from common.bus.inbox import Inbox
from common.bus.messages import Body, Performance, Posture
from common.bus.process import READY_S, Heart, ProcessContext, process, settle
from common.bus.rate import Pace
from common.config.settings import Settings
from common.method import METHODS
from recognizer import events, everyone, model_rate, spotting
from recognizer.features import ROW_NAMES, rows
from recognizer.model_file import ModelError, load
from recognizer.performance_judge import Event
from recognizer.postures import DensityModel, PostureModel

SHIPPED = Path(__file__).parent / "postures.npz"
"""Path of the default model."""
SHIPPED_PAPER = SHIPPED.with_name("postures_paper.npz")
"""Model file of `paper` mode: the paper's recogniser, trained on runs in that mode."""
REACH_FRAMES: Final = 900
"""Longest performance, frames: a longer one is reported from there on; a minute at the paper's
rate."""
GAP_S: Final = 1.0
"""Gap between bodies, seconds, that ends a motion, as that many frames without a pose do: what
comes before and after a cut is not one motion."""
UNNUMBERED: Final = -1
"""Frame number of a message that belongs to no frame, as at the end of a run."""
HEAR_S = 0.05
MOVING = ("tracking", "predicted")
"""States in which a body's angles are used; the opening posture is no motion. A predicted body's
smoothed angles continue their motion and bridge a gap of a few frames."""


class State(NamedTuple):
    """State of a stream."""

    window: spotting.State
    events: events.State | None
    """None for the paper's model: it has postures alone."""
    judged: spotting.Judgement = spotting.NOTHING
    doing: events.Doing = events.NOTHING
    frames: tuple[tuple[int, float], ...] = ()
    """Number and time of each of the models' frames that a performance can still include."""
    rate: model_rate.State = model_rate.State()


def init(model: PostureModel, window_frames: int) -> State:
    """The initial state."""
    network = events.init(model) if isinstance(model, DensityModel) else None
    return State(spotting.init(model, window_frames), network)


def step(state: State, body: Body) -> tuple[State, Posture]:
    """Process one body: the judgement of the window that ends with it, and the posture in progress.

    Models count their own frames, 15 a second: a faster camera's body may add no frame.
    """
    if state.frames and body.captured_s - state.frames[-1][1] > GAP_S:
        state = _after_a_gap(state)
    rate, due = model_rate.step(state.rate, body.captured_s)
    state, row, event = state._replace(rate=rate), row_of(body), None
    for _ in range(due):
        state = _with_row(state, body, row)
        event = state.doing.event or event
    judged, doing = state.judged, state.doing
    return state, Posture(
        person=body.person,
        frame=body.frame,
        captured_s=body.captured_s,
        clock_s=body.clock_s,
        name=judged.name,
        log_likelihoods=judged.log_likelihoods,
        segment=(_at(state, judged.first)[0], _at(state, judged.last)[0]),
        doing=judged.name if state.events is None else doing.name,
        times=doing.times,
        event=event and performance(event, _at(state, event.first), _at(state, event.last)),
    )


def finish(state: State, last: Posture) -> Posture | None:
    """The messages at the end of a run: the performance that it cuts off, if any.

    Args:
        state: After the last body.
        last: The last reported posture.
    """
    event = None if state.events is None else events.finish(state.events)
    if event is None:
        return None
    told = performance(event, _at(state, event.first), _at(state, event.last))
    return msgspec.structs.replace(last, frame=UNNUMBERED, event=told)


def _at(state: State, step_number: int) -> tuple[int, float]:
    """Number and time of one of the models' frames; of the oldest kept, where that one is not
    kept."""
    oldest = state.window.next_frame - len(state.frames)
    return state.frames[max(step_number - oldest, 0)]


def _with_row(state: State, body: Body, row: NDArray[np.float64] | None) -> State:
    """A body as one of the models' frames."""
    window, judged = spotting.step(state.window, row)
    network, doing = state.events, events.NOTHING
    if network is not None:
        network, doing = events.step(network, row)
    frames = (*state.frames, (body.frame, body.captured_s))[-REACH_FRAMES:]
    return State(window, network, judged, doing, frames, state.rate)


def _after_a_gap(state: State) -> State:
    """The state after a gap."""
    window, network = state.window, state.events
    for _ in range(spotting.MISSED_FRAMES):
        window, _judged = spotting.step(window, None)
        if network is not None:
            network, _doing = events.step(network, None)
    return State(window, network)


def performance(event: Event, onset: tuple[int, float], end: tuple[int, float]) -> Performance:
    """An event in the frames and seconds of the stream."""
    return Performance(
        name=event.name,
        onset=onset[0],
        end=end[0],
        onset_s=onset[1],
        end_s=end[1],
        posterior=event.posterior,
        times=event.times,
    )


def words(one: Performance, person: int = 0) -> str:
    """One line about a performance, of one of several people with their number."""
    whose = f"person {person}, " if person else ""
    times = f", {one.times} times" if one.times > 1 else ""
    when = f"{one.onset_s:.1f} to {one.end_s:.1f} s"
    return f"{whose}{when}: {one.name}{times} ({one.posterior:.0%} sure)"


def row_of(body: Body) -> NDArray[np.float64] | None:
    """A body as the recogniser's input, (20,); None where it is not tracked in a motion."""
    if body.status not in MOVING or not body.pose:
        return None
    angles_deg = np.array([[body.pose[i] for i in ANGLES_IN_POSE]])
    return rows(angles_deg, np.array([body.joints_m]))[0]


def run(
    model: PostureModel, settings: Settings, bus: Bus, period_s: float, stop: threading.Event
) -> None:
    """Judge every published body until stopped."""
    state, told = everyone.init(init(model, settings.recognizer.window_frames)), ""
    pace = Pace(period_s)
    heart = Heart(bus, "recognizer", pace)
    bodies = bus.subscribe(Body)
    heart.beat("ready")
    ahead_s: float | None = None
    while not stop.is_set():
        body = bodies.take(HEAR_S)
        if body is not None:
            if ahead_s is None:  # now the integrator is there to answer
                ahead_s = clock.asked(bus).offset_s
            state, posture = everyone.step(state, body, step)
            bus.publish(posture)
            told = words(posture.event, posture.person) if posture.event else told
            pace.done(body.clock_s - ahead_s, time.monotonic())
            heart.beat("running", told, **_lost(bodies))
    for last in everyone.finished(state, finish):
        bus.publish(last)
        told = words(last.event, last.person) if last.event else told
    heart.beat("ended", told, **_lost(bodies))


def _lost(bodies: Inbox[Body]) -> dict[str, int]:
    """Losses so far, for a Pulse."""
    return {
        "dropped": bodies.dropped,
        "malformed": bodies.malformed,
        "foreign": bodies.foreign,
    }


def model_of(settings: Settings, meant: str = "") -> PostureModel:
    """The model named in the settings, or the default one.

    Args:
        settings: The run's settings.
        meant: The posture that the clip is labelled with; "" without a label.

    Raises:
        ModelError: When the model cannot be used, or does not contain that posture.
    """
    shipped = SHIPPED if METHODS[settings.mode].density_recognizer else SHIPPED_PAPER
    path = Path(settings.recognizer.model) if settings.recognizer.model else shipped
    model = load(path)
    if meant and meant not in model.names:
        raise ModelError(
            f"{path} was trained on other postures than {meant!r}, which the clip's meta.json "
            f"names (it knows {', '.join(model.names)}): name a model that `tritrack train` made "
            "of it as recognizer.model, or take posture out of the meta.json"
        )
    return model


def warm_up(model: PostureModel, window_frames: int) -> None:
    """Compile or load all code of a step."""
    window = spotting.init(model, window_frames)
    network = events.init(model) if isinstance(model, DensityModel) else None
    for turn_deg in range(spotting.NAMED_FROM_FRAMES + 2):
        row = np.full(len(ROW_NAMES), 9.0 * turn_deg)
        window, _ = spotting.step(window, row)
        if network is not None:
            network, _ = events.step(network, row)


def main(settings: Settings, period_s: float, context: ProcessContext = ProcessContext()) -> None:
    """Load the model, recognise postures until stopped, close.

    Raises:
        ModelError: When the model cannot be used.
        BusError: When the integrator does not answer.
    """
    model = model_of(settings)
    warm_up(model, settings.recognizer.window_frames)
    with (
        process("recognizer", context) as stop,
        open_client(settings.bus, settings.room, READY_S, "recognizer", stop) as bus,
    ):
        bus.announce("recognizer")
        settle()
        run(model, settings, bus, period_s, stop)
