"""The start page's browser: opened by a file that no other user may read, not by the token."""

import re
import stat
import threading
import webbrowser
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import open_tab
from rich.console import Console
from test_live import CHROMIUM, SIZES, SOFT, Looking
from waiting import until

from tritrack.starting import start as starting
from tritrack.starting.start_desk import Given


def test_a_browser_gets_the_token_by_a_file_of_its_users_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every user of the machine may read a browser's arguments."""
    opened: list[str] = []
    over = threading.Event()
    monkeypatch.setattr(webbrowser, "open", opened.append)
    monkeypatch.setattr(starting, "has_screen", lambda: True)
    monkeypatch.setattr(starting, "process", lambda *_: Until(over))
    runs, port = tmp_path / "the runs", free_port()
    page = threading.Thread(
        target=starting.start, args=(Given(runs), port, True, Console(quiet=True))
    )
    page.start()
    assert until(lambda: opened)
    letter = Path(url2pathname(urlsplit(opened[0]).path))
    assert stat.S_IMODE(letter.stat().st_mode) == 0o600
    token = re.search(r"token=([\w-]+)", letter.read_text())
    assert token is not None
    assert token[1] not in opened[0]
    if CHROMIUM is not None:
        with open_tab(CHROMIUM, SOFT) as tab:
            looking = Looking(tab, opened[0], SIZES["desk"])
            assert looking.until("document.body?.dataset.heard")
            assert looking.ask("location.href") == f"http://127.0.0.1:{port}/"
    over.set()
    page.join()
    assert not letter.exists()


class Until:
    """In place of the process's own signals, which only its main thread hears."""

    def __init__(self, over: threading.Event) -> None:
        self._over = over

    def __enter__(self) -> threading.Event:
        return self._over

    def __exit__(self, *_: object) -> None:
        """Nothing to undo."""
