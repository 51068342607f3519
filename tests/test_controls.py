"""The retouching page's panel: what a browser says there reaches the page, and nothing else."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")

from test_retouch import filmed
from test_take import ARM

from animator.retouching.controls import AUTO, Controls
from animator.retouching.panel import ACCENT, piece, spoken
from animator.retouching.viser_door import close_server, open_server
from common.body.body import JOINT_NAMES
from common.notes.notes import Note, Notes

BROWSER = SimpleNamespace(client=object())


class Heard:
    """A page that writes down what is said to it."""

    def __init__(self) -> None:
        self.said: list[tuple[str, tuple[Any, ...]]] = []

    def __getattr__(self, name: str) -> Any:
        return lambda *given: self.said.append((name, given))


@pytest.fixture
def page() -> Heard:
    return Heard()


@pytest.fixture
def controls(page: Heard) -> Iterator[Controls]:
    server = open_server(free_port())
    yield Controls(server.gui, filmed(), page)
    close_server(server)


def test_what_a_browser_chooses_is_said_and_what_is_shown_is_not(
    controls: Controls, page: Heard
) -> None:
    controls.show(3, JOINT_NAMES.index("r_knee"), Notes(note=(Note(6, "left"),)))
    assert controls.orientation.value == "left"
    assert page.said == []
    controls.if_user(SimpleNamespace(client=None), controls.turned)
    assert page.said == []
    controls.if_user(BROWSER, controls.turned)
    controls.if_user(BROWSER, controls._picked)
    controls.if_user(BROWSER, controls._slid)
    assert page.said == [
        ("face", ("left",)),
        ("pick", (JOINT_NAMES.index("r_knee"),)),
        ("go_to_frame", (6,)),
    ]


def test_a_frame_without_notes_takes_back_what_the_one_before_showed(controls: Controls) -> None:
    controls.show(3, ARM, Notes(note=(Note(6, "left", {"l_upper_arm": "away"}),)))
    assert (controls.orientation.value, controls._depth["l_upper_arm"].value) == ("left", "away")
    controls.show(3, ARM, Notes())
    assert (controls.orientation.value, controls._depth["l_upper_arm"].value) == (AUTO, AUTO)


def test_what_a_frame_leaves_open_and_what_became_of_an_input_are_told(controls: Controls) -> None:
    controls.show(3, ARM, Notes())
    assert "does the left upper arm lean" in controls.open.content
    controls.tell("no space <left>", False)
    assert "no space &lt;left&gt;" in controls.kept.content


class Gui:
    """A panel that nobody sees: its buttons are pressed by their names."""

    def __init__(self) -> None:
        self.pressed: dict[str, Any] = {}
        self.sliders: list[dict[str, Any]] = []
        self.main_panel = SimpleNamespace(dock_right=lambda: None, set_width=lambda _: None)

    def add_button(self, name: str) -> Any:
        return SimpleNamespace(on_click=lambda said: self.pressed.setdefault(name, said))

    def add_button_group(self, _name: str, names: tuple[str, ...]) -> Any:
        def on_click(said: Any) -> None:
            for name in names:
                event = SimpleNamespace(target=SimpleNamespace(value=name))
                self.pressed[name] = lambda _, event=event: said(event)

        return SimpleNamespace(on_click=on_click)

    def add_slider(self, _name: str, **given: Any) -> Any:
        self.sliders.append(given)
        return MagicMock()

    def add_folder(self, *_: Any, **__: Any) -> Any:
        return MagicMock()

    def __getattr__(self, _name: str) -> Any:
        return lambda *_, **__: MagicMock()


def test_each_button_does_what_it_says(page: Heard) -> None:
    gui = Gui()
    Controls(gui, filmed(), page)
    due = {
        "Fit again": ("fit_again", ()),
        "Next uncertain frame": ("look", (1,)),
        "Previous uncertain frame": ("look", (-1,)),
        "Play": ("play", ()),
        "Undo": ("undo", ()),
        "Save": ("keep", ()),
        "Let go of placed joints": ("let_go", ()),
    }
    assert gui.pressed.keys() == due.keys()
    for name, said in due.items():
        gui.pressed[name](None)
        assert page.said.pop() == said
    assert page.said == []


def test_the_slider_goes_from_the_first_frame_to_the_last(page: Heard) -> None:
    gui, take = Gui(), filmed()
    Controls(gui, take, page)
    (slider,) = gui.sliders
    first, last = int(take.frame[0]), int(take.frame[-1])
    assert (slider["min"], slider["max"], slider["initial_value"]) == (first, last, first)


class Widget:
    """A part of the panel that a browser can change: what it listens to is kept."""

    def __init__(self, value: Any = None, options: tuple[str, ...] = ()) -> None:
        self.value, self.options, self.content = value, options, ""
        self.heard: Any = None

    def on_update(self, heard: Any) -> None:
        self.heard = heard


class Kept(Gui):
    """The same, with its lists and texts."""

    def __init__(self) -> None:
        super().__init__()
        self.lists: dict[str, Widget] = {}
        self.slider = Widget()
        self.texts: list[str] = []
        self.themes: list[dict[str, Any]] = []
        self.widths: list[Any] = []
        self.main_panel = SimpleNamespace(
            dock_right=lambda: self.widths.append("right"), set_width=self.widths.append
        )

    def add_slider(self, _name: str, **given: Any) -> Any:
        super().add_slider(_name, **given)
        return self.slider

    def add_dropdown(self, name: str, options: tuple[str, ...]) -> Any:
        return self.lists.setdefault(name, Widget(options[0], tuple(options)))

    def add_html(self, text: str) -> Any:
        self.texts.append(text)
        return Widget()

    def configure_theme(self, **given: Any) -> None:
        self.themes.append(given)


def test_what_is_chosen_in_a_list_or_on_the_slider_is_said_for_what_it_is(page: Heard) -> None:
    gui = Kept()
    Controls(gui, filmed(), page)
    gui.slider.value = 6
    gui.lists["faces"].value = "backward_left"
    gui.lists["joint"].value = gui.lists["joint"].options[JOINT_NAMES.index("l_knee")]
    limb = gui.lists[spoken("r_upper_leg")]
    limb.value = "toward"
    for widget in (gui.slider, gui.lists["faces"], gui.lists["joint"], limb):
        widget.heard(SimpleNamespace(client=None))
    assert page.said == []
    for widget in (gui.slider, gui.lists["faces"], gui.lists["joint"], limb):
        widget.heard(BROWSER)
    assert page.said == [
        ("go_to_frame", (6,)),
        ("face", ("backward_left",)),
        ("pick", (JOINT_NAMES.index("l_knee"),)),
        ("lean", ("r_upper_leg", "toward")),
    ]


def test_the_panel_is_docked_at_the_right_and_has_its_help_and_its_keys(page: Heard) -> None:
    gui = Kept()
    Controls(gui, filmed(), page)
    assert gui.widths == ["right", 340]
    (theme,) = gui.themes
    assert (theme["show_logo"], theme["show_share_button"]) == (False, False)
    assert theme["brand_color"] == ACCENT
    assert gui.texts[:2] == ["", ""]
    assert piece("retouch_help.html", {}) in gui.texts
    assert any("key" in text.lower() for text in gui.texts[3:])
