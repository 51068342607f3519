"""Plays a run on the retouching page, until stopped or at its end."""

import threading
from collections.abc import Callable
from typing import Final

ROWS_HZ: Final = 15.0
"""Frame rate of the player, Hz, whatever the video's rate: enough to see a joint that jumps."""


class Player:
    """Shows one row after the other.

    Args:
        advance: Shows the next row; returns False where there is none.
    """

    def __init__(self, advance: Callable[[], bool]) -> None:
        self._advance = advance
        self._stops = threading.Event()
        self._stops.set()
        self._lock = threading.Lock()

    @property
    def playing(self) -> bool:
        """Whether it is playing."""
        return not self._stops.is_set()

    def toggle(self) -> None:
        """Start or stop playing."""
        with self._lock:
            if self.playing:
                self.stop()
                return
            self._stops = threading.Event()
            threading.Thread(target=self._play, args=(self._stops,), daemon=True).start()

    def stop(self) -> None:
        """Stop; the row being shown is the last."""
        self._stops.set()

    def _play(self, stops: threading.Event) -> None:
        try:
            while not stops.wait(1.0 / ROWS_HZ) and self._advance():
                pass
        finally:  # Even when a row cannot be shown.
            stops.set()
