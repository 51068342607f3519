"""The start page, until Ctrl-C: from videos or cameras to a result without another command."""

import os
import secrets
import sys
import webbrowser
from contextlib import suppress
from typing import Final

from rich.console import Console

from animator.page.door import Entrance, invitation_of, refuse_port
from animator.start.start_page import StartPage
from common.bus.process import ProcessContext, process
from tritrack.starting.start_desk import Given, StartDesk
from tritrack.starting.start_letter import letter_of
from tritrack.starting.uploads import FOLDER

LOOK_S: Final = 0.01
"""Interval at which browsers' messages are read, seconds."""
SCREENS: Final = ("DISPLAY", "WAYLAND_DISPLAY")
"""Environment variables of a session with a screen."""


def start(given: Given, port: int, browser: bool, console: Console) -> None:
    """Serve the start page until Ctrl-C; its jobs end with it.

    Args:
        given: What the page is about.
        port: The page's port.
        browser: Open the user's browser, where there is a screen.
        console: Shows the page's address.

    Raises:
        PageError: When the port is taken or not allowed.
        UploadRefused: When the folder of the runs cannot be written.
    """
    refuse_port(port, cure="name another --port")
    entrance = Entrance(token=secrets.token_urlsafe())  # other users of this machine reach it too
    with process("start", ProcessContext()) as stop:
        desk = StartDesk(given)
        try:
            page = StartPage(desk.hello, desk.file, port, entrance)
            address = invitation_of(entrance, port)
            console.print(
                f"the page is at {address}; Ctrl-C ends it", highlight=False, soft_wrap=True
            )
            if browser and has_screen():
                with suppress(webbrowser.Error):
                    webbrowser.open(letter_of(given.runs / FOLDER, address).absolute().as_uri())
            try:
                while not stop.wait(LOOK_S):
                    desk.turn(page)
            finally:
                page.close()
        finally:
            desk.close()


def has_screen() -> bool:
    """Whether a browser with a window can be opened: on Linux only in a session with a screen."""
    return not sys.platform.startswith("linux") or any(os.environ.get(name) for name in SCREENS)
