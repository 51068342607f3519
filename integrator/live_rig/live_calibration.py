"""The rig of a run that has no calibration: gathered, asked for, and changed to, with a word."""

from common.config import Settings
from common.method import METHODS
from common.video.clip_facts import Clip
from integrator.live_rig import rig_change, rig_search
from integrator.live_rig.rig_solver import RigSolver
from integrator.merge_state import State
from integrator.pairing import Pair


class LiveCalibration:
    """Hears what the views see, and says when the rig is another."""

    def __init__(self, state: State, *, looks: bool, late_s: float = 0.0) -> None:
        """It does nothing but where it looks for a rig.

        Args:
            state: Of the run.
            looks: Whether it does.
            late_s: What is known of view 2 already.
        """
        self.news: tuple[str, ...] = ()
        self.late_s = late_s
        """By how much the times of view 2 are to be set back."""
        self._search = rig_search.init(state.smooth.period_s, state.settings.body.stature_m)
        self._solver = RigSolver()
        self._looks = looks
        self._now_s = 0.0

    def __enter__(self) -> "LiveCalibration":
        """Nothing is started before it is needed."""
        return self

    def __exit__(self, *_: object) -> None:
        """End what is still looked for."""
        self._solver.close()
        if self._looks and self._search.rig is None:
            self._tell(f"the rig stayed assumed: {rig_search.why_none(self._search)}")

    def heard(self, pair: Pair) -> None:
        """One instant more."""
        if not self._looks or self._search.is_over:
            return
        self._now_s = pair.newest.captured_s
        self._search, job = rig_search.step(self._search, pair)
        if job is not None:
            self._solver.ask(job)

    def changed(self, state: State) -> State:
        """The state with the rig that was found since, if one was."""
        solved = self._solver.answer()
        if solved is None:
            return state
        self._search, is_taken = rig_search.answered(self._search, solved)
        if is_taken:
            assert self._search.rig is not None
            self.late_s = self._search.late_s
            state = rig_change.with_rig(state, self._search.rig)
            self._tell(rig_change.word_of(solved, self.late_s))
        return state

    def _tell(self, text: str) -> None:
        self.news = (*self.news, f"{self._now_s:.1f} s: {text}")


def is_by_person(clip: Clip, settings: Settings) -> bool:
    """Whether the person is to tell the rig of a run, while it goes on."""
    method = METHODS[settings.mode]
    shown = method.landmarks and method.proposals and settings.landmarks != "none"
    return clip.rig is None and len(clip.views) == 2 and shown
