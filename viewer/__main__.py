"""The viewer process: one camera's frames in, its reports out."""

import logging
import math
import threading
import time
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Final, Literal, NamedTuple

from common.bus import clock
from common.bus.bus import Bus, open_client
from common.bus.bus_keys import VIEWERS
from common.bus.control_messages import ClockQuestion, Command, Ended
from common.bus.messages import Guide, Picture, View, ViewerNumber
from common.bus.process import BEGIN_S, READY_S, Heart, ProcessContext, process, settle
from common.bus.rate import Pace
from common.config.settings import Settings
from common.method import METHODS
from common.npz_file import Facts
from common.video.clip_facts import ClipView, shortfall
from common.video.clip_sources import sources_of
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import DecoderDied, Undecodable, is_camera, is_recorded
from common.video.reduction import jpeg_of
from viewer import landmark_step, track
from viewer.background.background import Background
from viewer.background.new_background import Learning
from viewer.capture import Live, RoomClock
from viewer.captured_frame import CapturedFrame
from viewer.guides import Guides
from viewer.kept_pictures import KeptPictures
from viewer.landmarks.landmark_sources import outside_sources
from viewer.load_shedding import LoadShedder
from viewer.resend_buffer import ResendBuffer
from viewer.room.background_source import keep, opening_of_run
from viewer.viewer_warmup import warm_up

LAST_WORDS_S: Final = 1.0
"""How long a viewer stays after it reported the end of its clip, seconds: a link between hosts
may be slow. An unsent report would be lost, and the run would wait a minute for it."""
WAIT_SHARE: Final = 0.5
"""How long a viewer waits for the guide of its last frame, frame periods."""

log = logging.getLogger(__name__)


class StartError(RuntimeError):
    """The run did not begin; the text names the cause."""


class Prepared(NamedTuple):
    """What a viewer needs before its first frame."""

    view: ClipView
    """Its camera's view of the clip."""
    state: track.State
    warnings: tuple[str, ...] = ()
    """Warnings about the view, sent with every pulse, one line each."""
    kept: Path | None = None
    """The run's folder for a learnt background; None: it is not kept."""


def run(prepared: Prepared, live: Live, bus: Bus, stop: threading.Event) -> None:
    """Process every frame when it is due and publish its report, until the clip's end.

    Args:
        prepared: The viewer.
        live: Source of the frames.
        bus: Receives the reports.
        stop: Ends it early.
    """
    work, why = FrameLoop(prepared, live, bus), ""
    try:
        while not stop.is_set() and not live.over:
            frame = live.take(work.period_s)
            if frame is not None:
                work.process(frame)
            work.beat("running")
    except (DecoderDied, Undecodable) as error:
        why = str(error)
        raise
    finally:  # Even when the decoder crashed: the run must not wait for this view again.
        bus.publish(Ended(viewer=prepared.view.number, frames=work.frames, why=why))
    work.finish()


class FrameLoop:
    """What is done with each frame of a live view, and what is reported of that."""

    def __init__(self, prepared: Prepared, live: Live, bus: Bus) -> None:
        """As `run`."""
        view, settings = prepared.view, prepared.state.setup.settings
        self._prepared, self._live, self._bus = prepared, live, bus
        self._state, self._warnings = prepared.state, prepared.warnings
        self.period_s = settings.every / view.fps
        """Seconds between two frames."""
        self._pace = Pace(self.period_s)
        self._heart = Heart(bus, f"viewer {view.number}", self._pace)
        self._guides = Guides(bus.subscribe(Guide), view.number)
        self._unheard, self._alive = ResendBuffer(), bus.watch_alive()
        empty_frames = _empty_frames(prepared.state, view)
        self._learning = Learning(bus.subscribe(Command), view.number, empty_frames)
        self._shedder, self._before = LoadShedder(self.period_s, settings.people), -1

    @property
    def frames(self) -> int:
        """Number of processed frames."""
        return self._pace.frames

    def process(self, frame: CapturedFrame) -> None:
        """Look at a frame, publish its report, and what the integrator missed before."""
        offset_s = self._live.offset_s
        guide = self._guides.of_frame(self._before, WAIT_SHARE * self.period_s)
        frame = self._shedder.of_frame(frame, time.monotonic() + offset_s - frame.clock_s)
        self._state, report = track.step(self._state, frame, guide)
        for missed in self._unheard.again(self._guides.heard, self._alive.drain()):
            self._bus.publish(missed)
        self._bus.publish(report)
        self._unheard.said(report)
        self._shedder.reported(report)
        self._pace.done(frame.clock_s - offset_s, time.monotonic())
        if self._state.setup.settings.pictures:
            self._bus.publish(_picture(self._prepared.view.number, frame))
        self._state = track.finished(self._state)
        self._learn(frame, report)
        self._before = frame.index

    def beat(self, state: Literal["running", "ended"]) -> None:
        """Report how it goes, once a second and at the end."""
        news = _news(self._live, self._guides, self._shedder, self._warnings)
        self._heart.beat(state, **news)

    def finish(self) -> None:
        """Report the end, and what was missing of the video or of the time for it."""
        live = self._live
        short = shortfall(self._prepared.view, live.ending) if live.over else ""
        for odd in filter(None, (short, *self._shedder.odd(self.frames))):
            log.warning(odd)
            self._warnings = (*self._warnings, odd)
        self.beat("ended")

    def _learn(self, frame: CapturedFrame, report: View) -> None:
        """Take a new background where that was asked for, and it is learnt."""
        background, answer = self._learning.step(frame.picture, report.fault)
        if background is not None:
            self._state = _before(background, self._state, self._prepared)
        if answer is not None:
            self._bus.publish(answer)


