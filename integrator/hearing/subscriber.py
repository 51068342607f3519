"""The viewers' reports, instant by instant."""

import logging
import time
from typing import Final

from common.bus.bus import Bus
from common.bus.control_messages import ClockQuestion, Command, Ended
from common.bus.inbox import Alive
from common.bus.instant import Instant
from common.bus.messages import View, ViewerNumber
from integrator import pairing, presence
from integrator.hearing import link_lag
from integrator.hearing.run_start import Starter
from integrator.live_rig.rig_change import set_back

HEAR_S: Final = 0.02
LOOK_S: Final = 0.5
"""Longest time, seconds, until arrivals and departures are processed although reports keep
coming."""
ASLEEP_S: Final = 0.5
"""Duration of a round, seconds, above which this process was stopped or starved: messages are
still on their way, and their senders are not to blame."""
AWAKE_S: Final = 0.3
"""Time after it, seconds, in which no viewer is called late: all that waits is processed first."""
GATHER_S: Final = 0.3
"""Time, seconds, that a restarted integrator waits for the viewers' repeated reports, which it
sorts by time."""
OVERDUE_PERIODS: Final = 2.0
"""Delay in frames after which an instant is completed without a missing report."""

log = logging.getLogger(__name__)


class Subscriber:
    """The viewers' reports, instant by instant, and which viewers are present."""

    def __init__(
        self,
        bus: Bus,
        viewers: tuple[ViewerNumber, ...],
        period_s: float,
        wait_s: float,
        over: tuple[Ended, ...] = (),
        start_s: float | None = None,
        cameras: int = 2,
    ) -> None:
        """Subscribe to the viewers of a rig of that many cameras; the run may have begun, and
        some viewers ended, before."""
        self.starter = Starter(frozenset(viewers), wait_s, start_s)
        self._gathers = start_s is not None
        """It was restarted, and still waits for repeated reports."""
        self._commands = bus.subscribe(Command)
        self._numbers = {f"viewer {number}": number for number in viewers}
        self._reports, self._ended = bus.subscribe(View), bus.subscribe(Ended)
        self._alive = bus.watch_alive()
        self._moves: list[Alive | Ended] = []
        """Process arrivals, departures and ends, once all earlier reports are in."""
        self._paired = pairing.init(period_s, viewers, cameras)
        self._present = presence.init(period_s, viewers, cameras)
        self._links = link_lag.init(period_s, cameras)
        self._period_s, self._overdue_s = period_s, OVERDUE_PERIODS * period_s
        self.late_s = 0.0
        """Time by which the times of view 2 are set back."""
        self._looked_s = self._round_s = time.monotonic()
        self._judges_s = 0.0
        """From now on late and silent viewers are noticed."""
        self.over: tuple[Ended, ...] = ()
        """Viewers that have reported their end."""
        for said in over:
            self._end(said, self._looked_s)
        bus.answer(ClockQuestion, self.starter.answer)

    @property
    def going(self) -> bool:
        """Whether any viewer may still report."""
        return presence.going(self._present, time.monotonic())

    @property
    def news(self) -> tuple[str, ...]:
        """Lines about views lost and found, with causes, and about slow links."""
        return (*self._present.news, *self._links.news)

    @property
    def _wait_s(self) -> float:
        """How long after capture a report waits for the others of its instant."""
        return self._overdue_s + link_lag.lag_s(self._links)

    def instants(self) -> list[Instant]:
        """The instants that are complete or overdue now; waits a moment for a report."""
        complete: list[Instant] = []
        if not self._moves:
            self._looked_s = time.monotonic()
        self._moves += [*self._alive.drain(), *self._ended.drain()]
        first = self._reports.take(HEAR_S)
        if first is not None and (self._gathers or self.starter.start_s is None):
            time.sleep(GATHER_S)
            self._gathers = False
        said = [] if first is None else [first, *self._reports.drain()]
        for report in said:
            self.starter.begun(report)
        reports = [set_back(report, self.late_s) for report in said]
        reports.sort(key=lambda report: report.captured_s)
        now_s = time.monotonic()
        for report in reports:
            self._present = presence.heard(self._present, report, now_s)
            late_s = now_s - report.clock_s
            self._links = link_lag.heard(self._links, report.viewer, now_s, late_s)
            if late_s < self._period_s + link_lag.lag_s(self._links):
                self._paired = pairing.awaited(self._paired, report.viewer)
            self._paired, more = pairing.step(self._paired, report)
            complete += more
        if not reports or now_s - self._looked_s > LOOK_S:
            # A viewer's reports come before its departure: they are processed first, by a wait that
            # ends without a report, unless reports keep coming.
            complete += self._who_came_and_went(now_s)
        if self._is_caught_up(reports, now_s):
            wait_s = self._wait_s + abs(self.late_s)
            self._paired, alone = pairing.overdue(self._paired, now_s, wait_s)
            complete += alone
            self._present, told = presence.step(self._present, now_s)
            self._links, slow = link_lag.told(self._links, now_s - self._present.began_s)
            for line in (*told, *slow):
                log.warning(line)
        return complete

    def _is_caught_up(self, reports: list[View], now_s: float) -> bool:
        """Whether silence may be held against a viewer: this process has been receiving all
        along."""
        if now_s - self._round_s > ASLEEP_S:
            self._judges_s = now_s + AWAKE_S
        self._round_s = now_s
        fresh = not reports or now_s - reports[-1].clock_s < self._wait_s
        return fresh and now_s >= self._judges_s

    def commands(self) -> list[Command]:
        """Commands from the page since the last call; its presence is asked for too."""
        asked = self._commands.drain()
        if any(command.what == "start" for command in asked):
            self.starter.looked_at()
        return asked

    def counts(self) -> dict[str, int]:
        """Losses so far, for a Pulse."""
        return {
            "dropped": self._paired.dropped + self._reports.dropped,
            "late": self._paired.late,
            "malformed": self._reports.malformed,
            "foreign": self._reports.foreign,
        }

    def _who_came_and_went(self, now_s: float) -> list[Instant]:
        released: list[Instant] = []
        for moved in self._moves:
            if isinstance(moved, Ended):
                released += self._end(moved, now_s)
                continue
            number = self._numbers.get(moved.name)
            if number is not None and moved.alive:
                self._present = presence.came(self._present, number, now_s)
                self.over = tuple(said for said in self.over if said.viewer != number)
                self._paired = pairing.begin(self._paired, number)
            elif number is not None:
                self._present = presence.went(self._present, number, now_s)
                self._paired, more = pairing.away(self._paired, number)
                released += more
        self._moves = []
        return released

    def _end(self, said: Ended, now_s: float) -> list[Instant]:
        """A viewer has ended; what waited for it is released."""
        self._present = presence.ended(self._present, said, now_s)
        self.over = (*self.over, said)
        self._paired, released = pairing.end(self._paired, said.viewer)
        return released
