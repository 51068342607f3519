"""The live page: what a browser is told, and what is seen in a real one where there is one."""

import base64
import json
import os
import shutil
import threading
import time
from collections.abc import Iterator
from multiprocessing import Pipe
from pathlib import Path
from typing import Any, Final

import cv2
import msgspec
import numpy as np
import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import NotNow, Tab, open_tab, own_address, saved
from show_page import RIG, pulses, snapshot_at, two_at
from waiting import until
from websockets.sync.client import connect

import animator.__main__
from animator.page.door import Entrance, invitation_of
from animator.page.live import LivePage
from animator.scene import LEFT, PEOPLE, RIGHT
from common.body.body import POSE_INDEX
from common.body.observation import Facing
from common.bus.bus import BusError
from common.bus.control_messages import Answer
from common.bus.messages import Performance, Posture
from common.bus.process import ProcessContext
from common.config.settings import Settings
from runtime.live.free_ports import free_settings

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
SOFT = ("--disable-gpu",)
SIZES = {"desk": (1400, 900), "phone": (390, 844)}
AT_A_DESK, AT_A_PHONE = (
    pytest.mark.parametrize("looking", [size], indirect=True) for size in ("desk", "phone")
)
"""For what is shown and answered however wide the page is."""


@pytest.fixture
def page() -> Iterator[LivePage]:
    one = LivePage("a body that moves", free_port(), commands=True)
    yield one
    one.close()


def told(page: LivePage, count: int) -> list[dict[str, Any]]:
    """The first things that a browser is told that comes now."""
    with connect(page.address.replace("http", "ws") + "/live", max_size=None) as browser:
        return [json.loads(browser.recv(timeout=10)) for _ in range(count)]


@pytest.mark.parametrize("commands", [True, False])
def test_a_page_greets_with_its_title_and_the_millisecond_in_which_it_began(
    commands: bool,
) -> None:
    """Another millisecond is another run: a browser takes no more than 53 bits for a number."""
    before_ms = time.time() * 1e3
    page = LivePage("a run", free_port(), commands)
    after_ms = time.time() * 1e3
    (hello,) = told(page, 1)
    page.close()
    assert (hello["kind"], hello["title"], hello["commands"]) == ("hello", "a run", commands)
    assert before_ms - 1 <= hello["run"] <= after_ms


def test_a_page_is_told_what_the_cameras_are_called() -> None:
    page = LivePage("a run", free_port(), commands=False, cameras=("door", "camera 2"))
    (hello,) = told(page, 1)
    page.close()
    assert hello["cameras"] == ["door", "camera 2"]


def test_who_comes_late_is_told_the_run_so_far_and_its_end_last(page: LivePage) -> None:
    page.show(snapshot_at(0))  # no cameras yet: nothing could be drawn
    page.set_rig(RIG)
    for frame in range(3):
        page.show(snapshot_at(frame))
    page.show_health(pulses())
    page.end({"clip": "walk"})
    heard = told(page, 7)
    assert heard[0]["title"] == "a body that moves"
    assert [each["kind"] for each in heard[1:]] == [*("room", "health"), *["frame"] * 3, "over"]
    assert [each["number"] for each in heard[3:6]] == [0, 1, 2]


def test_what_is_kept_of_a_long_run_is_bounded() -> None:
    page = LivePage("a long run", free_port(), commands=True, most_bytes=60_000)
    page.set_rig(RIG)
    for frame in range(12):
        page.show(snapshot_at(frame))
    heard = told(page, 3)
    page.close()
    assert heard[2]["number"] > 0, "the oldest gave way"


def test_who_comes_late_is_told_that_a_recording_goes_on(page: LivePage) -> None:
    """A browser that is loaded again would else offer to begin it."""
    page.answer(Answer(what="record", well=True, text="recording"))
    page.answer(Answer(what="save", well=True, text="15.0 s written"))
    page.answer(Answer(what="end_record", well=False, text="cannot write"))
    page.set_rig(RIG)
    heard = told(page, 3)
    assert [each["what"] for each in heard if each["kind"] == "told"] == ["record"]
    page.answer(Answer(what="end_record", well=True, text="3.0 s written"))
    page.show(snapshot_at(0))
    assert "told" not in [each["kind"] for each in told(page, 3)]


