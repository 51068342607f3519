"""The terminal display of a live run: the table of processes, the page's address, news."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Final

from rich.console import Console, Group
from rich.live import Live as LiveDisplay
from rich.markup import escape
from rich.table import Table

from common.bus.control_messages import Pulse
from common.bus.messages import MOST_PEOPLE
from common.config.settings import Settings
from common.video.clip_facts import Clip
from common.video.clip_sources import camera_words
from runtime.live.launch import Heard
from runtime.live.table import table_of, table_of_people
from runtime.terminal import warn

MOST_NEWEST: Final = 2 * MOST_PEOPLE
"""Upper bound of the bodies of an instant."""


class Screen:
    """The display of a run: the tables of processes and people, and each piece of news once."""

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
        shown = Group(table_of(names, {}, self._title, self._cameras))
        with LiveDisplay(
            shown, console=self._console, refresh_per_second=4, transient=True
        ) as display:

            def show(heard: Heard) -> None:
                nonlocal shown
                self._news(heard)
                people = _people(heard)
                table = table_of(names, heard.pulses, self._title, self._cameras)
                shown = Group(*[table, *([] if people is None else [people])])
                display.update(shown)

            yield show
        self._console.print(shown)

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


def _people(heard: Heard) -> Table | None:
    """Those of the newest instant; None in a run that follows one person, whose number is 0."""
    last = heard.bodies.newest(lambda body: body.person > 0, 1)
    if not last:
        return None
    bodies = heard.bodies.newest(lambda body: body.captured_s == last[0].captured_s, MOST_NEWEST)
    postures = heard.postures.newest(lambda posture: posture.person > 0, 2 * len(bodies))
    return table_of_people(bodies, postures)


def warnings_of(pulses: Mapping[str, Pulse]) -> list[str]:
    """Warnings of viewers and integrator: their pulses hold all of them, one line each."""
    return [
        line
        for name, pulse in sorted(pulses.items())
        if name.startswith("viewer") or name == "integrator"
        for line in pulse.detail.splitlines()
    ]
