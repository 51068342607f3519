"""The page's server over real sockets: whom it lets in, and that it waits for nobody."""

import http.client
import json
import logging
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack
from typing import NamedTuple

import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

import psutil
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from animator.page import page_server
from animator.page.door import Entrance, PageError, cookie_of
from animator.page.page_server import MOST_ASKED, MOST_BROWSERS, WAITING, PageServer

TOKEN = "a-long-word-that-nobody-guesses"


@pytest.fixture
def server() -> Iterator[PageServer]:
    one = PageServer(free_port(), lambda: [b'{"kind":"hello"}'])
    yield one
    one.close()


def socket_of(server: PageServer) -> str:
    return server.address.replace("http", "ws") + "/live"


def test_the_page_and_its_parts_are_served_and_may_ask_nobody_else(server: PageServer) -> None:
    with urllib.request.urlopen(server.address) as answer:
        assert b"<html" in answer.read().lower()
        policy = answer.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "http" not in policy
    with urllib.request.urlopen(f"{server.address}/page.js") as answer:
        assert answer.headers["Content-Type"].startswith("text/javascript")


@pytest.mark.parametrize("path", ["/nothing", "/../door.py", "/site/page.js", "/%2e%2e/live.py"])
def test_nothing_else_is_served(server: PageServer, path: str) -> None:
    with pytest.raises(urllib.error.HTTPError, match="404"):
        urllib.request.urlopen(server.address + path)


def test_the_page_listens_on_the_loopback_interface_alone(server: PageServer) -> None:
    port = int(server.address.rsplit(":", 1)[1])
    listening = [
        connection.laddr.ip
        for connection in psutil.Process().net_connections()
        if connection.status == psutil.CONN_LISTEN and connection.laddr.port == port
    ]
    assert listening == ["127.0.0.1"]


def test_a_busy_port_is_refused_with_its_number_and_the_cure(server: PageServer) -> None:
    port = int(server.address.rsplit(":", 1)[1])
    with pytest.raises(PageError, match=rf"port {port}: .*in use; .*set page\.port"):
        PageServer(port, list)


def test_a_closed_page_frees_its_port() -> None:
    port = free_port()
    for _ in range(2):
        PageServer(port, list).close()


@pytest.mark.parametrize(
    "said",
    [b"", b"GET", b"\x16\x03\x01 no HTTP\r\n\r\n", b"POST /live HTTP/1.1\r\nHost: a\r\n\r\n"],
    ids=["nothing", "half a word", "another protocol", "another method"],
)
def test_who_connects_and_asks_for_nothing_leaves_no_traceback(
    server: PageServer, caplog: pytest.LogCaptureFixture, said: bytes
) -> None:
    """The supervisor does, to see whether the page answers; so does whoever scans ports."""
    with caplog.at_level(logging.INFO):
        with socket.create_connection(("127.0.0.1", int(server.address.rsplit(":", 1)[1]))) as peer:
            peer.sendall(said)
        time.sleep(0.1)
        with urllib.request.urlopen(server.address) as answer:
            assert answer.status == 200
    assert [record.getMessage() for record in caplog.records if record.exc_info] == []


def test_a_fault_of_the_pages_own_is_logged_with_its_traceback(
    caplog: pytest.LogCaptureFixture,
) -> None:
    def broken() -> list[bytes]:
        raise ZeroDivisionError

    one = PageServer(free_port(), broken)
    try:
        with connect(socket_of(one)) as browser, pytest.raises(ConnectionClosedError):
            browser.recv(timeout=5.0)
    finally:
        one.close()
    assert [record.exc_info[0] for record in caplog.records if record.exc_info] == [
        ZeroDivisionError
    ]


def test_a_foreign_web_page_is_shown_nothing(server: PageServer) -> None:
    """It would else read the silhouettes of whoever stands before the cameras."""
    with connect(socket_of(server), origin=Origin(server.address)) as own:
        assert json.loads(own.recv(timeout=10)) == {"kind": "hello"}
    with (
        pytest.raises(InvalidStatus, match="403"),
        connect(socket_of(server), origin=Origin("https://evil.example")),
    ):
        pass
    question = urllib.request.Request(server.address, headers={"Host": "evil.example"})
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(question)


def test_a_browser_hears_what_is_told_after_the_greeting_in_order(server: PageServer) -> None:
    with connect(socket_of(server)) as browser:
        browser.recv(timeout=10)
        assert server.watched
        for n in range(5):
            server.tell(str(n).encode())
        assert [browser.recv(timeout=10) for _ in range(5)] == list("01234")
    until_s = time.monotonic() + 10
    while server.watched and time.monotonic() < until_s:
        time.sleep(0.01)
    assert not server.watched
    assert server.came == 1


