"""A recorded run on the live page, as a player: pause, speed, any moment, angles over time."""

from pathlib import Path
from typing import Final

from rich.console import Console

from animator.page.live import LivePage
from animator.scene import Snapshot
from common.bus.instant import Instant
from common.bus.messages import View
from common.bus.process import ProcessContext, process
from common.npz_file import Facts
from common.rig.camera import Rig
from common.video.clip_sources import camera_words
from runtime.store.past_run import open_run
from runtime.store.recording import Recording, read_recording
from tritrack.replaying import instants

MOST_BYTES: Final = 160_000_000
"""Upper bound of the kept frames, bytes: some ten minutes, as many as a browser keeps."""


def replay_on_page(folder: Path, port: int, console: Console) -> Facts:
    """Show a recorded run on a page of this machine, until Ctrl-C.

    Args:
        folder: The run's folder.
        port: The page's port.
        console: Shows the page's address.

    Raises:
        RecordingError, PastRunError: When there is no recording, or no run.
        PageError: When the port is taken or not allowed.
    """
    recording, summary = read_recording(folder), open_run(folder).summary
    with process("replay", ProcessContext()) as stop:
        words = camera_words(recording.head.settings)
        page = LivePage(
            recording.head.name, port, commands=False, cameras=words, most_bytes=MOST_BYTES
        )
        try:
            console.print(f"the page is at {page.address}; Ctrl-C ends it", highlight=False)
            shown = show(page, recording)
            page.end({**summary, "out": str(folder)})
            stop.wait()
        finally:
            page.close()
    return {"clip": recording.head.name, "shown": shown}


def show(page: LivePage, recording: Recording) -> int:
    """Send a page all bodies of a recording, each with its silhouettes and its posture; returns
    their number."""
    rigs: dict[int, Rig | None] = {told.calibration: told.rig for told in recording.cameras}
    made_of = {body.captured_s: instant for body, instant in instants(recording)}
    postures = {posture.captured_s: posture for posture in recording.postures}
    calibration, performed = -1, ""
    for body in recording.bodies:
        rig = rigs.get(body.calibration, recording.head.rig)
        if rig is not None and calibration != body.calibration:
            calibration = body.calibration
            page.set_rig(rig)
        posture = postures.get(body.captured_s)
        event = () if posture is None or posture.event is None else (posture.event,)
        performed = event[-1].name if event else performed
        seen = _reports(made_of.get(body.captured_s))
        page.show(Snapshot(body, seen, {}, posture, performed), event)
    return len(recording.bodies)


def _reports(instant: Instant | None) -> dict[int, View]:
    views = () if instant is None else instant.views
    return {report.viewer: report for report in views if report}
