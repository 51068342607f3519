"""The animator process: the bus's messages, shown on the live page."""

import logging
import threading
import time
from multiprocessing.connection import Connection
from typing import Final

from animator.heard_instants import Subscriber
from animator.page.door import Entrance, entrance_of, invitation_of
from animator.page.inset import limb_contours, limb_ends
from animator.page.live import LivePage
from animator.scene import Figure, limb_shapes
from common.body.body import rest_pose
from common.body.proportions import thesis_bdp
from common.bus.bus import Bus, BusError, open_client
from common.bus.control_messages import Cameras, Command
from common.bus.message_codec import TOPICS
from common.bus.messages import Body
from common.bus.process import READY_S, Heart, ProcessContext, process, settle
from common.bus.rate import Pace
from common.config.settings import Settings
from common.npz_file import Facts
from common.platform.platforms import platform
from common.rig.camera import paper_rig
from common.video.clip_sources import camera_words

HEAR_S: Final = 0.05
PERIOD_S: Final = 1 / TOPICS[Body].hz
"""Age of a body, seconds, from which on its display counts as late."""
BEHIND: Final = 10
"""Lowering of the page's priority where cores are scarce: the tracking must not wait for the
page."""
START_S: Final = 0.2
"""Seconds between two announcements of an open page, until the run begins."""
LEFT_S: Final = 3.0
"""Seconds after which a browser has left for good; one that reloads the page is back sooner."""
MOST_LINGER_S: Final = 3600.0
"""How long the page of an ended run stays while a browser shows it."""

log = logging.getLogger(__name__)


def run(page: LivePage, bus: Bus, stop: threading.Event, ending: Connection | None) -> Facts | None:
    """Show every published body, the newest only when late; forward the browsers' commands.

    Returns:
        The outcome of the run, from its supervisor; None where it was stopped.
    """
    subscriber, pace = Subscriber(bus), Pace(PERIOD_S)
    kept = bus.latest(Cameras, HEAR_S)
    if kept is not None:
        page.set_rig(kept.rig)
    heart = Heart(bus, "animator", pace)
    heart.beat("ready", page.address)
    begun, again_s = False, 0.0
    while not stop.is_set():
        body = subscriber.bodies.take(HEAR_S)
        for cameras in subscriber.cameras.drain():
            page.set_rig(cameras.rig)
        if body is not None:
            begun = True
            page.show(*subscriber.with_bodies(subscriber.newest(body)))
            pace.done(body.clock_s, time.monotonic())
            heart.beat("running", page.address, dropped=subscriber.bodies.dropped)
        elif not begun and page.watched and time.monotonic() > again_s:
            again_s = time.monotonic() + START_S
            bus.publish(Command(what="start"))
        _exchange(page, subscriber, bus)
        if ending is not None and ending.poll():
            _show_rest(page, subscriber)
            heart.beat("ended", page.address)
            return _told(ending)
    heart.beat("ended", page.address)
    return None


def _show_rest(page: LivePage, subscriber: Subscriber) -> None:
    """The performance that the end of the run cut off: it is reported after the last body."""
    if subscriber.shown:
        snapshot, ended = subscriber.with_bodies(subscriber.shown)
        if ended:
            page.show(snapshot, ended)


def _exchange(page: LivePage, subscriber: Subscriber, bus: Bus) -> None:
    """Commands to the bus, answers and pulses to the browsers."""
    for asked in page.asked():
        bus.publish(Command(what=asked.what))
    for answer in subscriber.answers.drain():
        page.answer(answer)
    pulses = subscriber.pulses()
    if pulses:
        page.show_health(pulses)


def _told(ending: Connection) -> Facts:
    try:
        facts: Facts = ending.recv()
    except EOFError:  # the supervisor is gone
        facts = {}
    return facts


def linger(page: LivePage, stop: threading.Event) -> None:
    """Stay while a browser shows an ended run."""
    until_s = time.monotonic() + MOST_LINGER_S
    left_s = 0.0 if page.was_watched else LEFT_S
    while left_s < LEFT_S and time.monotonic() < until_s and not stop.wait(HEAR_S):
        left_s = 0.0 if page.watched else left_s + HEAR_S


def warm_up() -> None:
    """Load or compile what draws a body, so that the first one need not wait for it."""
    standing = Figure(thesis_bdp(1.75), rest_pose(), ())
    limb_shapes(standing)
    for camera in paper_rig((160, 120), (200.0, 200.0), (4.5, 4.5)).cameras:
        limb_contours(camera, limb_ends(standing))


def main(
    settings: Settings,
    context: ProcessContext = ProcessContext(),
    title: str = "tritrack",
    ending: Connection | None = None,
    entrance: Entrance | None = None,
) -> None:
    """Open the page at once, show the run, stay while a browser shows its end, close.

    Args:
        settings: The run's settings.
        context: How this process runs.
        title: The run's title.
        ending: Connection on which a supervisor sends the outcome when the run is over; None: there
            is none.
        entrance: The entrance whose token a supervisor has printed; None: it is logged here.

    Raises:
        PageError: When the port is taken.
        BusError: When the integrator does not answer.
    """
    with process("animator", context) as stop:
        platform().give_way(BEHIND)
        own = entrance or entrance_of(settings.page)
        words = camera_words(settings)
        page = LivePage(title, settings.page.port, context.supervised, own, words)
        told = page.address if entrance else invitation_of(own, settings.page.port)
        log.info("the page is at %s", told)
        try:
            warm_up()
            settle()
            facts = _shown(page, settings, stop, ending)
            if facts is not None:
                page.end(facts)
                linger(page, stop)
        finally:
            page.close()


def _shown(
    page: LivePage, settings: Settings, stop: threading.Event, ending: Connection | None
) -> Facts | None:
    """Show a run once its bus is there. Where there is a supervisor, this waits for any time, as
    the supervisor ends this process: before a first run all is compiled for minutes."""
    most_s = READY_S if ending is None else HEAR_S
    while True:
        try:
            with open_client(settings.bus, settings.room, most_s, "animator", stop) as bus:
                bus.announce("animator")
                return run(page, bus, stop, ending)
        except BusError:
            if ending is None:
                raise
            if ending.poll():
                return _told(ending)
