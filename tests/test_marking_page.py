"""The marking page over real sockets: its files, its pictures, whom it lets in, what it hears."""

import http.client
import json
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import open_tab, own_address
from foreign_page import foreign_page
from test_live import CHROMIUM, Looking
from test_page_server import TOKEN
from test_sheet import POLES
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from animator.marking.marking_page import LIVE, MarkingPage, still_address
from animator.marking.sheet import (
    MOST_SAID_BYTES,
    Marked,
    Save,
    Seen,
    Sheet,
    SheetError,
    Shown,
    Solved,
)
from animator.page.door import Entrance, cookie_of, invitation_of
from animator.page.wish_page import Told

SHOWN = Shown(Sheet((), {}), "", 0, Solved((Seen(False, "click"),), ()), "nothing kept", True)


def picture(camera: int, place: int) -> bytes | None:
    """Two stills of camera 1, and the newest picture of camera 2."""
    known = {(1, 0): b"first", (1, 1): b"second", (2, LIVE): b"newest"}
    return known.get((camera, place))


def grey(camera: int, place: int) -> bytes | None:
    """A picture that a browser can show."""
    return cv2.imencode(".jpg", np.full((48, 64, 3), 90, np.uint8))[1].tobytes()


@pytest.fixture
def page() -> Iterator[MarkingPage]:
    one = MarkingPage(POLES, picture, free_port())
    yield one
    one.close()


def socket_of(page: MarkingPage) -> str:
    return page.address.replace("http", "ws") + "/live"


def wish_of(page: MarkingPage) -> Any:
    until_s = time.monotonic() + 10
    while time.monotonic() < until_s:
        wish = page.next_wish()
        if wish is not None:
            return wish
        time.sleep(0.01)
    return None


@pytest.mark.parametrize(
    ("path", "kind", "holds"),
    [
        ("/", "text/html", b"marking.js"),
        ("/marking.js", "text/javascript", b"WebSocket"),
        ("/marking.css", "text/css", b"#loupe"),
        ("/page.css", "text/css", b":root"),
        (still_address(1, 1), "image/jpeg", b"second"),
        (f"{still_address(2, LIVE)}?1234", "image/jpeg", b"newest"),
    ],
)
def test_the_page_its_parts_and_its_pictures_are_served(
    page: MarkingPage, path: str, kind: str, holds: bytes
) -> None:
    with urllib.request.urlopen(page.address + path) as answer:
        assert answer.headers["Content-Type"].startswith(kind)
        assert "default-src 'none'" in answer.headers["Content-Security-Policy"]
        assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert holds in answer.read()


@pytest.mark.parametrize(
    "path",
    [
        *("/still/1/2.jpg", "/still/3/0.jpg", "/still/1/-1.jpg", "/still/1/live.jpg", "/still/1/"),
        *("/still/1/../0.jpg", "/still/1/9999999.jpg", "/still/1/0.png", "/still/1/%D9%A1.jpg"),
        *("/sheet.py", "/../sheet.py", "/marking/sheet.py"),
    ],
)
def test_nothing_else_is_served(page: MarkingPage, path: str) -> None:
    with pytest.raises(urllib.error.HTTPError, match="404"):
        urllib.request.urlopen(page.address + path)


def test_who_comes_is_told_what_to_click_and_the_newest_sheet(page: MarkingPage) -> None:
    page.show(SHOWN)
    newer = msgspec.structs.replace(SHOWN, kept="points kept in poles.toml")
    page.show(newer)
    with connect(socket_of(page)) as browser:
        hello = json.loads(browser.recv(timeout=10))
        assert (hello["kind"], hello["method"], hello["size"]) == ("hello", "poles", [640, 480])
        assert hello["run"] > 1
        assert json.loads(browser.recv(timeout=10))["kept"] == "points kept in poles.toml"
        page.tell(Told("written to calibration.json", well=True))
        told = {"kind": "told", "text": "written to calibration.json", "well": True}
        assert json.loads(browser.recv(timeout=10)) == told


def test_what_a_browser_says_is_heard_and_a_bad_word_is_refused(page: MarkingPage) -> None:
    said = {"type": "marked", "sheet": {"marks": [], "numbers": {}}, "by": "me", "count": 1}
    with connect(socket_of(page)) as browser:
        browser.recv(timeout=10)
        assert page.next_wish() is None
        browser.send(json.dumps(said))
        assert wish_of(page) == Marked(Sheet((), {}), "me", 1)
        browser.send('{"type": "save"}')
        assert wish_of(page) == Save()
        browser.send('{"type": "format"}')
        with pytest.raises(SheetError, match="load it anew"):
            wish_of(page)


