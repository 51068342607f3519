"""The panel of the retouching page: the frame, its open questions, and the user's inputs."""

from collections.abc import Callable
from typing import Any, Final, Protocol

import viser

from animator.retouching.keyboard import Deeds, spoken_keys
from animator.retouching.panel import ACCENT, piece, questions, spoken
from animator.take import Take
from common.body.body import JOINT_NAMES, LIMBS
from common.notes.notes import ORIENTATIONS, WAYS, Auto, Depth, Notes, Orientation, held

PANEL_PX: Final = 340
AUTO: Final = "auto"


class Words(Deeds, Protocol):
    """Events from the panel to the page."""

    def go_to_frame(self, frame: int) -> None:
        """Another frame of the video."""

    def pick(self, joint: int) -> None:
        """Choose this joint."""

    def face(self, way: Orientation | Auto) -> None:
        """The person faces this way, from here on."""

    def lean(self, limb: str, way: Depth | Auto) -> None:
        """A segment leans this way, from here on."""


class Controls:
    """The panel in all browsers at the page.

    Args:
        gui: The server's GUI.
        take: The run.
        page: Receives the events.
    """

    def __init__(self, gui: viser.GuiApi, take: Take, page: Words) -> None:
        self.take, self._page = take, page
        gui.configure_theme(show_logo=False, show_share_button=False, brand_color=ACCENT)
        gui.main_panel.dock_right()
        gui.main_panel.set_width(PANEL_PX)
        first, last = int(take.frame[0]), int(take.frame[-1])
        self._slider = gui.add_slider(
            "frame", min=first, max=max(first + 1, last), step=1, initial_value=first
        )
        gui.add_button("Fit again").on_click(lambda _: page.fit_again())
        gui.add_button("Next uncertain frame").on_click(lambda _: page.look(1))
        gui.add_button("Previous uncertain frame").on_click(lambda _: page.look(-1))
        pressed = {"Play": page.play, "Undo": page.undo, "Save": page.keep}
        buttons = gui.add_button_group("", tuple(pressed))
        buttons.on_click(lambda event: pressed[event.target.value]())
        self.kept = gui.add_html("")
        self.open = gui.add_html("")
        self.orientation = gui.add_dropdown("faces", (AUTO, *ORIENTATIONS))
        with gui.add_folder("Where each far end leans", expand_by_default=False):
            self._depth = {limb: gui.add_dropdown(spoken(limb), (AUTO, *WAYS)) for limb in LIMBS}
        gui.add_html(piece("retouch_help.html", {}))
        with gui.add_folder("Keys", expand_by_default=False):
            gui.add_html(piece("retouch_keys.html", {"keys": spoken_keys()}))
        with gui.add_folder("Hidden joints"):
            self._joint = gui.add_dropdown("joint", tuple(map(spoken, JOINT_NAMES)))
            self.hold = gui.add_checkbox("hold until changed", initial_value=False)
            gui.add_button("Let go of placed joints").on_click(lambda _: page.let_go())
        self._listen()

    def show(self, row: int, joint: int, notes: Notes) -> None:
        """Update the panel."""
        frame = int(self.take.frame[row])
        annotations = held(notes, frame)
        self._slider.value = frame
        self._joint.value = spoken(JOINT_NAMES[joint])
        self.orientation.value = annotations.orientation or AUTO
        for limb, chosen in self._depth.items():
            chosen.value = annotations.depth.get(limb, AUTO)
        self.open.content = questions(self.take, row, notes)

    def tell(self, text: str, well: bool) -> None:
        """The outcome of the last input."""
        self.kept.content = piece("retouch_kept.html", {"text": text, "well": well})

    def if_user(self, event: viser.GuiEvent[Any], act: Callable[..., None], *given: Any) -> None:
        """Only a browser's event is an input; our own changes raise events too."""
        if event.client is not None:
            act(*given)

    def turned(self) -> None:
        """The list of orientations was used."""
        self._page.face(self.orientation.value)

    def _listen(self) -> None:
        self._slider.on_update(lambda event: self.if_user(event, self._slid))
        self._joint.on_update(lambda event: self.if_user(event, self._picked))
        self.orientation.on_update(lambda event: self.if_user(event, self.turned))
        for limb, chosen in self._depth.items():
            chosen.on_update(lambda event, limb=limb: self.if_user(event, self._leaned, limb))

    def _slid(self) -> None:
        self._page.go_to_frame(int(self._slider.value))

    def _picked(self) -> None:
        self._page.pick(self._joint.options.index(self._joint.value))

    def _leaned(self, limb: str) -> None:
        self._page.lean(limb, self._depth[limb].value)
