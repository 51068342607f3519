"""The process of one site: a live run that reports its state once a second."""

import os
import time
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Final

import psutil
from rich.console import Console

from common.bus.message_codec import encode
from common.bus.process import BEAT_S
from runtime.live.launch import Heard
from runtime.live.session import live
from runtime.serving.site_status import site_pulse
from runtime.serving.sites import Site

ENDED: Final = "ended"


class Teller:
    """Reports the state to the service; it never blocks, even without a reader."""

    def __init__(self, name: str, words: Connection) -> None:
        """On a pipe that successive processes may share."""
        self._name, self._words = name, words
        self._next_s = 0.0
        self._self = psutil.Process()
        os.set_blocking(words.fileno(), False)

    def __call__(self, heard: Heard) -> None:
        """Once a second, and when the run is over."""
        pulse = site_pulse(self._name, heard.pulses, self._self.memory_info().rss / 1e6)
        now_s = time.monotonic()
        if pulse.state != ENDED and now_s < self._next_s:
            return
        self._next_s = now_s + BEAT_S
        with suppress(BlockingIOError):  # a pulse fits into a pipe's atomic write
            self._words.send_bytes(encode(pulse))


def main(site: Site, words: Connection) -> None:
    """Run a site until its clips end or it is stopped.

    Raises:
        ClipError, LiveRefused, PartFailed and others: As `live` does.
    """
    live(
        site.settings,
        site.out,
        Console(quiet=True),
        site.name,
        tell=Teller(site.name, words),
        together=site.together,
    )
