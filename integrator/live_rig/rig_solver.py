"""Rigs computed by a child process: the run's frames never wait for it."""

import base64
import contextlib
import threading
from collections.abc import Callable
from queue import Empty, SimpleQueue
from typing import Any, Final, Generic, TypeVar

import msgspec

from calibration.tracks.lateness import LEAST_LATE
from common.platform.platform import Broken, Child
from common.platform.platforms import platform
from integrator.live_rig.odd_job import OddAnswer, OddJob
from integrator.live_rig.rig_job import LENGTH, Job, Solution, Solved, Unsolved, solved

MODULE: Final = f"{__package__}.rig_child"
STALL_S: Final = 120.0
"""Time after which a child without a result is ended, seconds: it needs 3 s on an idle machine."""


Request = TypeVar("Request", bound=msgspec.Struct)
Response = TypeVar("Response")


class ChildSolver(Generic[Request, Response]):
    """Solves one request at a time, each in a child of its own."""

    def __init__(self, answers: Any, failed: Callable[[str], Response]) -> None:
        """No request yet.

        Args:
            answers: Type of the answers.
            failed: Makes the answer to a request that the child could not answer, of the cause.
        """
        self._answers, self._failed = answers, failed
        self._solved: SimpleQueue[Response] = SimpleQueue()
        self._child: Child | None = None

    def ask(self, job: Request) -> None:
        """Begin a job, once the one before is answered; every job is, whatever happens."""
        threading.Thread(target=self._do, args=(job,), name="rig", daemon=True).start()

    def answer(self) -> Response | None:
        """The result, if it is there by now."""
        with contextlib.suppress(Empty):
            return self._solved.get_nowait()
        return None

    def close(self) -> None:
        """End the child, whatever its state."""
        if self._child is not None:
            self._child.kill()

    def _do(self, job: Request) -> None:
        answer = self._failed("the search for it ended without an answer")
        try:
            with contextlib.closing(platform().child(MODULE, STALL_S)) as child:
                self._child = child
                child.ask(base64.b64encode(msgspec.msgpack.encode(job)))
                answer = msgspec.msgpack.decode(_answer(child), type=self._answers)
        except Broken as error:
            answer = self._failed(f"the process that looks for it is gone: {error}")
        except (OSError, msgspec.DecodeError) as error:
            answer = self._failed(f"the process that looks for it cannot be asked: {error}")
        finally:
            self._child = None
            self._solved.put(answer)


def _answer(child: Child) -> bytearray:
    head = bytearray(LENGTH.size)
    child.read_into(memoryview(head))
    body = bytearray(LENGTH.unpack(head)[0])
    child.read_into(memoryview(body))
    return body


class RigSolver(ChildSolver[Job, Solution]):
    """Finds rigs by the person."""

    def __init__(self) -> None:
        """No job yet."""
        super().__init__(Solution, Unsolved)


class OddSolver(ChildSolver[OddJob, OddAnswer]):
    """Finds the camera that contradicts all others."""

    def __init__(self) -> None:
        """No job yet."""
        super().__init__(OddAnswer, Unsolved)


class SolverAtOnce:
    """Solves each job during the call: for lock-step."""

    def __init__(self) -> None:
        """No job yet."""
        self._solved: Solution | None = None

    def ask(self, job: Job) -> None:
        """Do a job; a delay that it finds is reported, not applied, as frames are paired
        already."""
        found = solved(job)
        if (
            isinstance(found, Solved)
            and abs(found.late_s - job.late_s) >= LEAST_LATE * job.period_s
        ):
            found = Unsolved(f"view 2 is {1e3 * found.late_s:+.0f} ms late")
        self._solved = found

    def answer(self) -> Solution | None:
        """The result."""
        found, self._solved = self._solved, None
        return found

    def close(self) -> None:
        """There is nothing to stop."""
