"""The retouching page over a real server, and with a real pointer where there is a browser."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")

import viser
from browser import Tab, open_tab, saved, unmoving, waited
from test_take import ARM, WRIST, body, take
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from animator.retouching.retouch import RetouchPage
from animator.retouching.retouch_scene import GAP_M, TALL_M
from animator.take import Take
from common.body.body import LIMB_ENDS
from common.notes.notes import Held, Notes, held
from common.notes.notes_file import load_notes, save_notes

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
SIZE = (320, 240)


def filmed() -> Take:
    """An arm lifted to the camera, in doubt from the fourth row on; 100 px a metre."""
    seen = take()
    standing = body(l_shoulder_x=60.0)
    seen.joints_m[:, :, 1] -= standing[:, 1].min()
    column, row = 160 + 100 * seen.joints_m[0, :, 0], 230 - 100 * seen.joints_m[0, :, 1]
    seen.joints_px[:] = np.stack([column, row], axis=1)
    seen.depth_confidence[3:, ARM] = 0.5
    seen.orientation_confidence[8] = 0.5
    return seen


def fitted() -> Take:
    """The same fitted again: the arm is in doubt no longer."""
    seen = filmed()
    seen.depth_confidence[:] = 0.9
    return seen


@pytest.fixture
def page(tmp_path: Path) -> Iterator[RetouchPage]:
    def keep(notes: Notes) -> tuple[str, bool]:
        save_notes(tmp_path / "notes.toml", notes)
        return "kept", True

    def picture(row: int) -> np.ndarray:
        return np.full((240, 320, 3), 40 + 10 * row, np.uint8)

    def fit(_: Notes, tell: Callable[[str], object]) -> Take:
        tell("half of it")
        return fitted()

    made = RetouchPage(filmed(), SIZE, picture, Notes(), keep, fit, free_port())
    yield made
    made.close()


def said(page: RetouchPage, path: Path, frame: int) -> Held:
    """What holds at a frame, in memory and on disk alike."""
    assert load_notes(path / "notes.toml") == page.notes
    return held(page.notes, frame)


def test_a_click_on_a_limb_lets_it_lean_the_other_way(page: RetouchPage, tmp_path: Path) -> None:
    """T21: one input, which holds from its frame on."""
    page.go_to(3)
    page.flip(ARM)
    assert said(page, tmp_path, 6).depth == {"l_upper_arm": "away"}
    assert said(page, tmp_path, 100).depth == {"l_upper_arm": "away"}
    assert said(page, tmp_path, 5).depth == {}
    page.flip(ARM)
    assert said(page, tmp_path, 6).depth == {"l_upper_arm": "toward"}


def test_a_placed_joint_is_placed_in_its_frame_alone_unless_it_shall_hold(
    page: RetouchPage, tmp_path: Path
) -> None:
    """T26: hidden parts, "in a few frames"."""
    page.go_to(3)
    page.place(WRIST, (100.0, 50.0))
    assert said(page, tmp_path, 6).joints_px == {"l_wrist": (100.0, 50.0)}
    assert said(page, tmp_path, 7).joints_px == {}
    page._controls.hold.value = True
    page.place(WRIST, (101.0, 51.0))
    assert said(page, tmp_path, 7).joints_px == {}
    page.go_to(5)
    page.place(WRIST, (102.0, 52.0))
    assert said(page, tmp_path, 30).joints_px == {"l_wrist": (102.0, 52.0)}
    page.let_go()
    assert said(page, tmp_path, 30).joints_px == {}


def test_only_what_a_browser_said_is_an_input(page: RetouchPage, tmp_path: Path) -> None:
    """The page sets its own controls when another frame is shown."""
    page._controls.orientation.value = "left"
    page._controls.if_user(SimpleNamespace(client=None), page._controls.turned)
    assert page.notes == Notes()
    page._controls.if_user(SimpleNamespace(client=object()), page._controls.turned)
    assert said(page, tmp_path, 0).orientation == "left"


def test_the_next_uncertain_frame_is_shown_and_a_settled_one_is_not_asked(
    page: RetouchPage,
) -> None:
    page.look(1)
    assert page._row == 3
    assert "does the left upper arm lean" in page._controls.open.content
    page.flip(ARM)
    assert "nothing is uncertain" in page._controls.open.content
    page.look(1)
    assert page._row == 8
    page.look(1)
    assert page._row == 8
    assert "no other uncertain frame" in page._controls.kept.content


def test_the_video_fitted_again_is_what_the_page_shows_then(page: RetouchPage) -> None:
    """T22: what was said is asked no more, and what is uncertain is that of the new run."""
    page.go_to(3)
    assert "does the left upper arm lean" in page._controls.open.content
    page.face("left")
    page.fit_again()
    page._fitting.wait()
    assert page.fitted == page.notes != Notes()
    assert page._row == 3
    assert "nothing is uncertain" in page._controls.open.content
    assert "fitted again" in page._controls.kept.content


def test_notes_that_cannot_be_kept_are_told(page: RetouchPage) -> None:
    page._save = lambda _: ("no space <left>", False)
    page.flip(ARM)
    assert "no space &lt;left&gt;" in page._controls.kept.content
    assert "color:rgb" in page._controls.kept.content


def test_a_frame_without_a_pose_shows_its_picture_alone(page: RetouchPage) -> None:
    page.take.joints_m[2] = np.nan
    page.go_to(2)
    scene = page._server.scene
    assert not scene.get_handle_by_name("/body").visible
    assert scene.get_handle_by_name("/picture").image[0, 0, 0] == 60
    assert "no person is seen" in page._controls.open.content


def test_a_foreign_web_page_may_not_read_or_write_notes(page: RetouchPage) -> None:
    where = page.address.replace("http", "ws")
    speaks = [Subprotocol(f"viser-v{viser.__version__}")]
    with (
        connect(where, origin=Origin("https://evil.example"), subprotocols=speaks) as foreign,
        pytest.raises(ConnectionClosed) as closed,
    ):
        foreign.recv(timeout=10)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1008


def pointer(tab: Tab, kind: str, at: tuple[float, float]) -> None:
    tab.call(
        "Input.dispatchMouseEvent",
        type=kind,
        x=at[0],
        y=at[1],
        button="left",
        buttons=0 if kind == "mouseReleased" else 1,
        clickCount=1,
    )


def picture_corners(seen: np.ndarray, grey: int) -> tuple[np.ndarray, np.ndarray]:
    """Where the picture is on the screen: its plain grey, first and last column and row."""
    plain = (np.ptp(seen.astype(int), axis=2) < 6) & (np.abs(seen[..., 0].astype(int) - grey) < 30)
    plain[:, 1000:] = False
    rows, columns = np.flatnonzero(plain.sum(axis=1) > 100), np.flatnonzero(plain.sum(axis=0) > 100)
    return np.array([columns[0], rows[0]]), np.array([columns[-1] + 1, rows[-1] + 1])


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: the page is not looked at")
def test_a_pointer_drags_a_joint_and_a_click_turns_a_limb(
    page: RetouchPage, tmp_path: Path
) -> None:
    """The wrist is let go where the pointer is: within 3 of the video's 320 pixels."""
    with open_tab(str(CHROMIUM)) as tab:
        tab.call("Page.navigate", url=page.address)
        waited(tab, lambda picture, text: "frame 0" in text and picture[400, 300, 0] < 120)
        seen = unmoving(tab)
        where = saved(seen, tmp_path / "retouch.png")
        first, last = picture_corners(seen, 40)
        px = (last - first) / SIZE
        assert px[0] == pytest.approx(px[1], rel=0.05), f"look at {where}"
        start = first + px * filmed().joints_px[0, WRIST]
        end = first + px * (230.0, 60.0)
        pointer(tab, "mouseMoved", tuple(start))
        pointer(tab, "mousePressed", tuple(start))
        for share in (0.2, 0.5, 0.8, 1.0):
            pointer(tab, "mouseMoved", tuple(start + share * (end - start)))
        pointer(tab, "mouseReleased", tuple(end))
        waited(tab, lambda *_: page.notes != Notes(), 20.0)
        placed = held(page.notes, 0).joints_px
        assert list(placed) == ["l_wrist"], f"look at {saved(tab.screenshot(), where)}"
        assert placed["l_wrist"] == pytest.approx((230.0, 60.0), abs=3.0)
        middle = seen_from_the_side(filmed().joints_m[0], LIMB_ENDS[ARM].tolist())
        at = first + (last[1] - first[1]) / TALL_M * (middle * (1.0, -1.0) + (0.0, TALL_M))
        pointer(tab, "mouseMoved", tuple(at))
        pointer(tab, "mousePressed", tuple(at))
        pointer(tab, "mouseReleased", tuple(at))
        waited(tab, lambda *_: bool(held(page.notes, 0).depth), 20.0)
        turned = held(page.notes, 0).depth
        assert turned == {"l_upper_arm": "away"}, f"look at {saved(tab.screenshot(), where)}"
        tab.call("Runtime.evaluate", expression=PRESS_NEXT)
        asked = "does the person face forward left?"
        waited(tab, lambda _, text: "frame 16" in text and asked in text, 30.0)
        assert asked in tab.text()
        assert "upper arm lean" not in tab.text(), "what was said is asked again"


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: the page is not looked at")
@pytest.mark.parametrize("sizes", [[(390, 844)], [(844, 390), (390, 844)]], ids=["held", "turned"])
def test_on_a_phone_all_of_the_picture_is_above_the_panel(
    page: RetouchPage, tmp_path: Path, sizes: list[tuple[int, int]]
) -> None:
    with open_tab(str(CHROMIUM)) as tab:
        for width, height in sizes:
            phone = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": True}
            tab.call("Emulation.setDeviceMetricsOverride", **phone)
            if (width, height) == sizes[0]:
                tab.call("Page.navigate", url=page.address)
            waited(tab, lambda _, text: "frame 0" in text)
        # The page turns the spectator once it is told how large the window is.
        waited(tab, lambda picture, _: bool(picture[250, 60, 0] < 120 < picture[250, 2, 0]))
        seen = unmoving(tab)
        where = saved(seen, tmp_path / "retouch.png")
        first, last = picture_corners(seen, 40)
        px = (last - first) / SIZE
        assert px[0] == pytest.approx(px[1], rel=0.05), f"look at {where}"
        assert first[0] > 0, f"look at {where}"
        assert last[0] < 300, "the body from the side is to the right of it"
        assert last[1] < 420