def test_the_page_waits_for_its_run_as_long_as_the_supervisor_does(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever a first run compiles meanwhile; without a supervisor it says how long it waited."""
    monkeypatch.setattr(animator.__main__, "READY_S", 0.3)
    monkeypatch.setattr(os, "nice", lambda by: by)
    settings = free_settings(Settings())
    context = ProcessContext(stop=threading.Event())
    theirs, ours = Pipe(duplex=False)
    over = threading.Timer(1.0, lambda: ours.send({"frames": 3}))
    over.start()
    animator.__main__.main(settings, context, ending=theirs)
    assert not over.is_alive()
    with pytest.raises(BusError, match=r"nobody answers at .* after 0\.3 s"):
        animator.__main__.main(settings, context)


def test_only_what_the_page_can_ask_is_heard(page: LivePage) -> None:
    wishes = ['{"what": "save"}', '{"what": "format the disk"}', "[", '{"what": "stop", "a": 1}']
    with connect(page.address.replace("http", "ws") + "/live") as browser:
        browser.recv(timeout=10)
        for wish in wishes:
            browser.send(wish)
        heard: list[str] = []
        until_s = time.monotonic() + 10
        while not heard and time.monotonic() < until_s:
            time.sleep(0.05)
            heard += [asked.what for asked in page.asked()]
        time.sleep(0.2)
        heard += [asked.what for asked in page.asked()]
    assert heard == ["save"]


class Looking:
    """A browser that looks at a page in a window of some size."""

    def __init__(self, tab: Tab, address: str, size: tuple[int, int]) -> None:
        self.tab, (width, self._height) = tab, size
        tab.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=self._height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )
        tab.call("Page.navigate", url=address)

    def ask(self, script: str) -> Any:
        """What a piece of JavaScript gives in the page."""
        answer = self.tab.call("Runtime.evaluate", expression=script)["result"]
        return answer.get("value")

    def until(self, script: str, seconds: float = 30.0) -> Any:
        """What it gives once that is true, or in the end; nothing while a page is being loaded."""

        def found() -> Any:
            try:
                return self.ask(script)
            except NotNow:
                return None

        return until(found, seconds)

    def drawn(self) -> None:
        """Wait until what was done and heard before is seen: a page draws when its screen does."""
        twice = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
        self.tab.call("Runtime.evaluate", expression=twice, awaitPromise=True)

    def key(self, key: str, code: int = 0) -> None:
        """Press a key, as a person does."""
        for kind in ("keyDown", "keyUp"):
            text = {"text": key} if len(key) == 1 and kind == "keyDown" else {}
            self.tab.call(
                "Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, **text
            )

    def seen(self, selector: str) -> np.ndarray:
        """The pixels of an element."""
        box = self.ask(
            f"(() => {{ const e = document.querySelector('{selector}'); e.scrollIntoView();"
            "const b = e.getBoundingClientRect();"
            "return [b.x + scrollX, b.y + scrollY, b.width, b.height].join() })()"
        )
        x, y, width, height = (float(value) for value in box.split(","))
        clip = {"x": x, "y": y, "width": width, "height": height, "scale": 1}
        png = self.tab.call("Page.captureScreenshot", format="png", clip=clip)["data"]
        picture = cv2.imdecode(np.frombuffer(base64.b64decode(png), np.uint8), cv2.IMREAD_COLOR_RGB)
        assert picture is not None
        return np.asarray(picture)


@pytest.fixture(params=SIZES)
def looking(page: LivePage, request: pytest.FixtureRequest) -> Iterator[Looking]:
    if CHROMIUM is None:
        pytest.skip("no Chromium here: the page is not looked at")
    page.set_rig(RIG)
    with open_tab(CHROMIUM, SOFT) as tab:
        yield Looking(tab, page.address, SIZES[request.param])


def hue_deg(colours: np.ndarray) -> np.ndarray:
    """Hue of what is coloured, NaN of what is grey; (..., 3) red, green, blue."""
    values = np.asarray(colours, float)
    red, green, blue = np.moveaxis(values, -1, 0)
    hue = np.degrees(np.arctan2(np.sqrt(3.0) * (green - blue), 2.0 * red - green - blue))
    return np.where(np.ptp(values, axis=-1) > 45, hue, np.nan)


def share_like(picture: np.ndarray, colour: tuple[int, int, int]) -> float:
    """Share of a picture that has about a colour's hue."""
    return float(np.mean(np.abs(hue_deg(picture) - hue_deg(np.array(colour))) < 12.0))


@pytest.mark.slow
def test_a_browser_shows_the_body_both_views_and_asks_nobody_else(
    page: LivePage, looking: Looking, tmp_path: Path
) -> None:
    page.show(snapshot_at(4))
    page.show_health(pulses())
    assert looking.until("document.body.dataset.drawn")
    assert looking.until("document.body.innerText.includes('from camera to pose')")
    looking.drawn()
    whole = saved(looking.tab.screenshot(), tmp_path / "page.png")
    room = looking.seen("#room")
    assert share_like(room, LEFT) > 0.005, f"no left side drawn: look at {whole}"
    assert share_like(room, RIGHT) > 0.005, f"no right side drawn: look at {whole}"
    for n in (1, 2):
        view = looking.seen(f"#views figure:nth-child({n}) canvas")
        assert np.mean(view.max(axis=2) < 70) > 0.5, f"no night in view {n}: look at {whole}"
        assert share_like(view, RIGHT) > 0.001, f"no body over view {n}: look at {whole}"
    text = looking.tab.text()
    assert "walk in place" in text
    assert looking.ask("document.querySelector('#trust').hidden"), "nothing is told of the cameras"
    assert "People" not in text, "one person needs no list"
    assert "15.0 frames a second · 11 ms from camera to pose · no deadline missed" in text
    assert looking.ask("document.documentElement.scrollWidth <= innerWidth"), "it is too wide"
    own = (page.address, page.address.replace("http", "ws"), "data:", "blob:")
    assert [address for address in looking.tab.asked if not address.startswith(own)] == []


@pytest.mark.slow
def test_the_pictures_of_more_than_two_cameras_are_a_strip(
    page: LivePage, looking: Looking
) -> None:
    """Side by side, and no wider than the page; the third camera alone may be asked about too."""
    page.set_rig(msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0])))
    seen = snapshot_at(4)
    assert seen.body is not None
    sides: tuple[Facing, ...] = ("facade", "flank", "facade")
    pixels = {
        name: (*places, places[0])
        for name in ("joints_px", "extremities_px")
        for places in [getattr(seen.body, name)]
    }
    body = msgspec.structs.replace(
        seen.body, views="3", score=(0.0, 0.0, 0.8), facing=sides, **pixels
    )
    third = msgspec.structs.replace(seen.reports[1], viewer=3)
    page.show(msgspec.structs.replace(seen, body=body, reports={**seen.reports, 3: third}))
    assert looking.until("document.body.dataset.drawn")
    tops = "[...document.querySelectorAll('#views figure')].map((one) => one.offsetTop).join()"
    (top,) = {*str(looking.ask(tops)).split(",")}
    assert float(top) > 0.0
    assert looking.ask("document.querySelectorAll('#views figure').length === 3")
    assert looking.ask("document.documentElement.scrollWidth <= innerWidth"), "it is too wide"
    assert not looking.ask("document.querySelector('#front').hidden")


