"""The retouching page by keyboard alone: in words of the page, and with a browser's own keys."""

from pathlib import Path
from unittest.mock import MagicMock

import pytest

pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")

from browser import Tab, open_tab, saved, waited
from test_retouch import CHROMIUM, filmed, page, said
from test_take import ARM, WRIST

from animator.retouching.keyboard import KEYS, Key, bind, spoken_keys
from animator.retouching.retouch import RetouchPage
from common.body.body import JOINT_NAMES, LIMB_ENDS
from common.notes.notes import Notes, held

__all__ = ["page"]


def key(letter: str, shift: bool = False) -> Key:
    return next(each for each in KEYS if (each.letter, each.shift) == (letter, shift))


def pressed(page: RetouchPage, letters: str) -> None:
    """Keys one after the other; capitals are with shift."""
    for letter in letters:
        key(letter.upper(), letter.isupper()).deed(page)


def test_no_key_does_two_things_or_leads_the_spectator_about() -> None:
    """W, A, S, D, Q and E move viser's camera, whatever else they do."""
    assert not {each.letter for each in KEYS} & set("WASDQE")
    assert len({(each.letter, each.shift) for each in KEYS}) == len(KEYS)
    help_of = dict(spoken_keys())
    assert {each.letter for each in KEYS} == set("".join(help_of).replace("Shift", "")) - {" "}


def test_a_joint_is_moved_by_pixels_of_the_video_and_undone_at_once(
    page: RetouchPage, tmp_path: Path
) -> None:
    """Presses that follow each other are one input."""
    column, row = filmed().joints_px[0, WRIST].tolist()
    pressed(page, "llLik")
    at = said(page, tmp_path, 0).joints_px["l_wrist"]
    assert at == pytest.approx((column + 12, row), abs=0.05)
    assert said(page, tmp_path, 2).joints_px == {}, "it is placed in this frame alone"
    pressed(page, "nj")
    other = JOINT_NAMES[WRIST + 1]
    assert set(said(page, tmp_path, 0).joints_px) == {"l_wrist", other}
    pressed(page, "u")
    assert set(said(page, tmp_path, 0).joints_px) == {"l_wrist"}
    pressed(page, "f")
    pressed(page, "u")
    assert said(page, tmp_path, 0) == said(page, tmp_path, 100)
    assert page._row == 0, "the frame of what is undone is shown"
    pressed(page, "u")
    assert "nothing to undo" in page._controls.kept.content


def test_frames_are_gone_through_and_what_is_uncertain_is_settled(
    page: RetouchPage, tmp_path: Path
) -> None:
    pressed(page, "bff")
    assert page._row == 2
    pressed(page, "F")
    assert page._row == 3
    page.pick(int(LIMB_ENDS[ARM, 1]))
    pressed(page, "o")
    assert said(page, tmp_path, 6).depth == {"l_upper_arm": "away"}
    pressed(page, "B")
    assert page._row == 3, "before it nothing is uncertain"
    page.pick(JOINT_NAMES.index("pelvis"))
    pressed(page, "o")
    assert "no segment ends there" in page._controls.kept.content


def test_nobody_who_is_not_seen_is_moved(page: RetouchPage) -> None:
    page.take.joints_m[2] = page.take.joints_m[2] * float("nan")
    pressed(page, "ffl")
    assert page.notes == Notes()
    assert "no person is seen here" in page._controls.kept.content


def test_what_could_not_be_kept_is_kept_by_the_next_save(page: RetouchPage, tmp_path: Path) -> None:
    keeps, page._save = page._save, lambda _: ("no space left", False)
    pressed(page, "l")
    assert "no space left" in page._controls.kept.content
    page._save = keeps
    pressed(page, "v")
    assert "l_wrist" in said(page, tmp_path, 0).joints_px


def press(tab: Tab, letter: str, shift: bool = False) -> None:
    """A key as the browser's own keyboard sends it."""
    typed = letter.upper() if shift else letter.lower()
    more = {
        "key": typed,
        "code": f"Key{letter.upper()}",
        "windowsVirtualKeyCode": ord(letter.upper()),
        "modifiers": 8 if shift else 0,
    }
    tab.call("Input.dispatchKeyEvent", type="keyDown", text=typed, **more)
    tab.call("Input.dispatchKeyEvent", type="keyUp", **more)


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: the page is not looked at")
def test_a_run_is_retouched_by_keyboard_alone(page: RetouchPage, tmp_path: Path) -> None:
    column, row = filmed().joints_px[0, WRIST].tolist()
    with open_tab(str(CHROMIUM)) as tab:
        tab.call("Page.navigate", url=page.address)
        waited(tab, lambda picture, text: "frame 0" in text and picture[400, 300, 0] < 120)
        press(tab, "l", shift=True)
        waited(tab, lambda *_: page.notes != Notes(), 20.0)
        press(tab, "k")
        where = saved(tab.screenshot(), tmp_path / "keys.png")
        down = (column + 10, row + 1)
        waited(tab, lambda *_: held(page.notes, 0).joints_px.get("l_wrist", (0, 0))[1] > row, 20.0)
        assert held(page.notes, 0).joints_px["l_wrist"] == pytest.approx(down, abs=0.05), where
        press(tab, "u")
        waited(tab, lambda *_: page.notes == Notes(), 20.0)
        assert page.notes == Notes(), "two presses are one input"
        press(tab, "f")
        assert "frame 2" in seen(tab, "frame 2")
        press(tab, "b")
        assert "frame 0" in seen(tab, "frame 0")
        press(tab, "f", shift=True)
        assert "lean this way?" in seen(tab, "lean this way?")
        press(tab, "g")
        waited(tab, lambda *_: page._row == 11, 20.0)
        assert page._row == 11, "it plays to the end"
        press(tab, "v")
        assert "kept" in seen(tab, "kept")


def seen(tab: Tab, words: str) -> str:
    """The page's text once it has these words, or in the end."""
    waited(tab, lambda _, text: words in text, 20.0)
    return tab.text()


def test_each_key_of_a_browser_does_its_deed() -> None:
    gui, page = MagicMock(), MagicMock()
    bind(gui, page)
    given = gui.add_command.call_args_list
    assert [(each.args[0], each.kwargs) for each in given] == [
        (one.does, {"hotkey": one.letter, "modifier": "shift" if one.shift else None})
        for one in KEYS
    ]
    triggers = gui.add_command.return_value.on_trigger.call_args_list
    for one, trigger in zip(KEYS, triggers, strict=True):
        expected = MagicMock()
        one.deed(expected)
        page.reset_mock()
        trigger.args[0](None)
        assert page.mock_calls == expected.mock_calls, one.does
