"""Ctrl-C and SIGTERM before a command can handle them: a message, an exit code, an end."""

import os
import signal
import sys
import threading
import time
from types import FrameType
from typing import Final, NoReturn

WORD: Final = "stopped before it was done"
BY_SIGNAL: Final = 128
"""Added to a signal's number in exit codes, by shells' convention."""
STOPS: Final = (BY_SIGNAL + signal.SIGINT, BY_SIGNAL + signal.SIGTERM)
"""Exit codes of a command that was stopped."""


STARTER: Final = "TRITRACK_STARTER"
"""Environment variable; where it is STARTER_PIPE, standard input is a pipe that the program that
started the command holds open as long as it lives, and the command ends with it."""
STARTER_PIPE: Final = "stdin"
ENDS_S: Final = 15.0
"""Seconds that a command without a starter takes to end in order, before it ends at once."""


class Terminated(SystemExit):
    """SIGTERM came: open resources are closed in order, as after Ctrl-C, which typer catches
    itself without a cause."""


def heed_at_once() -> None:
    """While a command's own modules are imported, a signal ends it with its message and code.

    A process of a run imports the command too, but its supervisor decides how it ends. Another
    program may import it as well, and its signals are its own. Called before any slow import.
    """
    folder, name = os.path.split(sys.argv[0])
    is_command = name == "tritrack" or (
        name == "__main__.py" and os.path.basename(folder) == "tritrack"
    )
    if is_command and not _is_started_by_us():
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, _leave)


def heed_in_order() -> None:
    """From now on a signal raises an exception where the command is, so that it closes its
    resources."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, _terminated)


def end_with_starter() -> None:
    """End in order, as by SIGTERM, once the program that started this command is gone.

    A killed program sends no signal; its end of the pipe is closed whatever ended it, on every
    system.
    """
    if os.environ.pop(STARTER, "") == STARTER_PIPE:
        threading.Thread(target=_await_hang_up, name="starter's death", daemon=True).start()


def _await_hang_up() -> None:
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(ENDS_S)
    os._exit(BY_SIGNAL + signal.SIGTERM)


def code_of_stop(error: BaseException) -> int:
    """The exit code of a command that a signal ended, by shells' convention."""
    number = signal.SIGTERM if isinstance(error, Terminated) else signal.SIGINT
    return BY_SIGNAL + number


def _is_started_by_us() -> bool:
    """Whether multiprocessing started this process: it is imported then, and while that process
    still imports the command only `_inheriting` shows it."""
    started = sys.modules.get("multiprocessing.process")
    return started is not None and (
        started.parent_process() is not None
        or getattr(started.current_process(), "_inheriting", False)
    )


def _leave(number: int, _frame: FrameType | None) -> NoReturn:
    os.write(2, f"error: {WORD}\n".encode())
    os._exit(BY_SIGNAL + number)


def _terminated(_number: int, _frame: FrameType | None) -> NoReturn:
    raise Terminated
