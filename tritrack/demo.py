"""The main use on a synthetic person, for `make demo`."""

import tempfile
from pathlib import Path
from typing import Final

import msgspec
from rich.console import Console

from common.config.part_settings import PageSettings
from common.config.settings import Settings
from common.npz_file import Facts
from runtime.live.free_ports import free_settings
from runtime.live.session import live
from runtime.store.other_run import refuse_other, run_of, run_told
from synth.motion.motions import performance
from synth.person.people import person
from synth.picture.random_rig import rig_around
from synth.write import Filming, clip_name, write_clip, write_rig

PERFORMER_SEED: Final = 90_001
"""Seed of a person outside the training data: the packaged model knows persons 1200 to 1211."""
POSTURE: Final = "raise_right_lateral"
TAKE: Final = 1
SIZE: Final = (320, 240)
MOTION_S: Final = 14.0
"""Length of the demo, seconds: five performances, and the moment in which the fifth is reported."""


class DemoFailed(RuntimeError):
    """The demo ran with a wrong result; the text names it."""


def made_clip(folder: Path, cameras: int = 2) -> Path:
    """The demo's clip with its calibration, written into a folder."""
    rig, someone = rig_around(SIZE, cameras, PERFORMER_SEED), person(PERFORMER_SEED)
    clip = folder / clip_name(someone, POSTURE, TAKE)
    write_clip(
        clip,
        someone,
        performance(someone, POSTURE, TAKE, motion_s=MOTION_S),
        Filming(rig, room_seed=PERFORMER_SEED, seed=PERFORMER_SEED),
        TAKE,
    )
    write_rig(folder / "calibration.json", rig)
    return clip


def refuse_other_than_demo(out: Path) -> None:
    """Refuse to overwrite any run but a demo's, which can be repeated.

    Raises:
        OtherRun: When one would be.
    """
    clip = clip_name(person(PERFORMER_SEED), POSTURE, TAKE)
    before = run_told(out)
    if before is not None and {Path(film).parent.name for film in before.footage} != {clip}:
        refuse_other(out, run_of("demo", [clip]))


def run_demo(out: Path, page: bool, console: Console, wait: bool = True, cameras: int = 2) -> Facts:
    """Render a clip, run the whole system on it, and check the result.

    Args:
        out: The run folder.
        page: Whether the live page shows it.
        console: As for `live`.
        wait: Whether the clip waits until the page is opened.
        cameras: Number of cameras around the person.

    Raises:
        DemoFailed: When another posture was recognised than performed.
    """
    with tempfile.TemporaryDirectory(prefix="tritrack-demo-") as folder:
        console.print(f"making a person who performs {POSTURE} ...")
        clip = made_clip(Path(folder), cameras)
        settings = free_settings(Settings(clip=str(clip), pictures=True))
        port = settings.page.port if page else 0
        settings = msgspec.structs.replace(settings, page=PageSettings(port, wait))
        console.print(f"the bus: {settings.bus.endpoint}", highlight=False)
        facts = live(settings, out, console)
    if facts["posture"] != POSTURE:
        raise DemoFailed(f"performed {POSTURE}, named {facts['posture'] or 'nothing'}")
    return facts