def ended(event: Performance, person: int = 0) -> Posture:
    return Posture(
        frame=event.end, captured_s=event.end_s, clock_s=0.0, name="", person=person, event=event
    )


@pytest.mark.slow
def test_each_of_several_people_has_a_colour_a_number_and_a_posture(
    page: LivePage, looking: Looking, tmp_path: Path
) -> None:
    page.show(two_at(4), [ended(Performance("squat", 0, 3, 0.0, 0.2, 1.0, 1), 2)])
    assert looking.until("document.querySelectorAll('#everyone li').length === 2")
    looking.drawn()
    whole = saved(looking.tab.screenshot(), tmp_path / "page.png")
    for colour in PEOPLE[:2]:
        assert share_like(looking.seen("#room"), colour) > 0.005, f"look at {whole}"
        first = looking.seen("#views figure:nth-child(1) canvas")
        assert share_like(first, colour) > 0.002, f"look at {whole}"
    assert looking.ask(LISTED) == "1 walk in place tracking|2 squat tracking"
    assert looking.ask("document.querySelector('#posture').innerText").split() == [
        *("1", "walk", "in", "place")
    ]
    assert looking.ask("document.querySelector('#counts').textContent") == "2: squat 1"
    assert "person 2, front or back" in looking.ask(
        "document.querySelector('#views canvas').getAttribute('aria-label')"
    )
    looking.ask("document.querySelector('#everyone li:nth-child(2) button').click()")
    assert looking.until("document.querySelector('#name').textContent === 'squat'")
    assert looking.ask("document.querySelector('#words').textContent") == "person 2: tracking"
    assert looking.ask("document.documentElement.scrollWidth <= innerWidth"), "it is too wide"


