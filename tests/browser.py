"""A headless browser for tests of the page: what it shows, and whom it asks."""

import base64
import itertools
import json
import re
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
import pytest
from websockets.sync.client import connect
from websockets.sync.connection import Connection

from common.endpoint import is_loopback

WEBGL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""For pages with a scene of their own in 3-D; others are drawn sooner without."""
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-background-networking",
    "--no-first-run",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--remote-debugging-port=0",
)
LISTENS: Final = re.compile(r"DevTools listening on (\S+)\n")
START_S: Final = 60.0
END_S: Final = 20.0


class NotNow(RuntimeError):
    """The browser refused, as it does while a page is being loaded."""


class Tab:
    """One page in the browser, driven by the DevTools protocol."""

    def __init__(self, socket: Connection) -> None:
        self._socket = socket
        self._ids = itertools.count(1)
        self._session: str | None = None
        self.asked: list[str] = []
        """Every address that the page asked for."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = session["sessionId"]
        self.call("Network.enable")
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=1360,
            height=800,
            deviceScaleFactor=1,
            mobile=False,
        )

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Ask the browser, and wait for its answer.

        Raises:
            NotNow: With the browser's reason.
        """
        number = next(self._ids)
        question = {"id": number, "method": method, "params": parameters}
        if self._session:
            question["sessionId"] = self._session
        self._socket.send(json.dumps(question))
        while True:
            said = json.loads(self._socket.recv(timeout=60))
            if said.get("method") == "Network.requestWillBeSent":
                self.asked.append(said["params"]["request"]["url"])
            if said.get("method") == "Network.webSocketCreated":
                self.asked.append(said["params"]["url"])
            if said.get("id") == number and "error" in said:
                raise NotNow(f"{method}: {said['error']['message']}")
            if said.get("id") == number:
                result: dict[str, Any] = said["result"]
                return result

    def screenshot(self) -> np.ndarray:
        """What is seen now, (800, 1360, 3), red, green, blue."""
        png = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR_RGB)
        assert picture is not None
        return np.asarray(picture)

    def text(self) -> str:
        """Every word on the page."""
        answer = self.call("Runtime.evaluate", expression="document.body?.innerText ?? ''")
        return str(answer["result"]["value"])


def waited(tab: Tab, until: Callable[[np.ndarray, str], bool], seconds: float = 60.0) -> np.ndarray:
    """The first screenshot that fits together with the page's text, or the last one in time."""
    patience_s = time.monotonic() + seconds
    while True:
        with suppress(NotNow):
            picture = tab.screenshot()
            if until(picture, tab.text()) or time.monotonic() > patience_s:
                return picture
        time.sleep(0.3)


def unmoving(tab: Tab, seconds: float = 30.0) -> np.ndarray:
    """The first screenshot that is as the one before, or the last one in time."""
    before = [tab.screenshot()]

    def is_as_before(seen: np.ndarray, _: str) -> bool:
        before.append(seen)
        return np.array_equal(before.pop(0), seen)

    return waited(tab, is_as_before, seconds)


@contextmanager
def open_tab(chromium: str, drawn_by: tuple[str, ...] = WEBGL) -> Iterator[Tab]:
    """A fresh browser with one empty page; gone afterwards."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [chromium, *FLAGS, *drawn_by, f"--user-data-dir={profile}", "about:blank"]
        log = Path(profile) / "log.txt"  # a pipe that nobody empties would hold it up
        with log.open("w") as said, subprocess.Popen(command, stderr=said) as browser:
            try:
                with connect(devtools(browser, log), max_size=None) as socket:
                    yield Tab(socket)
            finally:
                browser.terminate()
                try:
                    browser.wait(END_S)
                except subprocess.TimeoutExpired:
                    browser.kill()


def devtools(browser: "subprocess.Popen[bytes]", log: Path) -> str:
    """Where the browser listens, once it says so."""
    until_s = time.monotonic() + START_S
    while not (found := LISTENS.search(log.read_text())):
        assert browser.poll() is None, log.read_text()
        assert time.monotonic() < until_s, log.read_text()
        time.sleep(0.02)
    return found[1]


def saved(picture: np.ndarray, path: Path) -> Path:
    """The screenshot as a file, to be looked at when a test fails."""
    cv2.imwrite(str(path), cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    return path


def own_address() -> str:
    """Of this machine, by which others reach it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as door:
        try:
            door.connect(("192.0.2.1", 9))  # nothing is sent; RFC 5737
        except OSError:
            pytest.skip("this machine has no address but its own")
        host: str = door.getsockname()[0]
    if is_loopback(host):
        pytest.skip("this machine has no address but its own")
    return host
