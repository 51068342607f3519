"""Fits the run again beside the retouching page, with all that was said so far (T22, T26)."""

import threading
from collections.abc import Callable
from typing import Final

from animator.take import Take
from common.notes.notes import Notes

END_S: Final = 10.0
"""At the page's end: whoever fits has been told to leave off."""

Tell = Callable[[str, bool], object]
"""Hears how it goes, and whether that is well."""
Fit = Callable[[Notes, Callable[[str], object]], Take]
"""Fits the run's video with these notes, tells how far it is, and gives the run as it is then.
Raises FitError."""
Taken = Callable[[Take, Notes], object]
"""Hears what a fit gave, and with which notes."""


class FitError(RuntimeError):
    """The run cannot be fitted again, and stays as it was: the text says why and what to do."""


class Fitting:
    """One fit at a time, in a thread of its own.

    Args:
        fit: Does it.
        taken: Hears of it.
        tell: Hears how it goes.
    """

    def __init__(self, fit: Fit, taken: Taken, tell: Tell) -> None:
        self._fit, self._taken, self._tell = fit, taken, tell
        self._thread: threading.Thread | None = None

    def begin(self, notes: Notes) -> None:
        """Fit with these notes, unless one goes on."""
        if self._thread is not None and self._thread.is_alive():
            self._tell("the video is still being fitted", False)
            return
        self._tell("fitting the video again", True)
        self._thread = threading.Thread(target=self._run, args=(notes,), daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Until the fit that goes on, if any, is over."""
        if self._thread is not None:
            self._thread.join(END_S)

    def _run(self, notes: Notes) -> None:
        try:
            self._taken(self._fit(notes, lambda text: self._tell(text, True)), notes)
        except FitError as error:
            self._tell(str(error), False)
