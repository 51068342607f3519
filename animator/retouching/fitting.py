"""Repeated fits of the run beside the retouching page, with all inputs so far (T22, T26)."""

import threading
from collections.abc import Callable
from typing import Final

from animator.take import Take
from common.notes.notes import Notes

END_S: Final = 10.0
"""How long to wait at the page's end for a fit that was asked to stop."""

Tell = Callable[[str, bool], object]
"""Called with a status line, and whether it is good news."""
Fit = Callable[[Notes, Callable[[str], object]], Take]
"""Fits the run's video with these notes, reports the progress, and returns the new run. Raises
FitError."""
Taken = Callable[[Take, Notes], object]
"""Called with a fit's result and its notes."""


class FitError(RuntimeError):
    """The run cannot be fitted again, and is unchanged: the text names the cause and the cure."""


class Fitting:
    """One fit at a time, in a thread of its own.

    Args:
        fit: The fitting function.
        taken: Called with its result.
        tell: Called with its progress.
    """

    def __init__(self, fit: Fit, taken: Taken, tell: Tell) -> None:
        self._fit, self._taken, self._tell = fit, taken, tell
        self._thread: threading.Thread | None = None

    def begin(self, notes: Notes) -> None:
        """Fit with these notes, unless a fit is in progress."""
        if self._thread is not None and self._thread.is_alive():
            self._tell("the video is still being fitted", False)
            return
        self._tell("fitting the video again", True)
        self._thread = threading.Thread(target=self._run, args=(notes,), daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Wait for the fit in progress, if any."""
        if self._thread is not None:
            self._thread.join(END_S)

    def _run(self, notes: Notes) -> None:
        try:
            self._taken(self._fit(notes, lambda text: self._tell(text, True)), notes)
        except FitError as error:
            self._tell(str(error), False)
