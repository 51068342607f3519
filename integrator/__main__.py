"""The integrator process: views of an instant in, bodies and guides out; it owns the room's
clock."""

import threading
import time
from typing import Final

from common.bus.bus import Bus, open_hub
from common.bus.control_messages import Cameras, Command
from common.bus.messages import Guide, ViewerNumber
from common.bus.process import PAGE_S, Heart, ProcessContext, process, settle
from common.bus.rate import Pace
from common.config.settings import Settings
from common.method import METHODS
from common.video.clip_facts import Clip, uprights_of
from common.video.pictures import is_camera
from integrator import commands, diagnostics, merge, merge_state
from integrator.frame_numbers import frame_times
from integrator.handed_over import Estate
from integrator.hearing.rig_publisher import RigPublisher
from integrator.hearing.subscriber import Subscriber
from integrator.integrator_warmup import warm_up
from integrator.live_rig.live_calibration import LiveCalibration, is_by_person
from integrator.measuring import opening_posture
from integrator.merge_state import Start, State
from integrator.single.sight import Annotations

LAST_WORDS_S: Final = 1.0
"""How long the room stays open after the last body, seconds: all others are connected to it."""
SUPERVISED_S: Final = 60.0
"""The same where a supervisor ends the processes in order."""


def run(
    state: State,
    viewers: tuple[ViewerNumber, ...],
    period_s: float,
    bus: Bus,
    stop: threading.Event,
    wait_s: float = 0.0,
    estate: Estate = Estate(None),
) -> None:
    """Merge the viewers' reports until each has ended; wait for the page for a given time."""
    pace = Pace(period_s)
    heart = Heart(bus, "integrator", pace)
    begun, cameras = (estate.over, estate.start_s), len(state.frames)
    subscriber = Subscriber(bus, viewers, period_s, wait_s, *begun, cameras)
    noticed, said, told = diagnostics.State(), Annotations(), RigPublisher(bus)
    heart.beat("ready", "\n".join(diagnostics.assumed(state)))
    looks = state.scale_source == "assumed" and state.proposes and len(viewers) == 2
    with LiveCalibration(state, looks=looks, late_s=estate.late_s) as calibration:
        while subscriber.going and not stop.is_set():
            state, said = _obeyed(state, said, subscriber.commands(), bus)
            subscriber.late_s = calibration.late_s
            for instant in subscriber.instants():
                state, body, guide = merge.step(state, instant, said)
                said = Annotations()
                noticed = diagnostics.step(noticed, instant)
                bus.publish(guide)
                bus.publish(body)
                pace.done(body.clock_s, time.monotonic())
                calibration.heard(instant)
            state = calibration.changed(state)
            told.rig(state, calibration.late_s)
            news = (*calibration.news, *subscriber.news)
            if told.is_new(news):
                heart.hurry()
            estate.leave(
                state,
                calibration.late_s,
                time.monotonic(),
                subscriber.over,
                subscriber.starter.start_s,
            )
            odd = [*diagnostics.assumed(state), *told.doubts(state), *news]
            heart.beat("running", "\n".join(odd), **subscriber.counts())
    news = (*told.doubts(state), *calibration.news, *subscriber.news)
    odd = [*diagnostics.warnings(noticed, state), *news]
    heart.beat("ended", "\n".join(odd), **subscriber.counts())


def _obeyed(
    state: State, said: Annotations, asked: list[Command], bus: Bus
) -> tuple[State, Annotations]:
    """Commands from the page, carried out and answered."""
    for command in asked:
        state, said, answer = commands.step(state, said, command)
        if answer is not None:
            bus.publish(answer)
    return state, said


def main(settings: Settings, clip: Clip, context: ProcessContext = ProcessContext()) -> None:
    """Open the room, merge until the viewers end, close.

    Args:
        settings: The run's settings.
        clip: The viewers' clip: their numbers, the rate, the rig.
        context: How this process runs.

    Raises:
        BusError: When the endpoint is taken.
    """
    period_s = clip.every / clip.views[0].fps
    viewers = tuple(view.number for view in clip.views)
    with process("integrator", context) as stop, open_hub(settings.bus, settings.room) as bus:
        bus.keep(Guide)
        bus.keep(Cameras)
        estate = Estate(context.kept)
        state = merge_state.init(
            clip.rig,
            period_s,
            settings,
            METHODS[settings.mode],
            Start(
                len(viewers) == 1,
                opening=opening_posture.init(clip.body),
                times=frame_times(clip),
                by_person=is_by_person(clip, settings),
                uprights=uprights_of(clip),
            ),
        )
        state = estate.taken_up(state)
        warm_up(settings, clip.views[0].size)
        settle()
        bus.announce("integrator")  # viewers repeat lost reports then: it subscribes at once
        run(state, viewers, period_s, bus, stop, page_wait_s(settings, clip, context), estate)
        stop.wait(SUPERVISED_S if context.supervised else LAST_WORDS_S)


def page_wait_s(settings: Settings, clip: Clip, context: ProcessContext) -> float:
    """How long a run waits for its page to be opened; a run on cameras does not wait."""
    recorded = not any(is_camera(view.source) for view in clip.views)
    waits = context.supervised and settings.page.port and settings.page.wait and recorded
    return PAGE_S if waits else 0.0
