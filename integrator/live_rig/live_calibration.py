"""Requests a rig for a run that has none, or whose cameras are moved, and applies it."""

from typing import Final, NamedTuple, Protocol

from calibration.gate.moved_cameras import turned_rig
from common.bus.instant import Instant, first_two
from common.config.settings import Settings
from common.method import METHODS
from common.video.clip_facts import Clip
from integrator import diagnostics
from integrator.live_rig import recent_views, rig_change, rig_search
from integrator.live_rig.rig_job import Job, Solution
from integrator.live_rig.rig_solver import RigSolver
from integrator.merge_state import State

BELIEVED_BY_NONE: Final = "the rig that is not believable stayed"


class Solver(Protocol):
    """Solves one job at a time."""

    def ask(self, job: Job) -> None:
        """Begin a job."""

    def answer(self) -> Solution | None:
        """The result, if it is there by now."""

    def close(self) -> None:
        """Stop the present job."""


class Looking(NamedTuple):
    """State of the search for a rig."""

    search: rig_search.State
    looks: bool
    """True while it goes on."""
    late_s: float = 0.0
    """Time by which the times of view 2 shall be set back."""
    stays: str = "the rig stayed assumed"
    """The report where no rig is found."""
    doubted: int = -1
    """Number of the rig that was doubted last."""
    now_s: float = 0.0
    lately: recent_views.State = recent_views.State()
    news: tuple[str, ...] = ()
    """The reports so far."""


class LiveCalibration:
    """Receives the views, and applies a new rig when there is one."""

    def __init__(
        self, state: State, *, looks: bool, late_s: float = 0.0, solver: Solver | None = None
    ) -> None:
        """It does nothing while no rig is searched for.

        Args:
            state: The integrator's state.
            looks: Whether it searches from the start; otherwise it begins when the rig becomes
                wrong.
            late_s: Known delay of view 2.
            solver: Finds rigs; None: in a child process.
        """
        search = rig_search.init(state.period_s, state.settings.body.stature_m)
        self.looking = Looking(search._replace(late_s=late_s), looks, late_s)
        self._solver = solver or RigSolver()

    @property
    def news(self) -> tuple[str, ...]:
        """What happened to the rig, one line each time."""
        return self.looking.news

    @property
    def late_s(self) -> float:
        """Time by which the times of view 2 shall be set back."""
        return self.looking.late_s

    def __enter__(self) -> "LiveCalibration":
        """Nothing starts before it is needed."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the search."""
        self._solver.close()
        at = self.looking
        if at.looks and at.stays:
            self._tell(f"{at.stays}: {rig_search.why_none(at.search)}")

    def heard(self, instant: Instant) -> None:
        """Process one instant."""
        lately = recent_views.step(self.looking.lately, first_two(instant.views))
        at = self.looking = self.looking._replace(now_s=instant.newest.captured_s, lately=lately)
        if not at.looks or at.search.is_over:
            return
        search, job = rig_search.step(at.search, first_two(instant.views))
        self.looking = at._replace(search=search)
        if job is not None:
            self._solver.ask(job)

    def changed(self, state: State) -> State:
        """The state with a rig found meanwhile, if any; turned, if a camera was."""
        state = self._after_moves(state)
        self._look_where_doubted(state)
        answer = self._solver.answer()
        if answer is None:
            return state
        search, taken = rig_search.answered(self.looking.search, answer)
        self.looking = self.looking._replace(search=search)
        if taken is not None:
            self.looking = self.looking._replace(late_s=search.late_s, stays="")
            state = rig_change.with_rig(state, taken.rig)
            self._tell(rig_change.word_of(taken, search.late_s, search.moved))
        return state

    def _after_moves(self, state: State) -> State:
        """The state with the moved cameras turned as their pictures show."""
        moved = state.stands.moved
        if not moved or state.rig is None or state.settings.trust_calibration:
            return state
        self._tell(rig_change.word_of_moved(state.rig, state.stands))
        was_sure = not state.stands.unconfirmed
        before, state = state.rig, rig_change.with_rig(state, turned_rig(state.rig, state.stands))
        at = self.looking = self.looking._replace(looks=True)
        if state.scale_source == "assumed":
            self.looking = at._replace(search=rig_search.anew(at.search, None))
            return state
        stood = at.search.stood
        if stood is None or was_sure:
            stood = recent_views.stand_before(at.lately, before, at.now_s)
        search = rig_search.anew(at.search, state.rig, moved, stood)
        self.looking = at._replace(search=search, lately=recent_views.State(), stays="")
        return state

    def _look_where_doubted(self, state: State) -> None:
        """Begin a search where both views contradict the rig; once for each rig."""
        if self.looking.doubted == state.calibration or not diagnostics.doubt(state):
            return
        at = self.looking = self.looking._replace(doubted=state.calibration)
        if not at.looks or at.search.is_over or at.search.moved:
            search, stays = rig_search.anew(at.search, state.rig), BELIEVED_BY_NONE
            self.looking = at._replace(looks=True, search=search, stays=stays)

    def _tell(self, text: str) -> None:
        at = self.looking
        self.looking = at._replace(news=(*at.news, f"{at.now_s:.1f} s: {text}"))


def is_by_person(clip: Clip, settings: Settings) -> bool:
    """Whether a run's rig comes from the person, during the run."""
    method = METHODS[settings.mode]
    shown = method.landmarks and method.proposals and settings.landmarks != "none"
    return clip.rig is None and len(clip.views) == 2 and shown
