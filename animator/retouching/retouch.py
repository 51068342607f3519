"""The retouching page: a frame with its stick body, the lifted body from the side, and inputs."""

import threading
from collections.abc import Callable

import numpy as np

from animator.page.door import HOST
from animator.retouching.controls import AUTO, Controls
from animator.retouching.fitting import Fit, Fitting
from animator.retouching.keyboard import bind
from animator.retouching.player import Player
from animator.retouching.retouch_scene import Picture, RetouchScene
from animator.retouching.viser_door import close_server, open_server
from animator.take import Take, doubts_at, next_doubtful, with_notes
from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS
from common.notes.notes import Auto, Depth, Note, Notes, Orientation, held, noted, placed_once


class RetouchPage:
    """A page for a browser on this machine at `address`, until `close`.

    Args:
        take: The run.
        size: Width and height of the video.
        picture_of: The video's picture for a row of the run.
        notes: Earlier inputs.
        save: Saves the notes; returns a message for the user, and whether it succeeded.
        fit: Fits the run's video again.
        port: A free port of this machine.

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
        fit: Fit,
        port: int,
    ) -> None:
        self.take, self._picture_of, self._save = take, picture_of, save
        self.notes = notes
        self.fitted: Notes | None = None
        self._row = int(np.argmax(take.posed))
        self._joint = JOINT_NAMES.index("l_wrist")
        self._before: list[tuple[Notes, int]] = []  # the notes, and the row, before each input
        self._moved: tuple[int, int] | None = None
        self._player = Player(self._advance)
        self._lock = threading.RLock()
        self._server = open_server(port)
        first = picture_of(self._row)
        self._easel = RetouchScene(self._server, size, first, self.place, self.flip)
        self._controls = Controls(self._server.gui, take, self)
        self._fitting = Fitting(fit, self._fitted, self._controls.tell)
        bind(self._server.gui, self)
        self._show()

    @property
    def address(self) -> str:
        """Address of the page."""
        return f"http://{HOST}:{self._server.get_port()}"

    def close(self) -> None:
        """Take the page down and free the port."""
        self._player.stop()
        self._fitting.wait()
        close_server(self._server)

    def say(self, notes: Notes, moved: tuple[int, int] | None = None) -> None:
        """Process an input: it is kept and shown at once.

        Args:
            notes: All inputs, including this one.
            moved: Frame and joint, where a key moved one: successive presses are one input.
        """
        with self._lock:
            self._player.stop()
            if moved is None or moved != self._moved:
                self._before.append((self.notes, self._row))
            self.notes, self._moved = notes, moved
            self.keep()
            self._show()

    def undo(self) -> None:
        """Undo the last input, and show its frame."""
        with self._lock:
            if not self._before:
                self._controls.tell("nothing to undo", True)
                return
            self._player.stop()
            self.notes, self._row = self._before.pop()
            self._moved = None
            self.keep()
            self._show()

    def keep(self) -> None:
        """Save all inputs, and report the outcome."""
        with self._lock:
            self._controls.tell(*self._save(self.notes))

    def fit_again(self) -> None:
        """Fit the video again with all inputs; inputs made meanwhile wait for the next fit."""
        self._fitting.begin(self.notes)

    def go_to(self, row: int | None) -> None:
        """Show another row of the run; None: no open question is left there."""
        with self._lock:
            self._player.stop()
            if row is None:
                self._controls.tell("no other uncertain frame in this direction", True)
                return
            self._row = row
            self._show()

    def go_to_frame(self, frame: int) -> None:
        """Show the first row at or after a frame of the video."""
        self.go_to(min(int(np.searchsorted(self.take.frame, frame)), len(self.take.frame) - 1))

    def go(self, frames: int) -> None:
        """Show the row at an offset; at the ends of the run it stays there."""
        self.go_to(min(max(self._row + frames, 0), len(self.take.frame) - 1))

    def look(self, step: int) -> None:
        """Show the next or previous row with an open question."""
        self.go_to(next_doubtful(self.take, self._row, self.notes, step))

    def play(self) -> None:
        """Start or stop playing; at the end of the run from its beginning."""
        with self._lock:
            if not self._player.playing and self._row == len(self.take.frame) - 1:
                self.go_to(0)
        self._player.toggle()

    def choose(self, step: int) -> None:
        """Choose the joint at an offset in the list."""
        self.pick((self._joint + step) % len(JOINT_NAMES))

    def pick(self, joint: int) -> None:
        """Choose the joint that keys move."""
        with self._lock:
            self._joint = joint
            self._show()

    def place(
        self, joint: int, at_px: tuple[float, float], moved: tuple[int, int] | None = None
    ) -> None:
        """Put a joint at a place of the picture, in this frame alone unless the input shall
        hold."""
        with self._lock:
            frame, name = self._frame, JOINT_NAMES[joint]
            if self._controls.hold.value:
                self.say(noted(self.notes, Note(frame, joints_px={name: at_px})), moved)
            else:
                self.say(placed_once(self.notes, frame, name, at_px), moved)

    def nudge(self, across_px: float, down_px: float) -> None:
        """Move the chosen joint in the picture."""
        with self._lock:
            if not self.take.posed[self._row]:
                self._controls.tell("no person is seen here: no joint to move", True)
                return
            joints_px, _ = with_notes(self.take, self._row, held(self.notes, self._frame))
            column, row = joints_px[self._joint] + (across_px, down_px)
            at_px = (round(float(column), 1), round(float(row), 1))
            self.place(self._joint, at_px, (self._frame, self._joint))

    def flip_chosen(self) -> None:
        """Let the segment that ends at the chosen joint lean the other way."""
        ends = LIMB_ENDS[:, 1].tolist()
        if self._joint not in ends or not self.take.posed[self._row]:
            self._controls.tell("no segment ends there", True)
            return
        self.flip(ends.index(self._joint))

    def flip(self, limb: int) -> None:
        """Let a segment lean the other way than shown, from this frame on."""
        with self._lock:
            _, joints_m = with_notes(self.take, self._row, held(self.notes, self._frame))
            near, far = LIMB_ENDS[limb]
            other: Depth = "away" if joints_m[far, 2] > joints_m[near, 2] else "toward"
            self.say(noted(self.notes, Note(self._frame, depth={LIMBS[limb]: other})))

    def face(self, way: Orientation | Auto) -> None:
        """Set the person's orientation, from this frame on."""
        with self._lock:
            self.say(noted(self.notes, Note(self._frame, way)))

    def lean(self, limb: str, way: Depth | Auto) -> None:
        """Set a segment's lean, from this frame on."""
        with self._lock:
            self.say(noted(self.notes, Note(self._frame, depth={limb: way})))

    def let_go(self) -> None:
        """Give the joints placed here back to the program, from this frame on."""
        with self._lock:
            placed = held(self.notes, self._frame).joints_px
            self.say(noted(self.notes, Note(self._frame, joints_px=dict.fromkeys(placed, AUTO))))

    def _fitted(self, take: Take, notes: Notes) -> None:
        with self._lock:
            self._player.stop()
            self.take, self.fitted = take, notes
            self._row = min(self._row, len(take.frame) - 1)
            self._controls.take = take
            self._show()
            self._controls.tell("fitted again with what you said; the run is the new one", True)

    @property
    def _frame(self) -> int:
        return int(self.take.frame[self._row])

    def _advance(self) -> bool:
        """The player's next row."""
        with self._lock:
            if not self._player.playing or self._row + 1 >= len(self.take.frame):
                return False
            self._row += 1
            self._show()
            return True

    def _show(self) -> None:
        annotations = held(self.notes, self._frame)
        with self._server.atomic():
            self._controls.show(self._row, self._joint, self.notes)
            posed = bool(self.take.posed[self._row])
            self._easel.show(self._picture_of(self._row), posed)
            if posed:
                joints_px, joints_m = with_notes(self.take, self._row, annotations)
                doubts = doubts_at(self.take, self._row, self.notes)
                doubtful = {doubt.name for doubt in doubts if doubt.kind == "depth"}
                self._easel.show_stick(joints_px, set(annotations.joints_px), self._joint)
                self._easel.show_body(joints_m, doubtful)
