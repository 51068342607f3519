"""The page over a real server, and in a real browser where there is one."""

import shutil
import socket
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")

import psutil
import viser
from browser import open_tab, saved, waited
from show_page import RIG, snapshot_at
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from animator.page.door import PageError, is_own
from animator.page.live import LivePage
from animator.scene import LEFT, RIGHT, Snapshot

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


def free_port() -> int:
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        return int(trial.getsockname()[1])


@pytest.fixture
def page() -> Iterator[LivePage]:
    live = LivePage(RIG, free_port())
    yield live
    live.close()


def test_the_page_answers_on_this_machine(page: LivePage) -> None:
    with urllib.request.urlopen(page.address) as answer:
        assert answer.status == 200
        assert b"<html" in answer.read().lower()


def test_the_page_listens_on_the_loopback_interface_alone(page: LivePage) -> None:
    port = int(page.address.rsplit(":", 1)[1])
    listening = [
        connection.laddr.ip
        for connection in psutil.Process().net_connections()
        if connection.status == psutil.CONN_LISTEN and connection.laddr.port == port
    ]
    assert listening == ["127.0.0.1"]


def test_a_busy_port_is_refused_with_its_number_and_the_cure(page: LivePage) -> None:
    """Viser alone would take the next port, and nobody would find the page."""
    port = int(page.address.rsplit(":", 1)[1])
    with pytest.raises(PageError, match=rf"port {port}: .*in use; .*set page\.port"):
        LivePage(RIG, port)


def test_port_zero_means_no_page() -> None:
    with pytest.raises(PageError, match=r"page\.port is 0"):
        LivePage(RIG, 0)


def test_a_closed_page_frees_its_port() -> None:
    port = free_port()
    LivePage(RIG, port).close()
    LivePage(RIG, port).close()


def test_opening_and_closing_says_nothing_on_the_terminal(
    capfd: pytest.CaptureFixture[str],
) -> None:
    LivePage(RIG, free_port()).close()
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize(
    ("host", "origin", "own"),
    [
        ("127.0.0.1:8080", "http://127.0.0.1:8080", True),
        ("localhost:9000", "http://localhost:9000", True),
        ("127.0.0.1:8080", "", True),
        ("127.0.0.1:8080", "https://evil.example", False),
        ("127.0.0.1:8080", "null", False),
        ("127.0.0.1:8080", "http://127.0.0.1:3000", False),
        ("evil.example:8080", "http://evil.example:8080", False),
        ("127.0.0.1.evil.example", "", False),
        ("", "", False),
    ],
)
def test_only_the_pages_own_browser_tab_may_connect(host: str, origin: str, own: bool) -> None:
    """Neither another web page nor a foreign name that points here (DNS rebinding)."""
    assert is_own(host, origin) is own


def test_a_foreign_web_page_is_shown_nothing(page: LivePage) -> None:
    """It would else read the silhouettes of whoever stands before the cameras."""
    where = page.address.replace("http", "ws")
    speaks = [Subprotocol(f"viser-v{viser.__version__}")]
    with connect(where, origin=Origin(page.address), subprotocols=speaks) as own:
        assert own.recv(timeout=10)
    with (
        connect(where, origin=Origin("https://evil.example"), subprotocols=speaks) as foreign,
        pytest.raises(ConnectionClosed) as closed,
    ):
        foreign.recv(timeout=10)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1008


def test_a_body_appears_moves_and_goes_again(page: LivePage) -> None:
    """What a browser that joins late is sent: viser's own table of the newest values."""
    limbs = page._server.scene.get_handle_by_name("/body/cylinders")
    assert not limbs.visible
    page.show(snapshot_at(0))
    assert limbs.visible
    before = limbs.batched_wxyzs.copy()
    page.show(snapshot_at(4))
    assert not np.allclose(limbs.batched_wxyzs, before)
    page.show(Snapshot())
    assert not limbs.visible


def test_a_cameras_picture_hangs_in_the_room_while_its_viewer_speaks(page: LivePage) -> None:
    frustum = page._server.scene.get_handle_by_name("/camera 2")
    before = frustum.image
    page.show(snapshot_at(0))
    assert before is None
    assert frustum.image.shape == (240, 320, 3)
    page.show(Snapshot())
    assert frustum.image is None


def test_a_run_with_one_camera_has_one_frustum() -> None:
    rig = type(RIG)(RIG.width, RIG.height, RIG.cameras[:1])
    page = LivePage(rig, free_port())
    page.show(snapshot_at(0))
    names = [f"/camera {n}" for n in (1, 2)]
    shown = [page._server.scene.get_handle_by_name(name) is not None for name in names]
    page.close()
    assert shown == [True, False]


def hue_deg(colours: np.ndarray) -> np.ndarray:
    """Hue of what is coloured, NaN of what is grey; (..., 3) red, green, blue."""
    values = np.asarray(colours, float)
    red, green, blue = np.moveaxis(values, -1, 0)
    hue = np.degrees(np.arctan2(np.sqrt(3.0) * (green - blue), 2.0 * red - green - blue))
    return np.where(np.ptp(values, axis=-1) > 45, hue, np.nan)


def share_like(picture: np.ndarray, colour: tuple[int, int, int]) -> float:
    """Share of the room's middle, where the body stands, that has about a colour's hue."""
    middle = picture[230:620, 380:640]
    return float(np.mean(np.abs(hue_deg(middle) - hue_deg(np.array(colour))) < 12.0))


def share_dark(picture: np.ndarray) -> float:
    """Share of the room that is as dark as the background of a silhouette."""
    return float(np.mean(picture[230:, :1000].max(axis=2) < 70))


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: the page is not looked at")
def test_a_browser_shows_the_body_and_asks_nobody_else(page: LivePage, tmp_path: Path) -> None:
    with open_tab(str(CHROMIUM)) as tab:
        tab.call("Page.navigate", url=page.address)
        empty = waited(tab, lambda _, text: "nobody in view" in text)
        assert share_like(empty, LEFT) + share_like(empty, RIGHT) < 0.002
        page.show(snapshot_at(4))
        body = waited(tab, lambda seen, _: share_like(seen, LEFT) > 0.01 and share_dark(seen) > 0.1)
        text = tab.text()
        asked = tab.asked
    where = saved(body, tmp_path / "page.png")
    assert share_like(body, LEFT) > 0.01, f"no left side drawn: look at {where}"
    assert share_like(body, RIGHT) > 0.01, f"no right side drawn: look at {where}"
    assert share_dark(body) > 0.1, f"no silhouettes hang in the room: look at {where}"
    assert "walk in place" in text
    assert "15.0 fps · 11 ms latency" in text
    own = (page.address, page.address.replace("http", "ws"), "data:", "blob:")
    assert [address for address in asked if not address.startswith(own)] == []
