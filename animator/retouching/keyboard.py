"""The keyboard of the retouching page: every pointer action, a pixel at a time."""

from collections.abc import Callable
from typing import Final, Literal, NamedTuple, Protocol

import viser

FAR_PX: Final = 10.0
"""Step of a joint with shift, the video's pixels; without it 1."""

Letter = Literal["N", "I", "J", "K", "L", "F", "B", "O", "X", "U", "G", "V", "R"]
"""Keys that viser's own client uses to move the spectator: W, A, S, D, Q, E and the arrow keys."""


class Deeds(Protocol):
    """Key events for the page."""

    def choose(self, step: int) -> None:
        """Choose another joint."""

    def nudge(self, across_px: float, down_px: float) -> None:
        """Move the chosen joint."""

    def flip_chosen(self) -> None:
        """Let the segment that ends there lean the other way."""

    def let_go(self) -> None:
        """Give placed joints back to the program."""

    def go(self, frames: int) -> None:
        """Another frame."""

    def look(self, step: int) -> None:
        """Another frame with an open question."""

    def play(self) -> None:
        """Play or pause."""

    def undo(self) -> None:
        """Undo the last input."""

    def keep(self) -> None:
        """Save the inputs."""

    def fit_again(self) -> None:
        """Fit the video again with the inputs."""


class Key(NamedTuple):
    """A key and its action."""

    letter: Letter
    shift: bool
    does: str
    deed: Callable[[Deeds], None]


KEYS: Final = (
    Key("N", False, "choose the next joint", lambda page: page.choose(1)),
    Key("N", True, "choose the joint before", lambda page: page.choose(-1)),
    Key("I", False, "move it up a pixel", lambda page: page.nudge(0.0, -1.0)),
    Key("K", False, "move it down a pixel", lambda page: page.nudge(0.0, 1.0)),
    Key("J", False, "move it left a pixel", lambda page: page.nudge(-1.0, 0.0)),
    Key("L", False, "move it right a pixel", lambda page: page.nudge(1.0, 0.0)),
    Key("I", True, "move it up ten pixels", lambda page: page.nudge(0.0, -FAR_PX)),
    Key("K", True, "move it down ten pixels", lambda page: page.nudge(0.0, FAR_PX)),
    Key("J", True, "move it left ten pixels", lambda page: page.nudge(-FAR_PX, 0.0)),
    Key("L", True, "move it right ten pixels", lambda page: page.nudge(FAR_PX, 0.0)),
    Key(
        "O",
        False,
        "let the segment that ends there lean the other way",
        lambda page: page.flip_chosen(),
    ),
    Key("X", False, "let go of placed joints", lambda page: page.let_go()),
    Key("F", False, "next frame", lambda page: page.go(1)),
    Key("B", False, "frame before", lambda page: page.go(-1)),
    Key("F", True, "next uncertain frame", lambda page: page.look(1)),
    Key("B", True, "uncertain frame before", lambda page: page.look(-1)),
    Key("G", False, "play, or stop", lambda page: page.play()),
    Key("U", False, "undo", lambda page: page.undo()),
    Key("V", False, "save", lambda page: page.keep()),
    Key("R", False, "fit the video again with what was said", lambda page: page.fit_again()),
)


def bind(gui: viser.GuiApi, page: Deeds) -> None:
    """Deliver a browser's keys to the page; its command palette (Ctrl-K) lists them too."""

    def told(key: Key) -> None:
        command = gui.add_command(
            key.does, hotkey=key.letter, modifier="shift" if key.shift else None
        )
        command.on_trigger(lambda _: key.deed(page))

    for key in KEYS:
        told(key)


def spoken_keys() -> list[tuple[str, str]]:
    """Keys and their actions, for the page's help: the four of a move in one line."""
    moves = {key.letter for key in KEYS if key.does.startswith("move")}
    others = [(_name(key), key.does) for key in KEYS if key.letter not in moves]
    letters = " ".join(key.letter for key in KEYS if key.letter in moves and not key.shift)
    move = (letters, f"move it up, down, left, right by a pixel; with Shift by {FAR_PX:.0f}")
    return [*others[:2], move, *others[2:]]


def _name(key: Key) -> str:
    return f"Shift {key.letter}" if key.shift else key.letter
