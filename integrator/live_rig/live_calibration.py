"""The rig of a run that has none, or whose cameras are moved: asked for, and changed to."""

from typing import Protocol

from common.config import Settings
from common.method import METHODS
from common.video.clip_facts import Clip
from integrator import diagnostics
from integrator.live_rig import rig_change, rig_search, seen_lately
from integrator.live_rig.rig_job import Job, Solved
from integrator.live_rig.rig_solver import RigSolver
from integrator.merge_state import State
from integrator.pairing import Pair
from integrator.rig_gate.moved_cameras import turned_rig


class Solver(Protocol):
    """Does one job at a time."""

    def ask(self, job: Job) -> None:
        """Begin a job."""

    def answer(self) -> Solved | None:
        """What was found, if it is there by now."""

    def close(self) -> None:
        """End what goes on."""


class LiveCalibration:
    """Hears what the views see, and says when the rig is another."""

    def __init__(
        self, state: State, *, looks: bool, late_s: float = 0.0, solver: Solver | None = None
    ) -> None:
        """It does nothing but where it looks for a rig.

        Args:
            state: Of the run.
            looks: Whether it does from the start; it begins to where the rig becomes wrong.
            late_s: What is known of view 2 already.
            solver: Finds rigs; None: in a child process.
        """
        self.news: tuple[str, ...] = ()
        self.late_s = late_s
        """By how much the times of view 2 are to be set back."""
        settings = state.settings
        search = rig_search.init(state.smooth.period_s, settings.body.stature_m)
        self._search = search._replace(late_s=late_s)
        self._solver = solver or RigSolver()
        self._looks, self._stays = looks, "the rig stayed assumed"
        self._doubted = -1
        self._now_s = 0.0
        self._lately = seen_lately.State()

    def __enter__(self) -> "LiveCalibration":
        """Nothing is started before it is needed."""
        return self

    def __exit__(self, *_: object) -> None:
        """End what is still looked for."""
        self._solver.close()
        if self._looks and self._stays:
            self._tell(f"{self._stays}: {rig_search.why_none(self._search)}")

    def heard(self, pair: Pair) -> None:
        """One instant more."""
        self._now_s = pair.newest.captured_s
        self._lately = seen_lately.step(self._lately, pair)
        if not self._looks or self._search.is_over:
            return
        self._search, job = rig_search.step(self._search, pair)
        if job is not None:
            self._solver.ask(job)

    def changed(self, state: State) -> State:
        """The state with the rig that was found since, if one was; turned, if a camera was."""
        state = self._after_moves(state)
        self._look_where_doubted(state)
        solved = self._solver.answer()
        if solved is None:
            return state
        self._search, is_taken = rig_search.answered(self._search, solved)
        if is_taken:
            assert self._search.rig is not None
            self.late_s, self._stays = self._search.late_s, ""
            state = rig_change.with_rig(state, self._search.rig)
            self._tell(rig_change.word_of(solved, self.late_s, self._search.moved))
        return state

    def _after_moves(self, state: State) -> State:
        """The state with the cameras that were moved turned as their pictures tell."""
        moved = state.stands.moved
        if not moved or state.rig is None or state.settings.trust_calibration:
            return state
        self._tell(rig_change.word_of_moved(state))
        was_sure = not state.stands.unconfirmed
        before, state = state.rig, rig_change.with_rig(state, turned_rig(state.rig, state.stands))
        self._looks = True
        if state.scale_source == "assumed":
            self._search = rig_search.anew(self._search, None)
            return state
        stood = self._search.stood
        if stood is None or was_sure:
            stood = seen_lately.stand_before(self._lately, before, self._now_s)
        self._lately, self._stays = seen_lately.State(), ""
        self._search = rig_search.anew(self._search, state.rig, moved, stood)
        return state

    def _look_where_doubted(self, state: State) -> None:
        """Begin to look where both views contradict the rig; once for each rig."""
        if self._doubted == state.calibration or not diagnostics.doubt(state):
            return
        self._doubted = state.calibration
        if not self._looks or self._search.is_over or self._search.moved:
            self._looks, self._search = True, rig_search.anew(self._search, state.rig)
            self._stays = "the rig that is not believable stayed"

    def _tell(self, text: str) -> None:
        self.news = (*self.news, f"{self._now_s:.1f} s: {text}")


def is_by_person(clip: Clip, settings: Settings) -> bool:
    """Whether the person is to tell the rig of a run, while it goes on."""
    method = METHODS[settings.mode]
    shown = method.landmarks and method.proposals and settings.landmarks != "none"
    return clip.rig is None and len(clip.views) == 2 and shown
