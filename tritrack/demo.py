"""The main use on synthetic people, for `make demo`."""

import tempfile
from pathlib import Path
from typing import Final, Literal

import msgspec
from rich.console import Console

from common.bus.messages import MOST_PEOPLE
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from common.npz_file import Facts
from runtime.live.free_ports import free_settings
from runtime.live.session import live
from runtime.store.other_run import refuse_other, run_of, run_told
from synth.motion.motions import OPENING_S, performance
from synth.person.people import person
from synth.picture.random_rig import rig_around
from synth.scene.scene_clips import SceneSet, scene_name, write_scenes
from synth.write import Filming, clip_name, write_clip, write_rig

PERFORMER_SEED: Final = 90_001
"""Seed of a person outside the training data: the packaged model knows persons 1200 to 1211."""
POSTURE: Final = "raise_right_lateral"
POSTURES: Final = (
    POSTURE,
    "squat",
    "swing_both_overhead_wave",
    "kick_right_forward",
    "raise_both_lateral",
)
"""Of several people, by person."""
TAKE: Final = 1
SIZE: Final = (320, 240)
MOTION_S: Final = 14.0
"""Length of the demo, seconds: five performances, and the moment in which the fifth is reported."""


class DemoFailed(RuntimeError):
    """The demo ran with a wrong result; the text names it."""


def made_clip(
    folder: Path, cameras: int = 2, size: tuple[int, int] = SIZE, motion_s: float = MOTION_S
) -> Path:
    """The demo's clip with its calibration, written into a folder."""
    rig, someone = rig_around(size, cameras, PERFORMER_SEED), person(PERFORMER_SEED)
    clip = folder / clip_name(someone, POSTURE, TAKE)
    write_clip(
        clip,
        someone,
        performance(someone, POSTURE, TAKE, motion_s=motion_s),
        Filming(rig, room_seed=PERFORMER_SEED, seed=PERFORMER_SEED),
        TAKE,
    )
    write_rig(folder / "calibration.json", rig)
    return clip


def made_scene(folder: Path, people: int, cameras: int) -> Path:
    """The demo's clip of several people, who perform different postures at the same time."""
    lasts_s = sum(OPENING_S) + MOTION_S
    postures = POSTURES[:people]
    wanted = SceneSet(people, lasts_s, 1, PERFORMER_SEED, cameras, postures=postures)
    (clip,) = write_scenes(folder, wanted, SIZE)
    return clip


def refuse_other_than_demo(out: Path) -> None:
    """Refuse to overwrite any run but a demo's, which can be repeated.

    Raises:
        OtherRun: When one would be.
    """
    clip = clip_name(person(PERFORMER_SEED), POSTURE, TAKE)
    scenes = (scene_name(people, PERFORMER_SEED, 1) for people in range(2, MOST_PEOPLE + 1))
    before = run_told(out)
    if before is None:
        return
    if {Path(film).parent.name for film in before.footage} not in (
        {one} for one in (clip, *scenes)
    ):
        refuse_other(out, run_of("demo", [clip]))


def run_demo(
    out: Path, page: bool, console: Console, wait: bool = True, cameras: int = 2, people: int = 1
) -> Facts:
    """Render a clip, run the whole system on it, and check the result.

    Args:
        out: The run folder.
        page: Whether the live page shows it.
        console: As for `live`.
        wait: Whether the clip waits until the page is opened.
        cameras: Number of cameras around them.
        people: Number of people; several are followed together, each with a posture of their own.

    Raises:
        DemoFailed: When other postures were recognised than performed.
    """
    performed = POSTURES[:people]
    with tempfile.TemporaryDirectory(prefix="tritrack-demo-") as folder:
        console.print(f"making {_who(people)} {' and '.join(performed)} ...", highlight=False)
        if people == 1:
            clip = made_clip(Path(folder), cameras)
        else:
            clip = made_scene(Path(folder), people, cameras)
        follows: Literal[1, "all"] = 1 if people == 1 else "all"
        wide, high = SIZE
        settings = free_settings(
            Settings(clip=str(clip), size=f"{wide}x{high}", pictures=True, people=follows)
        )
        port = settings.page.port if page else 0
        settings = msgspec.structs.replace(settings, page=PageSettings(port, wait))
        console.print(f"the bus: {settings.bus.endpoint}", highlight=False)
        facts = live(settings, out, console)
    named = sorted(facts["postures"].values()) if "postures" in facts else [facts["posture"]]
    if named != sorted(performed):
        told = " and ".join(filter(None, named)) or "nothing"
        raise DemoFailed(f"performed {' and '.join(performed)}, named {told}")
    return facts


def _who(people: int) -> str:
    return "a person who performs" if people == 1 else f"{people} people who perform"
