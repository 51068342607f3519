"""The integrator process: views of an instant in, bodies and guides out; it owns the room's
clock."""

import threading
import time
from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec

from common.bus.bus import Bus, open_hub
from common.bus.control_messages import Cameras, Command
from common.bus.instant import Instant
from common.bus.messages import Guide, View, ViewerNumber
from common.bus.process import PAGE_S, Heart, ProcessContext, process, settle
from common.bus.rate import Pace
from common.config.settings import Settings
from common.method import METHODS
from common.video.clip_facts import Clip, uprights_of
from common.video.pictures import is_camera
from integrator import commands, diagnostics, merge_state
from integrator.frame_numbers import frame_times
from integrator.handed_over import Estate
from integrator.hearing.rig_publisher import RigPublisher
from integrator.hearing.subscriber import Subscriber
from integrator.integrator_warmup import warm_up
from integrator.live_rig.live_calibration import LiveCalibration, is_by_person
from integrator.live_rig.live_odd_camera import LiveOddCamera
from integrator.measuring import opening_posture
from integrator.merge_state import Start, State
from integrator.people import look_turns, recognition, several
from integrator.people.lived_instant import Merged
from integrator.people.own_views import own_views
from integrator.single.sight import Annotations

LAST_WORDS_S: Final = 1.0
"""How long the room stays open after the last body, seconds: all others are connected to it."""
SUPERVISED_S: Final = 60.0
"""The same where a supervisor ends the processes in order."""


class Merging(NamedTuple):
    """A run of the integrator at a moment."""

    state: recognition.State
    said: Annotations = Annotations()
    """The user's annotations of the next instant."""
    noticed: diagnostics.State = diagnostics.State()
    turn: look_turns.State = look_turns.State()
    """Who is looked at while the run is late."""


def run(
    state: State,
    viewers: tuple[ViewerNumber, ...],
    bus: Bus,
    stop: threading.Event,
    wait_s: float = 0.0,
    estate: Estate = Estate(None),
) -> None:
    """Merge the viewers' reports until each has ended; wait for the page for a given time."""
    at, pace, told = Merging(recognition.State(state)), Pace(state.period_s), RigPublisher(bus)
    heart = Heart(bus, "integrator", pace)
    begun, cameras = (estate.over, estate.start_s), len(state.frames)
    subscriber = Subscriber(bus, viewers, state.period_s, wait_s, *begun, cameras)
    heart.beat("ready", "\n".join(diagnostics.assumed(state)))
    looks = state.scale_source == "assumed" and state.proposes and len(viewers) == 2
    with (
        LiveCalibration(state, looks=looks, late_s=estate.late_s) as calibration,
        LiveOddCamera(state) as odd_camera,
    ):
        while subscriber.going and not stop.is_set():
            at = _obeyed(at, subscriber.commands(), bus)
            subscriber.late_s = calibration.late_s
            for instant in subscriber.instants():
                at, merged = _merged(at, instant, bus, pace)
                calibration.heard(merged.of_first)
                if odd_camera.looks(at.state.room):
                    odd_camera.heard(_everyones(instant, merged), at.state.room)
            room = odd_camera.changed(calibration.changed(at.state.room))
            at = at._replace(state=several.with_room(at.state, room))
            told.rig(room, calibration.late_s, odd_camera.odd)
            news = (*calibration.news, *odd_camera.news, *subscriber.news)
            if told.is_new(news):
                heart.hurry()
            _leave(estate, room, calibration, subscriber)
            odd = [*diagnostics.assumed(room), *told.doubts(room), *news]
            heart.beat("running", "\n".join(odd), **subscriber.counts())
    room = at.state.room
    news = (*told.doubts(room), *calibration.news, *odd_camera.news, *subscriber.news)
    odd = [*diagnostics.warnings(at.noticed, room), *news]
    heart.beat("ended", "\n".join(odd), **subscriber.counts())


def _obeyed(at: Merging, asked: Sequence[Command], bus: Bus) -> Merging:
    """Commands from the page, carried out and answered."""
    for command in asked:
        room, said, answer = commands.step(at.state.room, at.said, command)
        state = several.commanded(at.state, command)
        at = at._replace(state=state._replace(room=room), said=said)
        if answer is not None:
            bus.publish(answer)
    return at


def _merged(at: Merging, instant: Instant, bus: Bus, pace: Pace) -> tuple[Merging, Merged]:
    """Merge one instant, and publish its guide and bodies."""
    state, merged = several.step(at.state, instant, at.said)
    late_s = time.monotonic() - instant.newest.clock_s
    turn, due = look_turns.step(at.turn, late_s, state.room.period_s, state.lives)
    bus.publish(msgspec.structs.replace(merged.guide, due=due))
    for body in merged.bodies:
        bus.publish(body)
    pace.done(instant.newest.clock_s, time.monotonic())
    noticed = diagnostics.step(at.noticed, instant, several.present(state, merged))
    return Merging(state, noticed=noticed, turn=turn), merged


def _everyones(instant: Instant, merged: Merged) -> dict[int, dict[int, View]]:
    """Each person's own views of an instant, by their number and the view's."""
    views = {n: view for n, view in enumerate(instant.views, 1) if view is not None}
    return {body.person: own for body, own in own_views(views, merged)}


def _leave(
    estate: Estate, state: State, calibration: LiveCalibration, subscriber: Subscriber
) -> None:
    """Leave what a successor needs, should this process die."""
    start_s = subscriber.starter.start_s
    estate.leave(state, calibration.late_s, time.monotonic(), subscriber.over, start_s)


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
        run(state, viewers, bus, stop, page_wait_s(settings, clip, context), estate)
        stop.wait(SUPERVISED_S if context.supervised else LAST_WORDS_S)


def page_wait_s(settings: Settings, clip: Clip, context: ProcessContext) -> float:
    """How long a run waits for its page to be opened; a run on cameras does not wait."""
    recorded = not any(is_camera(view.source) for view in clip.views)
    waits = context.supervised and settings.page.port and settings.page.wait and recorded
    return PAGE_S if waits else 0.0
