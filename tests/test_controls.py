"""The retouching page's panel: what a browser says there reaches the page, and nothing else."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import pytest

pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")

from test_retouch import filmed, free_port
from test_take import ARM

from animator.retouching.controls import Controls
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
