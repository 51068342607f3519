"""A rig asked of a child process: the frames of the run wait for nothing of it."""

import base64
import contextlib
import threading
from queue import Empty, SimpleQueue
from typing import Final

import msgspec

from calibration.tracks.lateness import LEAST_LATE
from common.platform.platform import Broken, Child
from common.platform.platforms import platform
from integrator.live_rig.rig_job import LENGTH, Job, Solved, solved

MODULE: Final = f"{__package__}.rig_child"
STALL_S: Final = 120.0
"""A child that has found nothing for so long is ended: it needs 3 s of a quiet machine."""


class RigSolver:
    """Does one job at a time, each in a child of its own."""

    def __init__(self) -> None:
        """Nothing is asked."""
        self._solved: SimpleQueue[Solved] = SimpleQueue()
        self._child: Child | None = None

    def ask(self, job: Job) -> None:
        """Begin a job; not before the one before it is answered. It is, whatever happens."""
        threading.Thread(target=self._do, args=(job,), name="rig", daemon=True).start()

    def answer(self) -> Solved | None:
        """What was found, if it is there by now."""
        with contextlib.suppress(Empty):
            return self._solved.get_nowait()
        return None

    def close(self) -> None:
        """End the child, whatever it does."""
        if self._child is not None:
            self._child.kill()

    def _do(self, job: Job) -> None:
        answer = Solved(refusal="the search for it ended without an answer")
        try:
            with contextlib.closing(platform().child(MODULE, STALL_S)) as child:
                self._child = child
                child.ask(base64.b64encode(msgspec.msgpack.encode(job)))
                answer = _answer(child)
        except Broken as error:
            answer = Solved(refusal=f"the process that looks for it is gone: {error}")
        except (OSError, msgspec.DecodeError) as error:
            answer = Solved(refusal=f"the process that looks for it cannot be asked: {error}")
        finally:
            self._child = None
            self._solved.put(answer)


def _answer(child: Child) -> Solved:
    head = bytearray(LENGTH.size)
    child.read_into(memoryview(head))
    body = bytearray(LENGTH.unpack(head)[0])
    child.read_into(memoryview(body))
    return msgspec.msgpack.decode(body, type=Solved)


class SolverAtOnce:
    """Does each job while it is asked: for steps that wait for each other."""

    def __init__(self) -> None:
        """Nothing is asked."""
        self._solved: Solved | None = None

    def ask(self, job: Job) -> None:
        """Do a job; what it finds of clocks is told, not set, for frames are paired already."""
        found = solved(job)
        if abs(found.late_s - job.late_s) >= LEAST_LATE * job.period_s:
            found = Solved(refusal=f"view 2 is {1e3 * found.late_s:+.0f} ms late")
        self._solved = found

    def answer(self) -> Solved | None:
        """What was found."""
        found, self._solved = self._solved, None
        return found

    def close(self) -> None:
        """Nothing goes on."""
