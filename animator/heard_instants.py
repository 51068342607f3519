"""What the page's process hears of a run: the newest instant, with all of its people."""

from typing import Final

from animator.scene import Snapshot, snapshot_of
from common.bus.bus import Bus
from common.bus.control_messages import Answer, Cameras, Pulse
from common.bus.messages import Body, Picture, Posture, View

MOST_REPORTS: Final = 16
"""Number of reports that wait for their body, which comes within a frame or two."""
TOGETHER_S: Final = 0.01
"""Longest pause between two bodies of an instant, seconds: they are published in a row."""


class Subscriber:
    """All messages that the page shows."""

    def __init__(self, bus: Bus) -> None:
        """Subscribe from now on."""
        self.bodies = bus.subscribe(Body)
        self.answers = bus.subscribe(Answer)
        self.cameras = bus.subscribe(Cameras)
        self.shown: list[Body] = []
        """The bodies of the last snapshot."""
        self._reports = bus.subscribe(View)
        self._pictures = bus.subscribe(Picture)
        self._postures = bus.subscribe(Posture)
        self._pulses = bus.subscribe(Pulse)
        self._waiting: list[View] = []
        self._seen: dict[int, View] = {}
        self._painted: dict[int, Picture] = {}
        self._judged: dict[int, Posture] = {}
        self._performed: dict[int, str] = {}
        self._by_process: dict[str, Pulse] = {}

    def newest(self, body: Body) -> list[Body]:
        """All bodies of the newest instant, by number.

        Args:
            body: The body that was heard last. One of several people may have others behind it,
                that of a run which follows one person (number 0) has none.
        """
        heard = [body, *self.bodies.drain()]
        while heard[-1].person and (more := self.bodies.take(TOGETHER_S)) is not None:
            heard.append(more)
        at_s = heard[-1].captured_s
        together = {body.person: body for body in heard if body.captured_s == at_s}
        return [together[person] for person in sorted(together)]

    def with_bodies(self, bodies: list[Body]) -> tuple[Snapshot, list[Posture]]:
        """The newest of everything, with the reports that the bodies of an instant were made of;
        and the postures with which a performance ended."""
        self._waiting = [*self._waiting, *self._reports.drain()][-MOST_REPORTS:]
        before = [report for report in self._waiting if report.captured_s <= bodies[0].captured_s]
        self._seen = {**self._seen, **{report.viewer: report for report in before}}
        pictures = self._pictures.drain()
        self._painted = {**self._painted, **{picture.viewer: picture for picture in pictures}}
        postures = self._postures.drain()
        self._judged.update((posture.person, posture) for posture in postures)
        ended = [posture for posture in postures if posture.event]
        self._performed.update((one.person, one.event.name) for one in ended if one.event)
        self.shown = bodies
        newest = snapshot_of(bodies, self._judged, self._performed, self._seen, self._painted)
        return newest, ended

    def pulses(self) -> list[Pulse]:
        """The newest pulse of each process, if any is new."""
        new = self._pulses.drain()
        self._by_process.update((pulse.process, pulse) for pulse in new)
        return list(self._by_process.values()) if new else []
