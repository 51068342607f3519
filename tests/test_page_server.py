"""The page's server over real sockets: whom it lets in, and that it waits for nobody."""

import json
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Iterator

import pytest

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

import psutil
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from animator.page.door import PageError
from animator.page.page_server import MOST_ASKED, WAITING, PageServer


def free_port() -> int:
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        return int(trial.getsockname()[1])


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


def test_what_a_browser_says_is_bounded(server: PageServer) -> None:
    with connect(socket_of(server)) as browser:
        browser.recv(timeout=10)
        for _ in range(10 * MOST_ASKED):
            browser.send("{}")
        until_s = time.monotonic() + 10
        while server.asked.qsize() < MOST_ASKED and time.monotonic() < until_s:
            time.sleep(0.01)
    assert server.asked.qsize() == MOST_ASKED