PRESS_NEXT = """
[...document.querySelectorAll("button")].find(b => b.innerText.includes("Next uncertain")).click()
"""


def seen_from_the_side(joints_m: np.ndarray, joints: list[int]) -> np.ndarray:
    """Where in the room, to the right and up, the middle of some joints is drawn."""
    middle = (joints_m[joints] - joints_m[0] * (1.0, 0.0, 1.0)).mean(axis=0)
    return np.array([TALL_M * SIZE[0] / SIZE[1] + GAP_M - middle[2], middle[1]])


def test_what_is_said_or_undone_stops_the_player_and_is_shown_at_once(
    page: RetouchPage, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So does going to a frame; the first is shown as the page opens."""
    heard: list[str] = []
    monkeypatch.setattr(page._player, "stop", lambda: heard.append("stop"))
    monkeypatch.setattr(page, "_show", lambda: heard.append("show"))
    deeds: list[Callable[[], object]] = [
        lambda: page.say(Notes()),
        page.undo,
        lambda: page.go_to(3),
    ]
    for deed in deeds:
        heard.clear()
        deed()
        assert heard == ["stop", "show"]
    heard.clear()
    page.go_to(None)
    assert heard == ["stop"]


def test_the_first_frame_with_a_pose_is_shown_as_the_page_opens(page: RetouchPage) -> None:
    assert page._controls._slider.value == int(page.take.frame[page._row])
    assert page._easel._balls.visible
    assert np.array(page._easel._balls.batched_positions).any()