@pytest.mark.slow
@AT_A_PHONE
def test_each_person_is_advised_by_their_number_below_the_camera(
    page: LivePage, looking: Looking
) -> None:
    whole = two_at(4)
    assert whole.body is not None
    (other,) = whole.others
    first = msgspec.structs.replace(whole.body, advice=("raise both arms", ""))
    second = msgspec.structs.replace(other.body, advice=("step back", ""))
    others = (msgspec.structs.replace(other, body=second),)
    page.show(msgspec.structs.replace(whole, body=first, others=others))
    assert looking.until("document.body.dataset.frame === '4'")
    hints = "[...document.querySelectorAll('#views .hint')].map((one) => one.textContent).join('|')"
    assert looking.ask(hints) == "person 1: raise both arms; person 2: step back|"
    label = "document.querySelector('#views canvas').getAttribute('aria-label')"
    assert looking.ask(label).endswith(", person 1: raise both arms; person 2: step back")
    assert looking.ask("document.documentElement.scrollWidth <= innerWidth"), "it is too wide"


LISTED: Final = (
    "[...document.querySelectorAll('#everyone button')]"
    ".map((row) => [...row.children].map((each) => each.textContent).join(' ')).join('|')"
)
"""The list of people in words."""
AWAY: Final = (
    "[...document.querySelectorAll('#everyone .away')].map((e) => e.dataset.person).join()"
)
"""The numbers of those who are grey in it."""


@pytest.mark.slow
@AT_A_PHONE
def test_a_person_who_is_lost_or_gone_is_grey_and_leaves_the_list_after_a_second(
    page: LivePage, looking: Looking
) -> None:
    both = two_at(0)
    (other,) = both.others
    body = msgspec.structs.replace(other.body, status="lost", pose=(), joints_px=())
    lost = msgspec.structs.replace(other, body=body)
    page.show(both)
    page.show(msgspec.structs.replace(two_at(1), others=(lost,)))
    assert looking.until(f"document.body.dataset.frame === '1' && {AWAY} === '2'")
    assert looking.ask(LISTED).endswith("|2 squat lost, searching")
    alone = msgspec.structs.replace(two_at(14), others=())
    assert alone.body is not None
    by_one = msgspec.structs.replace(alone.body, views="1")
    page.show(msgspec.structs.replace(alone, body=by_one))
    assert looking.until("document.body.dataset.frame === '14'")
    assert looking.ask(LISTED) == "1 walk in place tracking|2 no posture yet gone"
    assert looking.ask(AWAY) == "2"
    assert looking.ask("document.querySelector('#front').hidden"), "it would turn nobody"
    looking.drawn()
    assert share_like(looking.seen("#room"), PEOPLE[1]) < 0.001, "the gone person is drawn"
    page.show(msgspec.structs.replace(two_at(17), others=()))
    assert looking.until("document.body.dataset.frame === '17'")
    assert looking.ask(LISTED) == "1 walk in place tracking"
    looking.key("Home", 36)
    assert looking.until(f"{LISTED}.includes('|2 squat tracking')"), "the past has both"