def _before(background: Background, state: track.State, prepared: Prepared) -> track.State:
    """The state with a newly learnt background; a camera's is saved."""
    if prepared.kept is not None and is_camera(prepared.view.source):
        keep(prepared.kept, prepared.view, background)
    return track.with_background(state, background)


def main(
    settings: Settings, viewer: ViewerNumber, context: ProcessContext = ProcessContext()
) -> None:
    """Learn the background, wait for the others, process the clip, close everything in order.

    Raises:
        ClipError: When the clip cannot be used.
        BusError: When the integrator does not answer.
        DecoderDied: When the video crashed the decoder.
        StartError: When the other viewer does not become ready.
        SettingsError: When the source of landmarks cannot be used.
    """
    name = f"viewer {viewer}"
    with (
        process(name, context) as stop,
        open_client(settings.bus, settings.room, READY_S, VIEWERS[viewer], stop) as bus,
    ):
        heart = Heart(bus, name, Pace(1.0))
        heart.beat("starting")
        prepared = _prepared(settings, viewer, context)
        view, state = prepared.view, prepared.state
        with outside_sources(settings, (view,)) as sources, Decoder() as decoder:
            decoder.start(view.source)
            warm_up(state, view.size)
            settle()
            bus.announce(name)
            heart.beat("ready", "\n".join(prepared.warnings))
            room_clock = met(bus, viewer, stop)
            if room_clock is not None:
                if time.monotonic() + room_clock.offset_s > room_clock.start_s:
                    # after a restart its clip goes on
                    prepared = prepared._replace(
                        state=state._replace(landmarks=landmark_step.State())
                    )
                source = sources.get(viewer)
                with (
                    _kept_pictures(view, context) as kept,
                    Live(
                        view, settings.every, room_clock, source, decoder=decoder, kept=kept
                    ) as live,
                    clock.followed(bus, live.set_offset),
                ):
                    run(prepared, live, bus, stop)
                stop.wait(0.0 if context.supervised else LAST_WORDS_S)


def _kept_pictures(
    view: ClipView, context: ProcessContext
) -> AbstractContextManager[KeptPictures | None]:
    """What keeps the view's pictures, where the run does."""
    if context.pictures is None:
        return nullcontext()
    return KeptPictures(context.pictures, view.number, view.fps)


def _prepared(settings: Settings, viewer: ViewerNumber, context: ProcessContext) -> Prepared:
    """A viewer that knows its background."""
    with Decoder() as decoder:
        clip = open_clip(settings, decoder, (viewer,))
        view = _beside_the_other(clip.views[0], settings, decoder)
        opening = opening_of_run(view, settings.silhouette, decoder, context.kept)
    warnings = (*clip.warnings, *([opening.odd] if opening.odd else []))
    for warning in warnings:
        log.warning(warning)
    camera = clip.rig.cameras[0] if clip.rig else None
    alone = len(sources_of(settings)) == 1
    setup = track.Setup(viewer, camera, settings, METHODS[settings.mode], alone)
    state = track.init(setup, opening.background, somebody=opening.somebody)
    return Prepared(view, state, warnings, context.kept)


def _empty_frames(state: track.State, view: ClipView) -> int:
    """Number of processed frames that make a background."""
    every, empty_s = state.setup.settings.every, state.setup.settings.silhouette.empty_s
    return math.ceil(view.frames_in(empty_s) / every)


def _beside_the_other(view: ClipView, settings: Settings, decoder: Decoder) -> ClipView:
    """The view at the shared frame rate, where the other's video is on this host too."""
    named = sources_of(settings)
    here = [is_recorded(each.source) and Path(each.source).is_file() for each in named]
    if len(named) < 2 or not all(here):
        return view
    return next(each for each in open_clip(settings, decoder).views if each.number == view.number)


def met(bus: Bus, viewer: ViewerNumber, stop: threading.Event) -> RoomClock | None:
    """The room's clock and the start of the run, once all viewers are ready; None when stopped.

    Raises:
        StartError: When they take too long.
    """
    asked, offset = clock.init(), clock.Offset(0.0, 0.0)
    until_s = time.monotonic() + BEGIN_S
    start_s: float | None = None
    while start_s is None or len(asked) < clock.EXCHANGES:
        if stop.is_set():
            return None
        if time.monotonic() > until_s:
            raise StartError(
                f"viewer {viewer} is ready, but the run did not begin within {BEGIN_S:g} s: "
                "start the other viewer, or take it out of the settings"
            )
        is_ready = len(asked) >= clock.EXCHANGES - 1  # the start may follow immediately
        told = clock.exchanged(bus, ClockQuestion(viewer=viewer, ready=is_ready))
        if told is not None:
            asked, offset = clock.step(asked, told[0])
            start_s = told[1].start_s
        stop.wait(0.02)
    log.info("the room's clock is %.6f s from ours (within %.6f)", offset.offset_s, offset.error_s)
    return RoomClock(start_s, offset.offset_s)


def _news(live: Live, guides: Guides, shedder: LoadShedder, warnings: tuple[str, ...]) -> Facts:
    """Warnings and losses so far, for a Pulse."""
    return {
        "detail": "\n".join((*warnings, *live.odd)),
        "dropped": live.dropped,
        "guide_misses": guides.misses,
        "hurried": shedder.frames,
        "in_turn": shedder.in_turn,
        "malformed": guides.malformed,
        "foreign": guides.foreign,
    }


def _picture(viewer: ViewerNumber, frame: CapturedFrame) -> Picture:
    return Picture(
        frame=frame.index,
        captured_s=frame.captured_s,
        clock_s=frame.clock_s,
        viewer=viewer,
        jpeg=jpeg_of(frame.picture),
    )
