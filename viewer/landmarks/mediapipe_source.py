"""MediaPipe as the source of a view's landmarks: a child process that looks at every frame."""

import logging
import time
from importlib.util import find_spec
from typing import Final, Self

from common.body.observation import Landmarks
from common.config.part_settings import SettingsError
from common.config.picture_size import size_within
from common.platform.platform import Broken, Child
from common.platform.platforms import platform
from common.video.clip_facts import ClipView
from common.video.pictures import Decoded, Size
from viewer.landmarks.mediapipe_joints import landmarks_of
from viewer.landmarks.mediapipe_protocol import BYTES, POINTS, REFUSED, Answer, answer_of

LOOKED_AT: Final = (640, 480)
"""Bound of the picture that it is shown."""
START_S: Final = 60.0
"""How long it may take to load its model: it takes 2 on an idle machine."""
STALL_S: Final = 10.0
"""A child that says nothing of a frame for so long is stuck."""
INSTALL: Final = (
    "pip install --no-deps mediapipe==0.10.21 && "
    "pip install 'protobuf>=4.25.3,<5' absl-py attrs flatbuffers matplotlib"
)
"""As tried: it asks for numpy < 2 and another OpenCV, but runs with ours."""

log = logging.getLogger(__name__)


def refuse_where_missing() -> None:
    """Say how to install it.

    Raises:
        SettingsError: When there is no MediaPipe.
    """
    if find_spec("mediapipe") is None:
        raise SettingsError(f"landmarks = 'mediapipe' needs MediaPipe: {INSTALL}")


class MediaPipe:
    """Asks a child for each frame of one view; without it the run goes on, and that is reported
    once.

    The child starts with this, and ends with it, with the viewer, or when it breaks.
    """

    def __init__(self, view: ClipView, stall_s: float = STALL_S) -> None:
        """Start the child; see `ready`.

        Raises:
            SettingsError: When MediaPipe is not installed.
        """
        refuse_where_missing()
        self.odd: tuple[str, ...] = ()
        self._view, self._stall_s = view, stall_s
        self._size = size_within(view.upright_source, LOOKED_AT)
        self._asked_s: float | None = None
        """When the child was asked what it has not answered yet; None: it has answered all."""
        module = f"{__package__}.mediapipe_child"
        self._child: Child | None = platform().child(module, START_S, self._size)

    def __enter__(self) -> Self:
        """Already started."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the child."""
        if self._child is not None:
            self._child.close()
            self._child = None

    @property
    def large(self) -> Size | None:
        """Size of the picture that it is shown; None: the working picture."""
        return None if self._size == self._view.size else self._size

    def ready(self) -> None:
        """Wait until it can look.

        Raises:
            SettingsError: When it cannot; the text says why, and how it is installed.
        """
        assert self._child is not None
        try:
            answer = _read(self._child)
        except Broken as error:
            raise SettingsError(f"MediaPipe does not start ({error}): {INSTALL}") from error
        if answer.kind == REFUSED:
            raise SettingsError(f"MediaPipe does not work here ({answer.text}): {INSTALL}")

    def people(self, decoded: Decoded, wait_s: float) -> tuple[Landmarks, ...]:
        """Whom MediaPipe sees in a frame, one or no person; see `OutsideSource`."""
        if self._child is None:
            return ()
        try:
            answer = self._answer(self._child, decoded, wait_s)
        except Broken as error:
            self._child.close()
            self._child = None
            self._tell(f"MediaPipe is gone ({error}): camera {self._view.number} has no landmarks")
            return ()
        if answer is None:
            self._tell(
                f"MediaPipe is too slow for camera {self._view.number}: frames that it has not "
                "seen in time have no landmarks"
            )
            return ()
        return self._people(answer)

    def _answer(self, child: Child, decoded: Decoded, wait_s: float) -> Answer | None:
        """What the child says of a frame; None when it does not say so in time."""
        if not self._is_free(child):
            return None
        assert child.picture is not None
        child.picture[:] = decoded.picture if decoded.large is None else decoded.large
        child.ask(str(decoded.index).encode())
        self._asked_s = time.monotonic()
        return self._next(child, min(wait_s, self._stall_s))

    def _is_free(self, child: Child) -> bool:
        """Whether nothing is asked of the child any more; an answer that came late is let go."""
        return self._asked_s is None or self._next(child, 0.0) is not None

    def _next(self, child: Child, wait_s: float) -> Answer | None:
        """Its answer; None when that does not come in time, though it may come yet."""
        assert self._asked_s is not None
        if child.answers_within(wait_s):
            self._asked_s = None
            return _read(child)
        if time.monotonic() - self._asked_s >= self._stall_s:
            raise Broken(f"it gave nothing for {self._stall_s:g} s")
        return None

    def _people(self, answer: Answer) -> tuple[Landmarks, ...]:
        if answer.kind != POINTS:
            return ()
        return (landmarks_of(answer.points, self._size, self._view.size),)

    def _tell(self, text: str) -> None:
        if text not in self.odd:
            log.warning(text)
            self.odd = (*self.odd, text)


def _read(child: Child) -> Answer:
    answer = bytearray(BYTES)
    child.read_into(memoryview(answer))
    return answer_of(bytes(answer))
