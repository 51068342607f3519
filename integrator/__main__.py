"""The integrator process: pairs of reports in, bodies and guides out; the room's clock."""

import gc
import logging
import threading
import time
from typing import Final

from common.bus.bus import Bus, open_hub
from common.bus.control_messages import Cameras, ClockAnswer, ClockQuestion, Command, Ended
from common.bus.messages import Guide, Report, ViewerNumber
from common.bus.process import PAGE_S, Heart, ProcessContext, process
from common.bus.rate import Pace
from common.config import Settings
from common.method import METHODS
from common.video.clip_facts import Clip
from integrator import commands, diagnostics, merge, merge_state, opening_posture, pairing, presence
from integrator.frame_numbers import frame_times
from integrator.handed_over import Estate
from integrator.integrator_warmup import warm_up
from integrator.live_rig.live_calibration import LiveCalibration, is_by_person
from integrator.live_rig.rig_change import set_back
from integrator.merge_state import Start, State
from integrator.pairing import Pair
from integrator.single.sight import Annotations

LEAD_S: Final = 0.5
"""From the last viewer's being ready to the first frame: time for all to hear of it."""
HEAR_S: Final = 0.02
LOOK_S: Final = 0.5
"""Viewers so fast that a report always waits are asked after so long whether they are there."""
LAST_WORDS_S: Final = 1.0
"""All others meet here: how long the room stays open after the last body."""
SUPERVISED_S: Final = 60.0
"""The same where a supervisor ends the processes in order."""
ASLEEP_S: Final = 0.5
"""A round that took longer was stopped, or starved: what was said meanwhile is on its way still,
and its speakers are not to blame."""
AWAKE_S: Final = 0.3
"""For so long after it nobody is called late: all that waits is taken in first, and caught up."""
GATHER_S: Final = 0.3
"""Started again in the middle of a run, it waits so long for what the viewers say once more, and
takes it in by its time."""
OVERDUE_PERIODS: Final = 2.0
"""A report whose partner is two frames late goes on alone, and so do those after it."""

log = logging.getLogger(__name__)


class Starter:
    """Answers what the room's clock says, and fixes the start once every viewer is ready, and
    somebody looks, where that is waited for."""

    def __init__(self, expected: frozenset[ViewerNumber], wait_s: float = 0.0) -> None:
        """Viewers that belong to the run, and how long they wait for somebody to look."""
        self._missing = set(expected)
        self._start_s: float | None = None
        self._wait_s = wait_s
        self._ready_s: float | None = None

    def answer(self, question: ClockQuestion) -> ClockAnswer:
        """What the clock says now; the start, if it is fixed. Called by the bus's own thread."""
        now_s = time.monotonic()
        if question.ready:
            self._missing.discard(question.viewer)
        if not self._missing and self._ready_s is None:
            self._ready_s = now_s
        if self._ready_s is not None and self._start_s is None:
            looked_for = now_s - self._ready_s >= self._wait_s
            self._start_s = now_s + LEAD_S if looked_for else None
        return ClockAnswer(now_s=now_s, start_s=self._start_s)

    def looked_at(self) -> None:
        """Somebody looks: nothing else is waited for."""
        self._wait_s = 0.0

    @property
    def fixed(self) -> bool:
        """Whether the start is known."""
        return self._start_s is not None

    def begun(self, report: Report) -> None:
        """The run has begun: this process was started again, and its viewers were not."""
        if self._start_s is None:
            self._start_s = report.clock_s - report.captured_s


class Subscriber:
    """What the viewers say, in pairs of one instant, and who of them is there."""

    def __init__(
        self, bus: Bus, viewers: tuple[ViewerNumber, ...], period_s: float, wait_s: float
    ) -> None:
        """Listen from now on."""
        self.starter = Starter(frozenset(viewers), wait_s)
        self._commands = bus.subscribe(Command)
        self._numbers = {f"viewer {number}": number for number in viewers}
        self._reports, self._ended = bus.subscribe(Report), bus.subscribe(Ended)
        self._alive = bus.watch_alive()
        self._paired = pairing.init(period_s, viewers)
        self._present = presence.init(period_s, viewers)
        self._wait_s = OVERDUE_PERIODS * period_s
        self.late_s = 0.0
        """By how much the times of view 2 are set back."""
        self._looked_s = self._round_s = time.monotonic()
        self._judges_s = 0.0
        """From then on it is asked who is late or silent."""
        bus.answer(ClockQuestion, self.starter.answer)

    @property
    def going(self) -> bool:
        """Whether any viewer may still say something."""
        return presence.going(self._present, time.monotonic())

    @property
    def news(self) -> tuple[str, ...]:
        """Which views were lost and found, and why."""
        return self._present.news

    def pairs(self) -> list[Pair]:
        """What is complete now, or overdue; waits a moment for a report."""
        complete: list[Pair] = []
        first = self._reports.take(HEAR_S)
        if first is not None and not self.starter.fixed:
            time.sleep(GATHER_S)
        said = [] if first is None else [first, *self._reports.drain()]
        for report in said:
            self.starter.begun(report)
        reports = [set_back(report, self.late_s) for report in said]
        reports.sort(key=lambda report: report.captured_s)
        now_s = time.monotonic()
        for report in reports:
            self._present = presence.heard(self._present, report, now_s)
            self._paired, more = pairing.step(self._paired, report)
            complete += more
        if not reports or now_s - self._looked_s > LOOK_S:
            # What a viewer said before it went comes first, unless there is always a report.
            complete += self._who_came_and_went(now_s)
            self._looked_s = now_s
        if self._is_caught_up(reports, now_s):
            wait_s = self._wait_s + abs(self.late_s)
            self._paired, alone = pairing.overdue(self._paired, now_s, wait_s)
            complete += alone
            self._present, told = presence.step(self._present, now_s)
            for line in told:
                log.warning(line)
        return complete

    def _is_caught_up(self, reports: list[Report], now_s: float) -> bool:
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

    def _who_came_and_went(self, now_s: float) -> list[Pair]:
        released: list[Pair] = []
        for alive in self._alive.drain():
            number = self._numbers.get(alive.name)
            if number is not None and alive.alive:
                self._present = presence.came(self._present, number, now_s)
                self._paired = pairing.begin(self._paired, number)
            elif number is not None:
                self._present = presence.went(self._present, number, now_s)
                self._paired, more = pairing.away(self._paired, number)
                released += more
        for over in self._ended.drain():
            self._present = presence.ended(self._present, over, now_s)
            self._paired, more = pairing.end(self._paired, over.viewer)
            released += more
        return released


