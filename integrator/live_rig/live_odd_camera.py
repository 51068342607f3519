"""Finds the camera of three or more that looks beside its calibration, during a run."""

from collections.abc import Mapping
from typing import Protocol, Self

from calibration.gate import odd_camera
from calibration.gate.odd_camera import OddCamera
from common.bus.control_messages import TurnedBack
from common.bus.messages import View
from integrator.live_rig import odd_search, rig_change
from integrator.live_rig.odd_job import OddAnswer, OddJob
from integrator.live_rig.rig_solver import OddSolver
from integrator.merge_state import State


class Solver(Protocol):
    """Answers one request at a time."""

    def ask(self, job: OddJob) -> None:
        """Begin a request."""

    def answer(self) -> OddAnswer | None:
        """The answer, if it is there by now."""

    def close(self) -> None:
        """Stop the present request."""


class LiveOddCamera:
    """Receives the instants; a camera that contradicts all others is turned back, as recorded
    clips are tracked (`runtime/odd_view.py`), from then on."""

    def __init__(self, state: State, solver: Solver | None = None) -> None:
        """It does nothing with fewer than three cameras, an assumed or a trusted rig.

        Args:
            state: The integrator's state.
            solver: Finds it; None: in a child process.
        """
        cameras = 0 if state.rig is None else len(state.rig.cameras)
        known = state.scale_source == "calibrated" and not state.settings.trust_calibration
        self._looks = cameras > 2 and known and state.method.landmarks
        self._search = odd_search.State(state.calibration)
        self._solver = solver or OddSolver()
        self.news: tuple[str, ...] = ()
        """What was turned, one line each time."""
        self.odd: TurnedBack | None = None
        """The camera turned last."""

    def __enter__(self) -> Self:
        """Nothing starts before it is needed."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the search."""
        self._solver.close()

    def looks(self, room: State) -> bool:
        """Whether what is seen is evidence, and asked for.

        Args:
            room: The integrator's state.
        """
        is_over = self._search.is_over and self._search.calibration == room.calibration
        return self._looks and room.rig is not None and not (room.stands.doubtful or is_over)

    def heard(self, people: Mapping[int, Mapping[int, View]], room: State) -> None:
        """Process one instant.

        Args:
            people: By person's number, then by view: where no other person is close to them.
            room: The integrator's state after it.
        """
        if room.rig is None or not self.looks(room):
            return
        if room.calibration != self._search.calibration:
            self._search = odd_search.anew(self._search, room.calibration)
        self._search, job = odd_search.step(self._search, room.rig, people, room.period_s)
        if job is not None:
            self._solver.ask(job)

    def changed(self, room: State) -> State:
        """The state with an odd camera turned back, if one was found meanwhile."""
        answer = self._solver.answer() if self._search.waits else None
        if answer is None:
            return room
        if room.calibration != self._search.calibration or room.stands.doubtful:
            self._search = odd_search.anew(self._search, room.calibration)
        self._search, odd = odd_search.answered(self._search, answer)
        if odd is None or room.rig is None:
            return room
        self._tell(odd, room.last_s or 0.0)
        return rig_change.with_rig(room, odd_camera.turned_back(room.rig, odd))

    def _tell(self, odd: OddCamera, now_s: float) -> None:
        self.odd = TurnedBack(odd.place + 1, odd.turn, odd.apart_m, odd.then_m)
        said = odd_camera.report_of(
            f"camera {odd.place + 1}",
            odd.turned_deg,
            1e3 * odd.apart_m,
            1e3 * odd.then_m,
            since="from now on",
        )
        self.news = (*self.news, f"{now_s:.1f} s: {said}")