def test_a_browser_that_does_not_listen_holds_nobody_up(server: PageServer) -> None:
    """What waits for it is bounded, the oldest gives way, and the newest comes through."""
    with connect(socket_of(server), max_queue=1) as browser:
        browser.recv(timeout=10)
        began_s = time.monotonic()
        for n in range(20 * WAITING):
            server.tell(b"%d " % n + b"x" * 20_000)
        assert time.monotonic() - began_s < 5.0
        heard = [int(browser.recv(timeout=20).split()[0])]
        while heard[-1] != 20 * WAITING - 1:
            heard.append(int(browser.recv(timeout=20).split()[0]))
    assert len(heard) < 20 * WAITING
    assert heard == sorted(heard)


def test_what_a_browser_says_is_bounded(
    server: PageServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("animator.page.page_server.PATIENCE_S", 0.2)
    with connect(socket_of(server)) as browser:
        browser.recv(timeout=10)
        for _ in range(10 * MOST_ASKED):
            browser.send("{}")
        until_s = time.monotonic() + 10
        while server.asked.qsize() < MOST_ASKED and time.monotonic() < until_s:
            time.sleep(0.01)
    assert server.asked.qsize() == MOST_ASKED


def test_what_finds_no_room_at_once_is_heard_later_in_order_and_what_never_does_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    server = PageServer(free_port(), lambda: [b"hello"], busy=b"busy")
    count = 3 * MOST_ASKED
    with connect(socket_of(server)) as browser:
        browser.recv(timeout=10)
        for number in range(count):
            browser.send(str(number))
        time.sleep(0.3)
        assert [int(server.asked.get(timeout=5)) for _ in range(count)] == [*range(count)]
        monkeypatch.setattr("animator.page.page_server.PATIENCE_S", 0.1)
        for _ in range(MOST_ASKED + 1):
            browser.send("more")
        assert browser.recv(timeout=10) == "busy"
    server.close()


class Open(NamedTuple):
    """A page that other machines reach, called by an address of this one."""

    server: PageServer
    port: int

    @property
    def cookie(self) -> str:
        return f"{cookie_of(self.port)}={TOKEN}"

    def status(self, path: str, **headers: str) -> int:
        return self.answer(path, **headers).status

    def answer(self, path: str, **headers: str) -> http.client.HTTPResponse:
        """What the page answers, whatever the names in the question."""
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        line.request("GET", path, headers={"Host": f"rig.local:{self.port}", **headers})
        return line.getresponse()


@pytest.fixture
def everywhere() -> Iterator[Open]:
    port = free_port()
    entrance = Entrance("0.0.0.0", token=TOKEN)
    server = PageServer(port, lambda: [b'{"kind":"hello"}'], entrance)
    yield Open(server, port)
    server.close()


@pytest.mark.parametrize("path", ["/", "/page.js", "/live", "/nothing"])
@pytest.mark.parametrize(
    "brought", ["", "TOKEN", TOKEN[:-1], f"{TOKEN}x", TOKEN.upper(), "%FF", "\xff"]
)
def test_beyond_this_machine_nothing_is_shown_without_the_token(
    everywhere: Open, path: str, brought: str
) -> None:
    cookie = {"Cookie": f"{cookie_of(everywhere.port)}={brought}; other=1"}
    assert everywhere.status(path) == 403
    assert everywhere.status(path, **cookie) == 403
    if brought.isascii():
        assert everywhere.status(f"{path}?token={brought}") == 403
    refused = everywhere.answer(path)
    assert b"?token=" in refused.read()
    assert refused.headers["Set-Cookie"] is None


def test_the_printed_address_lets_in_and_leaves_no_token_in_the_address_bar(
    everywhere: Open,
) -> None:
    came = everywhere.answer(f"/?token={TOKEN}")
    assert (came.status, came.headers["Location"]) == (303, "/")
    kept, *rules = came.headers["Set-Cookie"].split("; ")
    assert kept == everywhere.cookie
    assert {"HttpOnly", "SameSite=Lax"} <= set(rules)
    for path in ("/", "/page.js"):
        assert everywhere.status(path, Cookie=f"other=1; {kept}") == 200


def test_a_socket_is_opened_to_who_has_the_token_and_comes_from_the_page_itself(
    everywhere: Open,
) -> None:
    where = f"ws://127.0.0.1:{everywhere.port}/live"
    own, foreign = Origin(f"http://127.0.0.1:{everywhere.port}"), Origin("https://evil.example")
    cookie = {"Cookie": everywhere.cookie}
    with connect(where, origin=own, additional_headers=cookie) as browser:
        assert json.loads(browser.recv(timeout=10)) == {"kind": "hello"}
    with connect(f"{where}?token={TOKEN}") as program:
        assert json.loads(program.recv(timeout=10)) == {"kind": "hello"}
    for origin, headers in ((own, {}), (foreign, cookie)):
        with (
            pytest.raises(InvalidStatus, match="403"),
            connect(where, origin=origin, additional_headers=headers),
        ):
            pass


def test_fifty_browsers_are_served_and_the_next_is_told_why_not(server: PageServer) -> None:
    """Issue 15: 50 clients; who leaves makes room for another."""
    with ExitStack() as doors:
        browsers = [doors.enter_context(connect(socket_of(server))) for _ in range(50)]
        for browser in browsers:
            browser.recv(timeout=10)
        with pytest.raises(InvalidStatus) as refused, connect(socket_of(server)):
            pass
        assert refused.value.response.status_code == 503
        assert b"50 browsers look at this page already: close one" in refused.value.response.body
        server.tell(b"news")
        assert [browser.recv(timeout=10) for browser in browsers] == ["news"] * MOST_BROWSERS
        browsers.pop().close()
        until_s = time.monotonic() + 10
        while len(server._browsers) == MOST_BROWSERS and time.monotonic() < until_s:
            time.sleep(0.01)
        with connect(socket_of(server)) as late:
            assert json.loads(late.recv(timeout=10)) == {"kind": "hello"}


def test_a_browser_that_does_not_listen_costs_the_others_no_message(server: PageServer) -> None:
    """Each message reaches who listens before the next is said; of the deaf one's the oldest go."""
    last = 8 * WAITING
    with (
        connect(socket_of(server), max_queue=1) as deaf,
        connect(socket_of(server)) as quick,
        connect(socket_of(server)) as other,
    ):
        for browser in (deaf, quick, other):
            browser.recv(timeout=10)
        for n in range(last + 1):
            server.tell(b"%d " % n + b"x" * 20_000)
            for browser in (quick, other):
                assert int(browser.recv(timeout=10).split()[0]) == n
        assert max(waiting.qsize() for waiting in server._browsers.values()) == WAITING
        heard = [int(deaf.recv(timeout=10).split()[0])]
        while heard[-1] != last:
            heard.append(int(deaf.recv(timeout=10).split()[0]))
    assert len(heard) < last
    assert heard == sorted(heard)


@pytest.mark.parametrize("error", [UnicodeError("label too long"), OSError(98, "In use")])
def test_a_server_that_cannot_open_says_why_whatever_it_is(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    """Whoever opens a page does not wait for its thread for ever."""

    async def refuse(*_: object, **_more: object) -> None:
        raise error

    monkeypatch.setattr(page_server, "serve", refuse)
    with pytest.raises(PageError, match=r"label too long|in use"):
        PageServer(free_port(), list)


def test_a_server_that_never_listens_is_not_waited_for_for_ever(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(page_server, "OPENS_S", 0.05)
    monkeypatch.setattr(PageServer, "_run", lambda *_: None)
    with pytest.raises(PageError, match="it does not answer"):
        PageServer(free_port(), list)


def test_text_says_how_it_is_written_and_pictures_do_not(server: PageServer) -> None:
    with urllib.request.urlopen(f"{server.address}/page.js") as answer:
        assert answer.headers["Content-Type"] == "text/javascript; charset=utf-8"
    headers = page_server.headers_of("image/png", b"1234")
    assert headers["Content-Type"] == "image/png"
    assert headers["Content-Length"] == "4"


def test_what_a_browser_says_is_heard_as_bytes_whether_it_was_text_or_not(
    server: PageServer,
) -> None:
    with connect(socket_of(server)) as browser:
        browser.recv(timeout=5)
        browser.send("as text")
        browser.send(b"as bytes")
        assert [server.asked.get(timeout=5) for _ in range(2)] == [b"as text", b"as bytes"]


def test_no_port_is_taken_where_none_is_named() -> None:
    with pytest.raises(PageError, match=r"page\.port is 0"):
        PageServer(0, lambda: [])


def test_a_name_that_is_none_is_named_with_its_port() -> None:
    port = free_port()
    with pytest.raises(PageError, match=rf"port {port} of no\.such\.host\.invalid: "):
        PageServer(port, lambda: [], Entrance("no.such.host.invalid", token=TOKEN))
