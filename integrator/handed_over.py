"""What an integrator leaves to its successor: body, rig, count, start, ended viewers."""

import logging
from pathlib import Path
from typing import Final

import msgspec

from calibration.gate.moved_cameras import AS_IT_WAS, MovedCameras
from common.atomic_file import replacing
from common.body.body import Bdp
from common.bus.control_messages import Ended
from common.bus.messages import ScaleSource
from common.rig.camera import Rig
from common.rig.upright import Shift
from integrator.measuring.known_body import Measured, Opening, Unknown, Unmeasured
from integrator.merge_state import State
from integrator.person import Waiting

NAME: Final = "integrator.msgpack"
LEAVE_S: Final = 1.0
NOWHERE_M: Final = (0.0, 0.0, 0.0)
"""Stands for where a body was measured that was not."""

log = logging.getLogger(__name__)


class HandedOver(msgspec.Struct, frozen=True):
    """The state that would take another T pose, or a wait for the viewers, to establish again."""

    bdp: Bdp | None
    measured: bool
    measured_at_m: tuple[float, float, float]
    rig: Rig | None
    scale_source: ScaleSource
    calibration: int
    """Number of changes of the rig."""
    late_s: float
    """Time by which the times of view 2 are set back."""
    numbered: int
    """The last number of an instant."""
    shifts: tuple[Shift, ...] = (AS_IT_WAS, AS_IT_WAS)
    """Shifts of the cameras' pictures when the rig was computed."""
    over: tuple[Ended, ...] = ()
    """Viewers that reported their end: they do not report it twice."""
    start_s: float | None = None
    """Start of the run, by this host's monotonic clock, which is the room's. Where the viewers
    died too, no other process knows it, and a recorded clip would be played from its beginning."""


def handed_over(
    state: State,
    late_s: float = 0.0,
    over: tuple[Ended, ...] = (),
    start_s: float | None = None,
) -> HandedOver:
    """The part of a state that is handed over, with the delay of view 2, the ended views and the
    start of the run."""
    known = state.person.body
    return HandedOver(
        known.bdp,
        isinstance(known, Measured),
        known.measured_at_m if isinstance(known, Measured) else NOWHERE_M,
        state.rig,
        state.scale_source,
        state.calibration,
        late_s,
        state.numbered,
        state.stands.of_rig,
        over,
        start_s,
    )


def resumed(state: State, given: HandedOver) -> State:
    """A new state with the handed-over knowledge; poses and filters begin anew."""
    return state._replace(
        person=Waiting(_body_of(given)),
        rig=given.rig,
        scale_source=given.scale_source,
        calibration=given.calibration,
        numbered=given.numbered,
        stands=MovedCameras(given.shifts, given.shifts),
    )


def _body_of(given: HandedOver) -> Opening:
    if given.bdp is None:
        return Unknown()
    return Measured(given.bdp, given.measured_at_m) if given.measured else Unmeasured(given.bdp)


class Estate:
    """The folder that holds it; without a folder nothing is left."""

    def __init__(self, folder: Path | None) -> None:
        """The folder of one run alone."""
        self._path = None if folder is None else folder / NAME
        self._left: HandedOver | None = None
        self.late_s = 0.0
        """Time by which the times of view 2 were set back."""
        self.over: tuple[Ended, ...] = ()
        """Viewers that had reported their end."""
        self.start_s: float | None = None
        """Start of the run."""
        self._next_s = 0.0

    def taken_up(self, state: State) -> State:
        """The state with what the predecessor left, if anything."""
        if self._path is None or not self._path.is_file():
            return state
        try:
            given = msgspec.msgpack.decode(self._path.read_bytes(), type=HandedOver)
        except (OSError, msgspec.DecodeError) as error:
            log.warning("what was handed over cannot be read (%s): the body is found anew", error)
            return state
        self.late_s, self.over, self.start_s = given.late_s, given.over, given.start_s
        return resumed(state, given)

    def leave(
        self,
        state: State,
        late_s: float,
        now_s: float,
        over: tuple[Ended, ...] = (),
        start_s: float | None = None,
    ) -> None:
        """Write what has changed, the count apart: it follows from time.

        At once where the run began, a body was measured, the rig changed or a view ended; else once
        a second.
        """
        if self._path is None:
            return
        own = handed_over(state, late_s, over, start_s)
        if self._is_known(own) or (now_s < self._next_s and not self._is_news(own)):
            return
        self._next_s = now_s + LEAVE_S
        try:
            with replacing(self._path) as path:
                path.write_bytes(msgspec.msgpack.encode(own))
        except OSError as error:
            log.warning("nothing can be handed over (%s)", error.strerror)
        self._left = own

    def _is_known(self, own: HandedOver) -> bool:
        if self._left is None:
            return own.bdp is None and own.rig is None and own.start_s is None
        same = msgspec.structs.replace(own, numbered=self._left.numbered)
        return bool(same == self._left)

    def _is_news(self, own: HandedOver) -> bool:
        """Whether its loss would be worse than that of values refined from frame to frame."""
        return self._left is None or _news(own) != _news(self._left)


def _news(given: HandedOver) -> tuple[object, ...]:
    return given.measured, given.calibration, given.over, given.start_s
