"""The terminal display of a live run: the table of processes, the page's address, news."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from rich.console import Console
from rich.live import Live as LiveDisplay
from rich.markup import escape

from common.bus.control_messages import Pulse
from common.config.settings import Settings
from common.video.clip_facts import Clip
from common.video.clip_sources import camera_words
from runtime.live.launch import Heard
from runtime.live.table import table_of
from runtime.terminal import warn


class Screen:
    """The display of a run: the table of processes, and each piece of news once."""

    def __init__(
        self, clip: Clip, settings: Settings, console: Console, address: Callable[[], str]
    ) -> None:
        """The run's display; `address` is that of its page, "" until it answers."""
        rate_hz = clip.views[0].fps / clip.every
        self._title = f"{clip.name}: {settings.mode} mode, {rate_hz:g} frames a second"
        self._cameras = camera_words(settings)
        self._console = console
        self._address = address
        self._told: set[str] = set()
        for warning in clip.warnings:
            self._warn(warning)

    @contextmanager
    def shown(self, names: list[str]) -> Iterator[Callable[[Heard], None]]:
        """A function that shows the newest pulses and news; the last ones stay when the run is
        over."""
        table = table_of(names, {}, self._title, self._cameras)
        with LiveDisplay(
            table, console=self._console, refresh_per_second=4, transient=True
        ) as display:

            def show(heard: Heard) -> None:
                nonlocal table
                self._news(heard)
                table = table_of(names, heard.pulses, self._title, self._cameras)
                display.update(table)

            yield show
        self._console.print(table)

    def tell_page(self) -> None:
        """Print the page's address once it answers."""
        if "page" not in self._told and (address := self._address()):
            self._told.add("page")
            text = f"the page: [link]{escape(address)}[/link]"
            self._console.print(text, highlight=False, soft_wrap=True)

    def _news(self, heard: Heard) -> None:
        for warning in [*warnings_of(heard.pulses), *heard.notes]:
            self._warn(warning)
        self.tell_page()
        posture = heard.pulses.get("recognizer")
        if posture is not None and posture.detail not in self._told | {""}:
            self._told.add(posture.detail)
            self._console.print(posture.detail, highlight=False)

    def _warn(self, text: str) -> None:
        if text not in self._told:
            self._told.add(text)
            warn(self._console, text)


def warnings_of(pulses: Mapping[str, Pulse]) -> list[str]:
    """Warnings of viewers and integrator: their pulses hold all of them, one line each."""
    return [
        line
        for name, pulse in sorted(pulses.items())
        if name.startswith("viewer") or name == "integrator"
        for line in pulse.detail.splitlines()
    ]