@pytest.mark.slow
@AT_A_DESK
def test_pictures_and_body_move_an_event_appears_and_the_end_is_played(
    page: LivePage, looking: Looking
) -> None:
    over = ended(Performance("squat", 3, 9, 0.2, 0.6, 1.0, 1))
    gone_on = ended(Performance("squat", 3, 12, 0.2, 0.8, 1.0, 2))
    events = {9: [over], 12: [gone_on]}
    for frame in range(30):
        page.show(snapshot_at(frame), events.get(frame, []))
        time.sleep(1 / 30)
    assert looking.until("document.body.dataset.frame === '29'")
    assert looking.until("document.querySelector('#events').innerText.includes('squat × 2')")
    assert looking.ask("document.querySelectorAll('#events button').length") == 1
    assert looking.ask("document.querySelector('#counts').textContent") == "squat 2"
    counts = {"frames": 414, "frames_with_pose": 402}
    page.end({"clip": "walk", "warnings": ["it was dark <b>"], "out": "runs/1", **counts})
    assert looking.until("!document.querySelector('#ending').hidden")
    ending = looking.ask("document.querySelector('#ending').innerText")
    assert "it was dark <b>" in ending
    assert "414, 402 with a pose" in ending, "of the run, not what this page drew of it"
    assert looking.until("document.querySelector('#words').innerText.includes('over')")
    looking.key("s", 83)  # nobody is there any more who could save
    begun_s = time.monotonic()
    looking.key("Home", 36)
    assert looking.until("document.body.dataset.frame === '0'")
    looking.drawn()
    first = looking.seen("#room")
    for _ in range(4):
        looking.key("ArrowRight", 39)
    assert looking.until("document.body.dataset.frame === '4'")
    looking.drawn()
    assert np.mean(np.abs(looking.seen("#room").astype(int) - first) > 30) > 0.001
    looking.ask("document.querySelector('#speed').focus()")
    looking.ask("document.activeElement.blur()")
    looking.key(" ", 32)
    assert looking.until("document.body.dataset.frame === '29'"), "the player does not play"
    looking.ask("document.querySelector('#events button').click()")
    assert looking.until("document.body.dataset.frame === '3'"), "an event leads to its begin"
    time.sleep(max(0.0, begun_s + 4.5 - time.monotonic()))
    assert looking.ask("document.querySelector('#told').textContent") == ""


@pytest.mark.slow
@AT_A_DESK
def test_a_pause_holds_the_page_while_the_run_goes_on(page: LivePage, looking: Looking) -> None:
    for frame in range(5):
        page.show(snapshot_at(frame))
    assert looking.until("document.body.dataset.frame === '4'")
    looking.ask("document.querySelector('#play').click()")
    assert looking.until("document.querySelector('#live').ariaPressed === 'false'")
    for frame in range(5, 9):
        page.show(snapshot_at(frame))
    assert looking.until("document.querySelector('#scrub').max === '8'"), "the run goes on"
    assert looking.ask("document.body.dataset.frame") == "4"
    looking.key("l", 76)
    assert looking.until("document.body.dataset.frame === '8'")


@pytest.mark.slow
@AT_A_DESK
def test_another_run_at_the_same_address_begins_afresh(page: LivePage, looking: Looking) -> None:
    for frame in range(9):
        page.show(snapshot_at(frame))
    assert looking.until("document.body.dataset.frame === '8'")
    page.close()
    port = int(page.address.rsplit(":", 1)[1])
    other = LivePage("the next run", port, commands=False)
    try:
        other.set_rig(RIG)
        other.show(snapshot_at(2))
        assert looking.until("document.title.startsWith('the next run')")
        assert looking.until("document.body.dataset.frame === '2'")
    finally:
        other.close()


@pytest.mark.slow
@AT_A_PHONE
def test_buttons_ask_and_answers_are_shown(page: LivePage, looking: Looking) -> None:
    page.show(snapshot_at(0))
    assert looking.until("!document.querySelector('#actions').hidden")
    looking.ask("document.querySelector('#speed').focus()")
    looking.key("s", 83)  # letters choose a speed there
    looking.ask("document.activeElement.blur()")
    looking.key("r", 82)
    assert until(lambda: [each.what for each in page.asked()]) == ["record"]
    page.answer(Answer(what="record", well=True, text="recording <i>"))
    assert looking.until("document.querySelector('#record').ariaPressed === 'true'")
    assert looking.ask("document.querySelector('#told').textContent") == "recording <i>"


