"""What the viewers say, by the instant."""

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
"""Among reports of which one always waits, who came or went is believed after so long."""
ASLEEP_S: Final = 0.5
"""A round that took longer was stopped, or starved: what was said meanwhile is on its way still,
and its speakers are not to blame."""
AWAKE_S: Final = 0.3
"""For so long after it nobody is called late: all that waits is taken in first, and caught up."""
GATHER_S: Final = 0.3
"""Started again in the middle of a run, it waits so long for what the viewers say once more, and
takes it in by its time."""
OVERDUE_PERIODS: Final = 2.0
"""A report goes on without another of its instant that is two frames late, as do those after it."""

log = logging.getLogger(__name__)


class Subscriber:
    """What the viewers say, by the instant, and who of them is there."""

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
        """Listen to viewers of a rig of so many cameras from now on; the run may have begun, and
        some viewers have ended, before."""
        self.starter = Starter(frozenset(viewers), wait_s, start_s)
        self._gathers = start_s is not None
        """It was started again, and has yet to wait for what is said once more."""
        self._commands = bus.subscribe(Command)
        self._numbers = {f"viewer {number}": number for number in viewers}
        self._reports, self._ended = bus.subscribe(View), bus.subscribe(Ended)
        self._alive = bus.watch_alive()
        self._moves: list[Alive | Ended] = []
        """Who came, went and ended, until all is in that they reported before."""
        self._paired = pairing.init(period_s, viewers, cameras)
        self._present = presence.init(period_s, viewers, cameras)
        self._links = link_lag.init(period_s, cameras)
        self._period_s, self._overdue_s = period_s, OVERDUE_PERIODS * period_s
        self.late_s = 0.0
        """By how much the times of view 2 are set back."""
        self._looked_s = self._round_s = time.monotonic()
        self._judges_s = 0.0
        """From then on it is asked who is late or silent."""
        self.over: tuple[Ended, ...] = ()
        """What viewers said that have ended."""
        for said in over:
            self._end(said, self._looked_s)
        bus.answer(ClockQuestion, self.starter.answer)

    @property
    def going(self) -> bool:
        """Whether any viewer may still say something."""
        return presence.going(self._present, time.monotonic())

    @property
    def news(self) -> tuple[str, ...]:
        """Which views were lost and found, and why; whose link is slow."""
        return (*self._present.news, *self._links.news)

    @property
    def _wait_s(self) -> float:
        """How long after its picture a report goes on without others of its instant."""
        return self._overdue_s + link_lag.lag_s(self._links)

    def instants(self) -> list[Instant]:
        """What is complete now, or overdue; waits a moment for a report."""
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
            # What a viewer said before it went comes first: whoever moved had done so before a wait
            # for a report began that came to nothing, unless there is always a report.
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
        """Whether who has said nothing can be held to it: this process has listened itself."""
        if now_s - self._round_s > ASLEEP_S:
            self._judges_s = now_s + AWAKE_S
        self._round_s = now_s
        fresh = not reports or now_s - reports[-1].clock_s < self._wait_s
        return fresh and now_s >= self._judges_s

    def commands(self) -> list[Command]:
        """What the person at the page asks for since; that they are there is asked for too."""
        asked = self._commands.drain()
        if any(command.what == "start" for command in asked):
            self.starter.looked_at()
        return asked

    def counts(self) -> dict[str, int]:
        """What was lost so far, as a Pulse tells it."""
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
        """A viewer has said its last; what waited for it is released."""
        self._present = presence.ended(self._present, said, now_s)
        self.over = (*self.over, said)
        self._paired, released = pairing.end(self._paired, said.viewer)
        return released
