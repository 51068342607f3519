"""The retouching page's door: its own port alone, and nobody from elsewhere."""

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")

import rich
import viser

from animator.page.door import PageError
from animator.retouching import viser_door
from animator.retouching.viser_door import POLICY_VIOLATION, close_server, open_server


class FakeServer:
    """A server that says that it listens, and where."""

    def __init__(self, port: int, **_: Any) -> None:
        self.port, self.stopped, self.heard = port, False, list[Any]()
        self.quiet = rich.get_console().quiet
        self._websock_server = SimpleNamespace(
            on_client_connect=self.heard.append, _live_connections={}
        )

    def get_port(self) -> int:
        return self.port

    def stop(self) -> None:
        self.stopped = True


@pytest.fixture(autouse=True)
def nothing_opens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viser_door, "refuse_port", lambda _: None)
    monkeypatch.setattr(viser, "ViserServer", FakeServer)


def test_a_port_that_cannot_be_had_is_refused_before_anything_opens(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(port: int) -> None:
        raise PageError(f"not {port}")

    monkeypatch.setattr(viser_door, "refuse_port", refuse)
    with pytest.raises(PageError, match="not 8081"):
        open_server(8081)


def test_a_server_that_took_another_port_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    other = FakeServer(8090)
    monkeypatch.setattr(viser, "ViserServer", lambda **_: other)
    with pytest.raises(PageError, match="port 8081: another program was faster"):
        open_server(8081)
    assert other.stopped


def test_the_library_says_nothing_while_it_opens_and_speaks_again() -> None:
    console = rich.get_console()
    before = console.quiet
    server: Any = open_server(8081)
    assert server.quiet
    assert console.quiet == before
    assert not server.stopped
    close_server(server)
    assert server.stopped


@pytest.mark.parametrize(
    ("headers", "enters"),
    [
        ({"Host": "127.0.0.1:8081", "Origin": "http://127.0.0.1:8081"}, True),
        ({"Host": "localhost:8081"}, True),
        ({"Host": "evil.example:8081", "Origin": "http://evil.example:8081"}, False),
        ({"Host": "127.0.0.1:8081", "Origin": "http://evil.example"}, False),
    ],
    ids=["its own page", "no page", "another name for this machine", "another page"],
)
def test_who_comes_from_elsewhere_is_closed_on(headers: dict[str, str], enters: bool) -> None:
    server: Any = open_server(8081)
    closed: list[int] = []

    async def close(code: int, _why: str) -> None:
        closed.append(code)

    connection = SimpleNamespace(request=SimpleNamespace(headers=headers), close=close)
    server._websock_server._live_connections[7] = connection
    (guard,) = server.heard
    asyncio.run(guard(SimpleNamespace(client_id=7)))
    assert closed == ([] if enters else [POLICY_VIOLATION])