@pytest.mark.slow
@AT_A_DESK
def test_an_angle_next_to_nothing_has_no_sign(page: LivePage, looking: Looking) -> None:
    keys = "document.querySelector('#keys').textContent"
    for n in range(60):  # whichever of them it shows: a busy browser leaves frames out
        frame = snapshot_at(n)
        assert frame.body is not None
        pose = [*frame.body.pose]
        pose[POSE_INDEX["r_knee_x"]] = -0.3
        page.show(
            msgspec.structs.replace(
                frame, body=msgspec.structs.replace(frame.body, pose=tuple(pose))
            )
        )
        time.sleep(0.05)
    assert looking.until(f"{keys}.includes('r knee x0°')"), looking.ask(keys)


@pytest.mark.slow
@AT_A_PHONE
def test_front_and_back_are_offered_where_one_camera_alone_sees(
    page: LivePage, looking: Looking
) -> None:
    both = snapshot_at(0)
    assert both.body is not None
    page.show(both)
    shown = "[...document.querySelectorAll('#front, #back')].map(e => !e.hidden).join()"
    assert looking.until(f"document.body.dataset.frame === '0' && {shown} === 'false,false'")
    page.show(
        msgspec.structs.replace(both, body=msgspec.structs.replace(both.body, frame=1, views="2"))
    )
    assert looking.until(f"document.body.dataset.frame === '1' && {shown} === 'true,true'")


@pytest.mark.slow
def test_all_that_can_be_pressed_has_a_name_and_is_reached_by_keyboard(
    page: LivePage, looking: Looking
) -> None:
    frame = snapshot_at(0)
    assert frame.posture is not None
    evil = msgspec.structs.replace(frame.posture, name='<img src=x onerror="alert(1)">')
    assert frame.body is not None
    alone = msgspec.structs.replace(frame.body, views="1")  # all buttons are there
    page.show(msgspec.structs.replace(frame, body=alone, posture=evil))
    assert looking.until("document.body.dataset.drawn")
    assert looking.ask("document.querySelectorAll('#posture img').length") == 0
    tree = looking.tab.call("Accessibility.getFullAXTree")["nodes"]
    pressed = [
        node
        for node in tree
        if node.get("role", {}).get("value") in ("button", "slider", "combobox", "checkbox")
        and not node.get("ignored")
    ]
    assert len(pressed) > 10
    assert [node for node in pressed if not node.get("name", {}).get("value")] == []
    reached = set()
    for _ in range(40):
        looking.key("Tab", 9)
        reached.add(looking.ask("document.activeElement.id"))
    assert {"room", "record", "save", "stop", "play", "live", "scrub", "speed"} <= reached


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: the page is not looked at")
def test_the_printed_address_shows_the_run_beyond_loopback_and_the_next_run_has_another() -> None:
    """Who stays on the page of a run that is over is told why the next one does not let them in."""
    host, port = own_address(), free_port()
    entrance = Entrance(host, token="a-long-word")
    page = LivePage("a body that moves", port, commands=True, entrance=entrance)
    page.set_rig(RIG)
    page.show(snapshot_at(0))
    try:
        with open_tab(str(CHROMIUM), SOFT) as tab:
            looking = Looking(tab, page.address, SIZES["desk"])
            assert looking.until("document.body?.innerText.includes('?token=')")
            tab.call("Page.navigate", url=invitation_of(entrance, port))
            assert looking.until("document.body?.dataset.drawn")
            assert looking.ask("location.href") == f"http://{host}:{port}/"
            assert looking.ask("document.cookie") == "", "no script reads the token"
            looking.ask("window.isBefore = true")
            tab.call("Page.reload")
            page.show(snapshot_at(1))
            again = "!window.isBefore && document.body?.dataset.frame === '1'"
            assert looking.until(again), "the cookie is kept"
            page.close()
            page = LivePage("the next run", port, True, Entrance(host, token="another-word"))
            assert looking.until("document.querySelector('#words').innerText.includes('printed')")
            tab.call("Page.navigate", url=f"{page.address}/?token=another-word")
            assert looking.until("document.title.startsWith('the next run')")
    finally:
        page.close()