def run(
    state: State,
    viewers: tuple[ViewerNumber, ...],
    period_s: float,
    bus: Bus,
    stop: threading.Event,
    wait_s: float = 0.0,
    estate: Estate = Estate(None),
) -> None:
    """Pair and merge what the viewers report, until each has ended; wait so long for the page."""
    pace = Pace(period_s)
    heart = Heart(bus, "integrator", pace)
    subscriber = Subscriber(bus, viewers, period_s, wait_s)
    noticed, said, told = diagnostics.State(), Annotations(), Told(bus)
    heart.beat("ready", "\n".join(diagnostics.assumed(state)))
    looks = state.scale_source == "assumed" and state.proposes and len(viewers) == 2
    with LiveCalibration(state, looks=looks, late_s=estate.late_s) as calibration:
        while subscriber.going and not stop.is_set():
            state, said = _obeyed(state, said, subscriber.commands(), bus)
            subscriber.late_s = calibration.late_s
            for pair in subscriber.pairs():
                state, body, guide = merge.step(state, pair, said)
                said = Annotations()
                noticed = diagnostics.step(noticed, pair)
                bus.publish(guide)
                bus.publish(body)
                pace.done(body.clock_s, time.monotonic())
                calibration.heard(pair)
            state = calibration.changed(state)
            told.rig(state, calibration.late_s)
            news = (*calibration.news, *subscriber.news)
            if told.is_new(news):
                heart.hurry()
            estate.leave(state, calibration.late_s, time.monotonic())
            odd = [*diagnostics.assumed(state), *told.doubts(state), *news]
            heart.beat("running", "\n".join(odd), **subscriber.counts())
    news = (*told.doubts(state), *calibration.news, *subscriber.news)
    odd = [*diagnostics.warnings(noticed, state), *news]
    heart.beat("ended", "\n".join(odd), **subscriber.counts())


class Told:
    """What was told of the run already."""

    def __init__(self, bus: Bus) -> None:
        """Nothing."""
        self._bus, self._calibration = bus, -1
        self._news: tuple[str, ...] = ()
        self._doubt = ""

    def rig(self, state: State, late_s: float) -> None:
        """Tell the rig as soon as it is known, and each that comes after it."""
        if state.rig is not None and state.calibration > self._calibration:
            self._bus.publish(
                Cameras(
                    rig=state.rig,
                    scale_source=state.scale_source,
                    calibration=state.calibration,
                    late_s=late_s,
                )
            )
            self._calibration, self._doubt = state.calibration, ""

    def doubts(self, state: State) -> list[str]:
        """That the rig in use is not believable, as it was first seen."""
        self._doubt = self._doubt or diagnostics.doubt(state)
        return [self._doubt] if self._doubt else []

    def is_new(self, news: tuple[str, ...]) -> bool:
        """Whether there are other news than before."""
        before, self._news = self._news, news
        return news != before


def _obeyed(
    state: State, said: Annotations, asked: list[Command], bus: Bus
) -> tuple[State, Annotations]:
    """What the person at the page asks for, done and answered."""
    for command in asked:
        state, said, answer = commands.step(state, said, command)
        if answer is not None:
            bus.publish(answer)
    return state, said


def main(settings: Settings, clip: Clip, context: ProcessContext = ProcessContext()) -> None:
    """Open the room, merge until the viewers end, close.

    Args:
        settings: Of the run.
        clip: What the viewers look at: their numbers, the rate, the rig.
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
            ),
        )
        state = estate.taken_up(state)
        warm_up(settings, clip.views[0].size)
        gc.collect()
        gc.freeze()
        bus.announce("integrator")  # viewers say then what was not heard: it listens at once
        run(state, viewers, period_s, bus, stop, page_wait_s(settings, clip, context), estate)
        stop.wait(SUPERVISED_S if context.supervised else LAST_WORDS_S)


def page_wait_s(settings: Settings, clip: Clip, context: ProcessContext) -> float:
    """How long a run waits for somebody to open its page: a camera waits for nobody."""
    recorded = not any(isinstance(view.source, int) for view in clip.views)
    waits = context.supervised and settings.page.port and settings.page.wait and recorded
    return PAGE_S if waits else 0.0
