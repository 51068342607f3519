"""Clips of synthetic people."""

from pathlib import Path

from rich.console import Console

from common.atomic_file import unwritten
from common.config.part_settings import SettingsError
from common.config.picture_size import size_of
from runtime.terminal import bar
from synth.motion.idling import RETURNS
from synth.motion.motions import LASTS_S, POSTURES
from synth.scene.scene_clips import SceneSet, write_scenes
from synth.write import ClipSet, SynthError, write_set


def make_clips(
    out: Path,
    wanted: ClipSet | SceneSet,
    size: str,
    console: Console,
) -> list[Path]:
    """Write clips or scenes with ground truth, with a progress bar; returns their folders.

    Raises:
        SettingsError: When the size or a posture's name is invalid, or free motion is requested as
            a posture.
        SynthError: When a clip cannot be written: no space, no permission.
    """
    if isinstance(wanted, SceneSet):
        _refuse_in_scene(wanted.postures)
    else:
        _refuse_postures(wanted.motion, wanted.postures)
        wanted = wanted._replace(postures=wanted.postures or POSTURES)
    try:
        width_height = size_of(size)
    except ValueError as error:
        raise SettingsError(str(error)) from error
    try:
        with bar(console) as progress:
            task = progress.add_task("rendering", total=None)

            def tell(done: int, due: int) -> None:
                progress.update(task, completed=done, total=due)

            if isinstance(wanted, SceneSet):
                return write_scenes(out, wanted, width_height, tell)
            return write_set(out, wanted, width_height, tell)
    except OSError as error:
        raise SynthError(unwritten(out, error, "name another --out")) from error


def _refuse_in_scene(postures: tuple[str, ...]) -> None:
    _refuse_unknown(postures)
    away = [name for name in postures if name in RETURNS]
    if away:
        raise SettingsError(
            f"{away[0]} leads away, and people of a scene perform at their place: name another"
        )


def _refuse_unknown(postures: tuple[str, ...]) -> None:
    unknown = [name for name in postures if name not in POSTURES]
    if unknown:
        raise SettingsError(f"unknown posture {unknown[0]!r}; known are {', '.join(POSTURES)}")


def _refuse_postures(motion: str, postures: tuple[str, ...]) -> None:
    _refuse_unknown(postures)
    if motion in LASTS_S and postures:
        raise SettingsError(
            f"no posture belongs to this motion: leave --posture or --motion {motion} out"
        )
