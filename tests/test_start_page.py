"""The start page's server: whom it lets in, what it says and hears."""

import json
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import Any

import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from animator.page.door import Entrance
from animator.page.page_server import File
from animator.page.wish_page import Told, encoded
from animator.start.sections import Got, Hello, Jobs
from animator.start.start_page import StartPage
from animator.start.wishes import (
    CHUNK_BYTES,
    CHUNK_HEAD,
    MOST_TEXT_BYTES,
    Again,
    Begin,
    Board,
    Cancel,
    Chunk,
    Compare,
    Delete,
    Demo,
    Drop,
    Export,
    Live,
    Look,
    Open,
    Raise,
    Record,
    Report,
    Take,
    Watch,
    Watched,
    Wish,
    WishError,
    Work,
    heard,
)

HELLO = Hello("runs", ("bvh",), 8, 1000)
ENTRANCE = Entrance(token="a-long-word")


@pytest.fixture
def page() -> Iterator[StartPage]:
    one = StartPage(HELLO, {"/run/a/b": File("image/jpeg", b"x")}.get, free_port(), ENTRANCE)
    yield one
    one.close()


def socket_of(page: StartPage, query: str = "?token=a-long-word") -> str:
    return f"{page.address.replace('http', 'ws')}/live{query}"


def next_of(page: StartPage) -> Any:
    until_s = time.monotonic() + 10
    while time.monotonic() < until_s:
        if (wish := page.next_wish()) is not None:
            return wish
        time.sleep(0.01)
    return None


@pytest.mark.parametrize("path", ["/", "/start.js", "/run/a/b", "/?token=another"])
def test_nothing_is_shown_without_the_token(page: StartPage, path: str) -> None:
    """Other users of this machine reach its loopback interface too."""
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(page.address + path)
    with pytest.raises(InvalidStatus, match="403"), connect(socket_of(page, "")):
        pass


def test_no_foreign_page_may_ask_even_with_it(page: StartPage) -> None:
    with (
        pytest.raises(InvalidStatus, match="403"),
        connect(socket_of(page), origin=Origin("http://evil.example")),
    ):
        pass


@pytest.mark.parametrize(
    ("path", "kind", "holds"),
    [
        ("/start.js", "text/javascript", b"WebSocket"),
        ("/page.css", "text/css", b":root"),
        ("/run/a/b", "image/jpeg", b"x"),
    ],
)
def test_its_parts_and_the_runs_files_are_served(
    page: StartPage, path: str, kind: str, holds: bytes
) -> None:
    with urllib.request.urlopen(f"{page.address}{path}?token=a-long-word") as answer:
        assert answer.headers["Content-Type"].startswith(kind)
        assert "default-src 'none'" in answer.headers["Content-Security-Policy"]
        assert holds in answer.read()


def test_who_comes_gets_the_newest_of_each_section_and_then_what_changes(page: StartPage) -> None:
    page.show(Jobs([]))
    with connect(socket_of(page)) as browser:
        assert json.loads(browser.recv(timeout=10))["kind"] == "hello"
        assert json.loads(browser.recv(timeout=10)) == {"kind": "jobs", "jobs": []}
        page.show(Jobs([]))
        page.tell(Got(7, 100))
        got = {"kind": "got", "file": 7, "bytes": 100}
        assert json.loads(browser.recv(timeout=10)) == got, "what is as before is not said again"
        page.tell(Told("done", well=True))
        assert json.loads(browser.recv(timeout=10))["text"] == "done"


def test_wishes_and_pieces_of_files_are_heard(page: StartPage) -> None:
    content = b"y" * CHUNK_BYTES
    with connect(socket_of(page)) as browser:
        browser.send('{"type": "cancel", "job": 3}')
        assert next_of(page) == Cancel(3)
        browser.send(CHUNK_HEAD.pack(0, 9, 1 << 33) + content)
        piece = next_of(page)
        assert isinstance(piece, Chunk)
        assert (piece.file, piece.start, bytes(piece.content)) == (9, 1 << 33, content)


WISHES = (
    *(Begin(1, "a.avi", 9), Drop(None), Raise(1), Work("single"), Board("a4"), Demo(), Cancel(1)),
    *(Open("a", "replay"), Export("a", "bvh"), Report("a"), Compare("a", "b"), Delete("run", "a")),
    *(Again(1), Watch(("video0",)), Watched(30.0), Look(on=True), Live(("video0",))),
    *(Record(("video0", "video2"), 9.5, "walk"), Take("walk")),
)


@pytest.mark.parametrize("wish", WISHES, ids=lambda wish: type(wish).__name__)
def test_every_wish_is_read_back(wish: Wish) -> None:
    assert heard(encoded(wish)) == wish


@pytest.mark.parametrize(
    "said",
    [
        *(b"", b"{", b"[]", b"\xff", b"\0short", b'{"type": "format"}', b'{"type": "work"}'),
        *(b'{"type": "cancel", "job": "1"}', b'{"type": "cancel", "job": 1, "more": 1}'),
        b'{"type": "begin", "file": 1, "name": "a", "bytes": 1' + b"0" * 400 + b"}",
        *(b'{"type": "export", "run": "a", "to": 3}', b"[" * 5000),
        b'{"type": "export", "run": "' + b"x" * MOST_TEXT_BYTES + b'", "to": "bvh"}',
    ],
)
def test_what_is_no_wish_is_refused(said: bytes) -> None:
    with pytest.raises(WishError):
        heard(said)


def test_a_name_that_is_no_unicode_is_sent_escaped() -> None:
    told = json.loads(encoded(Told("caf\udce9.avi", well=True)))
    assert told == {"kind": "told", "text": "caf\udce9.avi", "well": True}
