"""A recorded run on the live page, as a player: pause, speed, any moment, angles over time."""

from collections import defaultdict
from itertools import groupby
from pathlib import Path
from typing import Final

from rich.console import Console

from animator.page.live import LivePage
from animator.scene import snapshot_of
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
    """Send a page all instants of a recording, each with its bodies, silhouettes and postures;
    returns their number."""
    rigs: dict[int, Rig | None] = {told.calibration: told.rig for told in recording.cameras}
    made_of = _reports(recording)
    postures = {(posture.captured_s, posture.person): posture for posture in recording.postures}
    calibration, shown, performed = -1, 0, dict[int, str]()
    for at_s, together in groupby(recording.bodies, lambda body: body.captured_s):
        bodies = sorted(together, key=lambda body: body.person)
        rig = rigs.get(bodies[0].calibration, recording.head.rig)
        if rig is not None and calibration != bodies[0].calibration:
            calibration = bodies[0].calibration
            page.set_rig(rig)
        at = {body.person: (at_s, body.person) for body in bodies}
        now = {person: postures[key] for person, key in at.items() if key in postures}
        ended = [posture for posture in now.values() if posture.event]
        performed.update((one.person, one.event.name) for one in ended if one.event)
        page.show(snapshot_of(bodies, now, performed, made_of[at_s]), ended)
        shown += 1
    return shown


def _reports(recording: Recording) -> defaultdict[float, dict[int, View]]:
    """By the time of an instant: the reports that its bodies were made of, by viewer."""
    found = defaultdict[float, dict[int, View]](dict)
    for bodies, instant in instants(recording):
        found[bodies[0].captured_s].update((view.viewer, view) for view in instant.views if view)
    return found
