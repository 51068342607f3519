"""The health of a run: its faults, and their cures."""

from collections.abc import Sequence
from typing import Final

from common.bus.control_messages import Pulse
from common.bus.message_codec import TOPICS
from common.bus.rate import silent
from runtime.outside.run_figures import PartFigures, RunFigures

OLD_S: Final = 2.0
"""Age of the newest body, seconds, from which on no view works any more. This does not detect
the loss of a single view; its viewer does."""
READ: Final = "read log.txt in the run folder"


def ailments(figures: RunFigures, needed: Sequence[str], now_s: float) -> list[str]:
    """The faults of a run, one line each; none where all is well.

    Args:
        figures: The run's figures.
        needed: Names of the processes that it requires.
        now_s: By the room's clock.
    """
    parts = [(name, figures.parts.get(name, PartFigures())) for name in needed]
    found = [f"{name}: {told}" for name, part in parts if (told := _ailment(part, now_s))]
    return [*found, *([] if found else _stillness(figures, now_s))]


def _ailment(part: PartFigures, now_s: float) -> str:
    """The fault of a process, or ""."""
    if part.pulse is None or part.heard_s is None:
        return f"not heard yet; a first start compiles for up to a minute: wait, then {READ}"
    if part.pulse.state == "ended":
        return ""
    if part.pulse.state == "starting":
        return f"it starts; if that takes more than a minute, {READ}"
    if not part.there:
        return (
            "it is gone (it was killed, or its link is cut); it is started again within seconds: "
            f"if not, {READ} and start the run anew"
        )
    if part.pulse.state == "running" and silent(TOPICS[Pulse].hz, part.heard_s, now_s):
        return (
            f"it has said nothing for {now_s - part.heard_s:.0f} s and hangs; it is killed and "
            f"started again: if not, {READ} and start the run anew"
        )
    return ""


def _stillness(figures: RunFigures, now_s: float) -> list[str]:
    """Whether there are no more bodies although all processes are alive."""
    integrator = figures.parts.get("integrator", PartFigures()).pulse
    if figures.body_s is None or integrator is None or integrator.state != "running":
        return []
    old_s = now_s - figures.body_s
    if old_s <= OLD_S:
        return []
    return [f"no body for {old_s:.0f} s: look whether the cameras give pictures, and {READ}"]
