"""Publishes the run's rig and warnings about views, each once."""

from common.bus.bus import Bus
from common.bus.control_messages import Cameras, TurnedBack
from integrator import diagnostics
from integrator.merge_state import State


class RigPublisher:
    """What was published so far."""

    def __init__(self, bus: Bus) -> None:
        """Nothing yet."""
        self._bus, self._calibration = bus, -1
        self._news: tuple[str, ...] = ()
        self._doubt = ""
        self._apart: list[str] = []

    def rig(self, state: State, late_s: float, odd: TurnedBack | None = None) -> None:
        """Publish the rig as soon as it is known, and each later one.

        Args:
            state: With the rig.
            late_s: Time by which the times of view 2 are set back.
            odd: The camera that it has turned back.
        """
        if state.rig is not None and state.calibration > self._calibration:
            self._bus.publish(
                Cameras(
                    rig=state.rig,
                    scale_source=state.scale_source,
                    calibration=state.calibration,
                    late_s=late_s,
                    odd=odd,
                )
            )
            self._calibration, self._doubt = state.calibration, ""

    def doubts(self, state: State) -> list[str]:
        """The first report that the rig in use is not believable; where the views follow different
        people, that instead."""
        if state.same.is_apart:
            self._apart = self._apart or diagnostics.different_people(state)
            return self._apart
        self._doubt = self._doubt or diagnostics.doubt(state)
        return [self._doubt] if self._doubt else []

    def is_new(self, news: tuple[str, ...]) -> bool:
        """Whether there is news."""
        before, self._news = self._news, news
        return news != before
