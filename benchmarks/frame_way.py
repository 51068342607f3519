"""The files of ours that one frame passes on its way from two cameras to a posture's name."""

import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, NamedTuple
from unittest.mock import patch

from numba.core.dispatcher import Dispatcher
from source_map import file_of

from common.config.settings import Settings
from integrator import merge
from recognizer import __main__ as recognizer
from viewer import track

PERFORMER_SEED = 90_001
"""Whom the clip shows: a person of no training set."""
POSTURE = "raise_right_lateral"
OFFLINE = ("runtime.offline.lockstep", "tritrack.offline.lockstep", "tritrack.offline")
"""Where the lock-step run lies now, and where it lay in versions 0.2.0 and 0.1.0."""


class Way(NamedTuple):
    """What the instants of a clip passed."""

    each: list[set[Path]]
    """Files of every instant, from the checkout's top."""

    @property
    def all(self) -> set[Path]:
        """Files that any instant passed."""
        return set().union(*self.each)


class _Calls:
    """Notes the code of every function that runs within the steps that it was given to."""

    def __init__(self) -> None:
        """Nothing called yet."""
        self.codes: set[CodeType] = set()

    def noted(self, step: Callable[..., Any]) -> Callable[..., Any]:
        """The same step, its calls noted; numba reports those of compiled functions too."""

        def inner(*given: Any) -> Any:
            sys.setprofile(self._note)
            try:
                return step(*given)
            finally:
                sys.setprofile(None)

        return inner

    def _note(self, frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            self.codes.add(frame.f_code)

    def taken(self) -> set[CodeType]:
        """What was called since the last time."""
        codes, self.codes = self.codes, set()
        return codes


def way(root: Path) -> Way:
    """Follow a made-up clip in lock-step, default mode and two views.

    A file counts for an instant where one of its functions runs between the pictures and the
    posture's name: in the steps of both viewers, the integrator or the recognizer, all that these
    call included. Compiled functions that compiled functions call run unseen: they are found by
    the names that their callers use.
    """
    calls = _Calls()
    settings = Settings()
    naming = recognizer.init(recognizer.model_of(settings), settings.recognizer.window_frames)
    named = calls.noted(recognizer.step)
    each: list[set[CodeType]] = []

    def watch(_frames: object, _reports: object, bodies: Any) -> None:
        nonlocal naming
        body = bodies[0] if isinstance(bodies, tuple) else bodies  # older versions gave one
        naming, _ = named(naming, body)
        each.append(calls.taken())

    with ExitStack() as doors:
        for module in (track, merge):
            doors.enter_context(patch.object(module, "step", calls.noted(module.step)))
        _follow(root, watch)
    compiled = _compiled()
    return Way([_files(root, codes, compiled) for codes in each])


def _follow(root: Path, watch: Callable[..., None]) -> None:
    offline = import_module(next(module for module in OFFLINE if file_of(root, module)))
    with tempfile.TemporaryDirectory(prefix="tritrack-way-") as folder, offline.Decoders() as doors:
        # by the command, which is the same in every version
        asked = ("--posture", POSTURE, "--seed", str(PERFORMER_SEED), "--size", "160x120")
        command = (sys.executable, "-m", "tritrack", "synth", "--out", folder, *asked)
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        clip = next(Path(folder).glob(f"*{POSTURE}"))
        older = not isinstance(getattr(offline, "Watch", None), type)  # which takes the function
        seen = watch if older else offline.Watch(watch)
        offline.track_clip(Settings(clip=str(clip)), doors, (1, 2), seen)


def _compiled() -> dict[CodeType, Dispatcher]:
    """Every compiled function that is loaded, by its code."""
    values = [
        value
        for module in [*sys.modules.values()]
        for value in [*getattr(module, "__dict__", {}).values()]
    ]
    return {each.py_func.__code__: each for each in values if isinstance(each, Dispatcher)}


def _files(root: Path, codes: set[CodeType], compiled: dict[CodeType, Dispatcher]) -> set[Path]:
    called, ahead = set(codes), [code for code in codes if code in compiled]
    while ahead:
        function = compiled[ahead.pop()].py_func
        known = (function.__globals__.get(name) for name in function.__code__.co_names)
        new = {each.py_func.__code__ for each in known if isinstance(each, Dispatcher)} - called
        called |= new
        ahead += new
    paths = {Path(code.co_filename) for code in called}
    ours = {path.relative_to(root) for path in paths if path.is_relative_to(root)}
    return {path for path in ours if path.parts[0] != ".venv"}
