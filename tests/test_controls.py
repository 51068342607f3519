"""The retouching page's panel: what a browser says there reaches the page, and nothing else."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

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
