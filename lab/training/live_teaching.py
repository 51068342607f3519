"""Teaching a posture before running cameras: takes are counted in, judged, and repeated."""

from pathlib import Path
from typing import Final

import msgspec
import numpy as np
from rich.console import Console

from common.bus.messages import Body
from common.config.settings import Settings
from common.npz_file import Facts
from lab.posture_models.lesson import LEAST_TAKES, Lesson, taught
from lab.training import coach
from lab.training.coach import STAND, Said, State, look_at
from lab.training.teaching import kept, model_to_teach
from lab.training.training import Plan, TrainingError
from recognizer import model_rate
from recognizer.__main__ import MOVING
from recognizer.codebook import LearningError
from recognizer.features import Rows, rows
from recognizer.postures import PostureModel
from runtime.live.launch import Heard
from runtime.live.session import live
from runtime.store.pose_arrays import poses

MOST_TAKES: Final = 9
"""Largest number of takes: a person without three equal ones by then does not mean one posture."""


class Teaching:
    """Receives a run's bodies, passes them to the coach, and trains on the takes; True when
    trained."""

    def __init__(self, posture: str, known: PostureModel, console: Console, count_s: float) -> None:
        """Nothing seen yet."""
        self._posture, self._known, self._console = posture, known, console
        self._state = State(posture, count_s)
        self._last_s = -np.inf
        self._rate = model_rate.State()
        self._takes: list[Rows] = []
        self._done = 0
        self.lesson: Lesson | None = None
        self._say(f"teaching {posture}: {STAND}")

    def __call__(self, heard: Heard) -> bool:
        """Process the new bodies."""
        new = heard.bodies.newest(lambda body: body.captured_s > self._last_s)
        for body in new:
            self._last_s = body.captured_s
            if not self._over():
                self._look(body)
        return self._over()

    def _over(self) -> bool:
        return self.lesson is not None or self._done >= MOST_TAKES

    def _look(self, body: Body) -> None:
        arrays = poses([body])
        (row,) = rows(arrays["angles_deg"], arrays["joints_m"])
        self._rate, due = model_rate.step(self._rate, body.captured_s)
        for _ in range(due):
            self._state, said = coach.step(self._state, look_at(body, row, MOVING))
            self._heed(said)

    def _heed(self, said: Said) -> None:
        if said.word:
            self._say(said.word)
        if said.take is not None:
            self._done += 1
            self._takes.append(said.take)
            self._judge()

    def _judge(self) -> None:
        """Train on three takes that agree; a take that does not is reported and dropped."""
        if len(self._takes) < LEAST_TAKES:
            self._say(f"take {len(self._takes)} of {LEAST_TAKES}; {STAND}")
            return
        try:
            lesson = taught(self._known, self._posture, self._takes, ["live"])
        except LearningError as error:
            self._say(f"{error}; all over again")
            self._takes = []
            return
        if not lesson.mistaken:
            self.lesson = lesson
            self._say("three takes that agree: learnt")
            return
        for i in lesson.mistaken:
            self._say(f"take {i + 1} looks like {lesson.takes[i].rival}: once more")
        self._takes = [take for i, take in enumerate(self._takes) if i not in lesson.mistaken]

    def _say(self, text: str) -> None:
        """Report in words and with the terminal's bell: a person before cameras reads no screen."""
        self._console.bell()
        self._console.print(text, highlight=False)


def teach_live(
    posture: str, settings: Settings, out: Path, plan: Plan, console: Console, count_s: float = 3.0
) -> Facts:
    """Run cameras until three takes of a posture agree, and write the model.

    Args:
        posture: Its name.
        settings: The run's: cameras, or a recording that plays as if live.
        out: The model file; the run's folder is beside it, named after the posture.
        plan: The model to extend.
        console: Shows the instructions.
        count_s: Length of the countdown before each take.

    Raises:
        TrainingError: When the name is invalid, `out` has postures that would be lost, or the run
            ends before three takes agree.
        ModelError: When a model cannot be read or written.
        LiveRefused and the other errors of `live`: When the run cannot begin, or fails.
    """
    known = model_to_teach(posture, plan, out)
    teaching = Teaching(posture, known, console, count_s)
    settings = msgspec.structs.replace(settings, mode=known.card.recognizer)
    run = out.with_suffix("").with_name(f"{out.stem}_{posture}")
    live(settings, run, console, posture, tell=teaching)
    if teaching.lesson is None:
        raise TrainingError(
            f"the run ended before {LEAST_TAKES} takes of {posture} agreed; what was seen is in"
            f" {run}: try again, the same motion each time"
        )
    names = [f"take {n}" for n in range(1, len(teaching.lesson.takes) + 1)]
    return {**kept(teaching.lesson, posture, names, out, plan), "run": str(run)}
