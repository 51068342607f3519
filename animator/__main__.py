"""The animator process: everything that is said, shown on the live page."""

import gc
import logging
import os
import threading
import time
from typing import Final

from animator.page.inset import limb_contours, limb_ends
from animator.page.live import LivePage
from animator.scene import Figure, Snapshot, limb_shapes
from common.body.body import rest_pose
from common.body.proportions import thesis_bdp
from common.bus.bus import Bus, open_client
from common.bus.control_messages import Cameras, Pulse
from common.bus.messages import Body, Picture, Posture, Report
from common.bus.process import READY_S, Heart, ProcessContext, process
from common.bus.rate import Pace
from common.config import Settings
from common.rig.camera import Rig

HEAR_S: Final = 0.05
BEHIND: Final = 10
"""How far the page stands back when cores are scarce: a pose must never wait for its picture."""
MOST_PERFORMANCES: Final = 4
"""So many of those that are over are listed."""
MOST_REPORTS: Final = 16
"""Reports that wait for their body: it comes within a frame or two."""

log = logging.getLogger(__name__)


class Subscriber:
    """All that the page shows, as it comes in."""

    def __init__(self, bus: Bus) -> None:
        """Listen from now on."""
        self.bodies = bus.subscribe(Body)
        self._reports = bus.subscribe(Report)
        self._pictures = bus.subscribe(Picture)
        self._postures = bus.subscribe(Posture)
        self._pulses = bus.subscribe(Pulse)
        self._waiting: list[Report] = []
        self._snapshot = Snapshot()

    def with_body(self, body: Body) -> Snapshot:
        """The newest of everything, with the reports that the body was made of."""
        self._waiting = [*self._waiting, *self._reports.drain()][-MOST_REPORTS:]
        reports = dict(self._snapshot.reports)
        for report in self._waiting:
            if report.captured_s <= body.captured_s:
                reports[report.viewer] = report
        pictures = dict(self._snapshot.pictures)
        pictures.update((picture.viewer, picture) for picture in self._pictures.drain())
        pulses = {pulse.process: pulse for pulse in self._pulses.drain()}
        postures = self._postures.drain()
        over = [posture.event for posture in postures if posture.event]
        before = self._snapshot
        self._snapshot = Snapshot(
            body=body,
            reports=reports,
            pictures=pictures,
            posture=postures[-1] if postures else before.posture,
            performances=(*before.performances, *over)[-MOST_PERFORMANCES:],
            pulses={**before.pulses, **pulses},
        )
        return self._snapshot


def run(
    page: LivePage, subscriber: Subscriber, bus: Bus, period_s: float, stop: threading.Event
) -> None:
    """Show every body that is published; when late, the newest only."""
    pace = Pace(period_s)
    heart = Heart(bus, "animator", pace)
    heart.beat("ready", page.address)
    while not stop.is_set():
        body = subscriber.bodies.take(HEAR_S)
        if body is not None:
            page.show(subscriber.with_body((subscriber.bodies.drain() or [body])[-1]))
            pace.done(body.clock_s, time.monotonic())
            heart.beat("running", page.address, dropped=subscriber.bodies.dropped)
    heart.beat("ended", page.address)


def warm_up(rig: Rig) -> None:
    """Load or compile all that draws a body: the first one that is heard must not wait for it."""
    standing = Figure(thesis_bdp(1.75), rest_pose(), ())
    limb_shapes(standing)
    for camera in rig.cameras:
        limb_contours(camera, limb_ends(standing))


def known_rig(bus: Bus, given: Rig | None, stop: threading.Event) -> Rig | None:
    """The calibrated rig, or the assumed one once the integrator tells it."""
    told = bus.subscribe(Cameras)
    kept = bus.latest(Cameras, HEAR_S) if given is None else None
    rig = given if kept is None else kept.rig
    while rig is None and not stop.is_set():
        heard = told.take(HEAR_S)
        rig = None if heard is None else heard.rig
    return rig


def main(
    settings: Settings, rig: Rig | None, period_s: float, context: ProcessContext = ProcessContext()
) -> None:
    """Open the page, show until stopped, close.

    Raises:
        PageError: When the port is taken.
        BusError: When the integrator does not answer.
    """
    with (
        process("animator", context) as stop,
        open_client(settings.bus, settings.room, READY_S) as bus,
    ):
        os.nice(BEHIND)
        bus.announce("animator")
        subscriber = Subscriber(bus)
        known = known_rig(bus, rig, stop)
        if known is None:
            return
        warm_up(known)
        page = LivePage(known, settings.page.port)
        log.info("the page is at %s", page.address)
        gc.freeze()
        try:
            run(page, subscriber, bus, period_s, stop)
        finally:
            page.close()
