"""The retouching page: a frame with its stick, the lifted body from the side, and what to say."""

import threading
from collections.abc import Callable
from typing import Any, Final

import numpy as np
import viser

from animator.page.door import HOST
from animator.page.easel import Easel, Picture
from animator.page.panel import ACCENT, piece
from animator.page.viser_door import close_server, open_server
from animator.take import Take, doubts_at, next_doubtful, with_notes
from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS
from common.notes.notes import ORIENTATIONS, WAYS, Depth, Note, Notes, held, noted, placed_once

PANEL_PX: Final = 340
AUTO: Final = "auto"


class RetouchPage:
    """What a browser on this machine sees at `address`, until `close`.

    Args:
        take: The run.
        size: Width and height of the video.
        picture_of: The video's picture of a row of the run.
        notes: What was said before.
        save: Keeps the notes; answers what to tell the user, and whether it went well.
        port: Of this machine, free.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """

    def __init__(
        self,
        take: Take,
        size: tuple[int, int],
        picture_of: Callable[[int], Picture],
        notes: Notes,
        save: Callable[[Notes], tuple[str, bool]],
        port: int,
    ) -> None:
        self._take, self._picture_of, self._save = take, picture_of, save
        self.notes = notes
        self._row = int(np.argmax(take.posed))
        self._lock = threading.RLock()
        self._server = open_server(port)
        first = picture_of(self._row)
        self._easel = Easel(self._server, size, first, self.place, self.flip)
        self._build_panel()
        self._show()

    @property
    def address(self) -> str:
        """Where a browser finds the page."""
        return f"http://{HOST}:{self._server.get_port()}"

    def close(self) -> None:
        """Take the page down and free the port."""
        close_server(self._server)

    def say(self, notes: Notes) -> None:
        """Take the user's word: it is kept at once and shown."""
        with self._lock:
            self.notes = notes
            text, well = self._save(notes)
            self._tell(text, well)
            self._show()

    def go_to(self, row: int | None) -> None:
        """Show another row of the run; None: nothing is left to look at there."""
        with self._lock:
            if row is None:
                self._tell("no other uncertain frame in this direction", True)
                return
            self._row = row
            self._show()

    def place(self, joint: int, at_px: tuple[float, float]) -> None:
        """Put a joint at a place of the picture, in this frame alone unless it shall hold."""
        with self._lock:
            frame, name = self._frame, JOINT_NAMES[joint]
            if self._hold.value:
                self.say(noted(self.notes, Note(frame, joints_px={name: at_px})))
            else:
                self.say(placed_once(self.notes, frame, name, at_px))

    def flip(self, limb: int) -> None:
        """Let a segment lean the other way than it is shown, from this frame on."""
        with self._lock:
            _, joints_m = with_notes(self._take, self._row, held(self.notes, self._frame))
            near, far = LIMB_ENDS[limb]
            other: Depth = "away" if joints_m[far, 2] > joints_m[near, 2] else "toward"
            self.say(noted(self.notes, Note(self._frame, depth={LIMBS[limb]: other})))

    @property
    def _frame(self) -> int:
        return int(self._take.frame[self._row])

    def _tell(self, text: str, well: bool) -> None:
        self._kept.content = piece("retouch_kept.html", {"text": text, "well": well})

    def _build_panel(self) -> None:
        gui = self._server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, brand_color=ACCENT)
        gui.main_panel.dock_right()
        gui.main_panel.set_width(PANEL_PX)
        first, last = int(self._take.frame[0]), int(self._take.frame[-1])
        self._slider = gui.add_slider(
            "frame", min=first, max=max(first + 1, last), step=1, initial_value=self._frame
        )
        gui.add_button("Next uncertain frame").on_click(lambda _: self._look(1))
        gui.add_button("Previous uncertain frame").on_click(lambda _: self._look(-1))
        self._open = gui.add_html("")
        self._orientation = gui.add_dropdown("faces", (AUTO, *ORIENTATIONS))
        with gui.add_folder("Where each far end leans", expand_by_default=False):
            self._depth = {limb: gui.add_dropdown(_spoken(limb), (AUTO, *WAYS)) for limb in LIMBS}
        gui.add_html(piece("retouch_help.html", {}))
        with gui.add_folder("Hidden joints"):
            self._hold = gui.add_checkbox("hold until changed", initial_value=False)
            gui.add_button("Let go of placed joints").on_click(lambda _: self._let_go())
        self._kept = gui.add_html("")
        self._slider.on_update(lambda event: self._if_user(event, self._slid))
        self._orientation.on_update(lambda event: self._if_user(event, self._turned))
        for limb, chosen in self._depth.items():
            chosen.on_update(lambda event, limb=limb: self._if_user(event, self._leaned, limb))

    def _if_user(self, event: viser.GuiEvent[Any], act: Callable[..., None], *given: Any) -> None:
        """Only what a browser said is an input; what we set ourselves comes back here too."""
        if event.client is not None:
            act(*given)

    def _look(self, step: int) -> None:
        self.go_to(next_doubtful(self._take, self._row, self.notes, step))

    def _slid(self) -> None:
        row = int(np.searchsorted(self._take.frame, self._slider.value))
        self.go_to(min(row, len(self._take.frame) - 1))

    def _turned(self) -> None:
        with self._lock:
            self.say(noted(self.notes, Note(self._frame, self._orientation.value)))

    def _leaned(self, limb: str) -> None:
        with self._lock:
            self.say(noted(self.notes, Note(self._frame, depth={limb: self._depth[limb].value})))

    def _let_go(self) -> None:
        with self._lock:
            placed = held(self.notes, self._frame).joints_px
            self.say(noted(self.notes, Note(self._frame, joints_px=dict.fromkeys(placed, AUTO))))

    def _show(self) -> None:
        annotations = held(self.notes, self._frame)
        with self._server.atomic():
            self._slider.value = self._frame
            self._orientation.value = annotations.orientation or AUTO
            for limb, chosen in self._depth.items():
                chosen.value = annotations.depth.get(limb, AUTO)
            self._open.content = self._questions()
            posed = bool(self._take.posed[self._row])
            self._easel.show(self._picture_of(self._row), posed)
            if posed:
                joints_px, joints_m = with_notes(self._take, self._row, annotations)
                doubts = doubts_at(self._take, self._row, self.notes)
                doubtful = {doubt.name for doubt in doubts if doubt.kind == "depth"}
                self._easel.show_stick(joints_px, set(annotations.joints_px))
                self._easel.show_body(joints_m, doubtful)

    def _questions(self) -> str:
        """The frame, what was decided in it, and what it leaves open."""
        doubts = doubts_at(self._take, self._row, self.notes)
        given = {
            "frame": self._frame,
            "posed": bool(self._take.posed[self._row]),
            "facing": _spoken(str(self._take.orientation[self._row])),
            "confidence": float(self._take.orientation_confidence[self._row]),
            "doubts": [(doubt.kind, _spoken(doubt.name), doubt.confidence) for doubt in doubts],
        }
        return piece("retouch_questions.html", given)


def _spoken(name: str) -> str:
    """A name of the files as one says it: forward_left, l_upper_arm."""
    sides = {"l": "left", "r": "right"}
    first, *others = name.split("_")
    return " ".join([sides.get(first, first), *others])