def test_who_says_more_than_a_sheet_is_left(page: MarkingPage) -> None:
    with connect(socket_of(page)) as browser:
        browser.recv(timeout=10)
        browser.send("x" * (MOST_SAID_BYTES + 1))
        with pytest.raises(ConnectionClosed) as closed:
            browser.recv(timeout=10)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1009
    assert page.next_wish() is None


@pytest.mark.parametrize("path", ["/", "/still/1/0.jpg", "/marking.js"])
def test_a_foreign_name_is_shown_neither_page_nor_picture(page: MarkingPage, path: str) -> None:
    question = urllib.request.Request(page.address + path, headers={"Host": "evil.example"})
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(question)


def test_a_foreign_page_cannot_click(page: MarkingPage) -> None:
    with (
        pytest.raises(InvalidStatus, match="403"),
        connect(socket_of(page), origin=Origin("https://evil.example")),
    ):
        pass


def test_beyond_this_machine_no_picture_is_shown_without_the_token() -> None:
    port = free_port()
    page = MarkingPage(POLES, picture, port, Entrance("0.0.0.0", token=TOKEN))
    try:
        for cookie, status in (("", 403), (f"{cookie_of(port)}={TOKEN}", 200)):
            line = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
            line.request("GET", "/still/1/0.jpg", headers={"Cookie": cookie})
            assert line.getresponse().status == status
    finally:
        page.close()


def title_of(looking: Looking, address: str) -> dict[str, str]:
    """What a foreign page tried, and what came of it."""
    looking.tab.call("Page.navigate", url=address)
    title = looking.until(
        "document.title.startsWith('{') && document.title.split(':').length > 3 && document.title"
    )
    return dict(json.loads(title or "{}"))


REFUSED = {"image": "refused", "socket": "refused", "page": "refused"}
needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")


@pytest.mark.slow
@needs_browser
def test_a_foreign_page_in_a_browser_neither_sees_nor_hears_nor_reads() -> None:
    """Not even shown in a frame of its own, as pictures of other sites otherwise are."""
    page = MarkingPage(POLES, grey, free_port())
    page.show(SHOWN)
    try:
        with (
            foreign_page("127.0.0.1", page.address, "still/1/0.jpg") as foreign,
            open_tab(str(CHROMIUM), ("--disable-gpu",)) as tab,
        ):
            looking = Looking(tab, page.address, (1400, 900))
            assert looking.until("document.title.includes('poles')")
            own = "(async () => { const i = new Image(); i.src = '/still/1/0.jpg';"
            own += "await i.decode(); document.title = 'own'; })()"
            looking.ask(own)
            assert looking.until("document.title === 'own'"), "the page itself sees it"
            assert title_of(looking, foreign) == REFUSED
    finally:
        page.close()


@pytest.mark.slow
@needs_browser
def test_the_printed_address_lets_a_browser_in_from_beyond_loopback() -> None:
    """Its token then leaves the address bar; no script reads it, no other port's page uses it."""
    host, port = own_address(), free_port()
    entrance = Entrance(host, token=TOKEN)
    page = MarkingPage(POLES, grey, port, entrance)
    page.show(SHOWN)
    try:
        with (
            foreign_page(host, page.address, "still/1/0.jpg") as foreign,
            open_tab(str(CHROMIUM), ("--disable-gpu",)) as tab,
        ):
            looking = Looking(tab, page.address, (390, 844))
            assert looking.until("document.body?.innerText.includes('?token=')")
            assert not looking.ask("document.querySelectorAll('script').length")
            tab.call("Page.navigate", url=invitation_of(entrance, port))
            assert looking.until("document.title.includes('poles')")
            assert looking.ask("location.href") == f"http://{host}:{port}/"
            assert looking.ask("document.cookie") == ""
            assert looking.until("document.querySelector('#words').innerText === 'ready'")
            assert title_of(looking, foreign) == REFUSED
            tab.call("Page.navigate", url=f"{page.address}/")
            assert looking.until("document.querySelector('#words')?.innerText === 'ready'")
            page.close()
            page = MarkingPage(POLES, grey, port, Entrance(host, token="another-run"))
            assert looking.until("document.querySelector('#words').innerText.includes('printed')")
        with open_tab(str(CHROMIUM), ("--disable-gpu",)) as tab:
            looking = Looking(tab, page.address, (390, 844))
            assert looking.until("document.body?.innerText.includes('?token=')")
    finally:
        page.close()
