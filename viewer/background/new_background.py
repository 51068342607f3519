"""A new background during a run, from frames that show no person."""

from common.bus.control_messages import Answer, Command
from common.bus.inbox import Inbox
from common.bus.messages import CameraFault, ViewerNumber
from common.video.pictures import Image
from viewer.background.background import Background, learnt, lit, overlaid_opening
from viewer.background.empty_opening import is_still


class Learning:
    """Gathers frames on command, and learns the background from them."""

    def __init__(self, commands: Inbox[Command], viewer: ViewerNumber, due: int) -> None:
        """Subscribe to commands; nothing is gathered yet.

        Args:
            commands: Commands to the run.
            viewer: Number of the viewer.
            due: Number of frames that make a background.
        """
        self._commands, self._viewer, self._due = commands, viewer, due
        self._frames: list[Image] | None = None

    def step(self, picture: Image, fault: CameraFault) -> tuple[Background | None, Answer | None]:
        """Process a frame: the new background, once complete, and the outcome to report.

        Frames in which something moves, or that show no scene, give no background, and the old one
        stays.
        """
        if any(command.what == "background" for command in self._commands.drain()):
            self._frames = []
        if self._frames is None:
            return None, None
        if fault:
            self._frames = None
            return None, self._answer(
                False, f"its picture is {fault}: the background stays as it was"
            )
        self._frames.append(picture.copy())
        if len(self._frames) < self._due:
            return None, None
        frames, self._frames = lit(self._frames), None
        laid_over = overlaid_opening(frames)
        if not is_still(laid_over):
            return None, self._answer(False, "something moves: the background stays as it was")
        return learnt(laid_over, frames), self._answer(True, "it has a new background")

    def _answer(self, well: bool, text: str) -> Answer:
        return Answer(what="background", well=well, text=f"camera {self._viewer}: {text}")
