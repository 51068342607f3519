"""The cameras of a program's own loop: names, calibration, and working pictures."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import msgspec

from common.bus.messages import MOST_VIEWS, ViewerNumber, place_in_rig
from common.config.part_settings import SettingsError
from common.config.picture_size import working_size
from common.rig.absurd_rig import refuse_absurd
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError, check_rig, fitted, load_rig
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.upright_views import filed_rig, upright_views

Size = tuple[int, int]
"""Width and height, pixels."""


class Cameras(NamedTuple):
    """The cameras that give images."""

    numbers: dict[str, ViewerNumber]
    """Viewer number of each camera, by name, in the order of the images."""
    rig: Rig | None
    """Their calibration, for pictures of any size."""
    where: str
    """Its name in messages."""


def cameras_of(calibration: str | Path | Rig | None, names: Sequence[str]) -> Cameras:
    """The cameras of a calibration, or the named ones among them.

    Raises:
        CalibrationError: When the calibration cannot be used.
        SettingsError: When there are two without a calibration, or one is named twice.
    """
    if isinstance(names, str):
        raise SettingsError(f"cameras is a list of names: [{names!r}]")
    twice = [name for place, name in enumerate(names) if name in names[:place]]
    if twice:
        raise SettingsError(f"cameras names {twice[0]!r} twice")
    if calibration is None:
        return Cameras(_uncalibrated(names), None, "")
    if isinstance(calibration, Rig):
        where = "the calibration"
        check_rig(calibration, where)
        return Cameras(_calibrated(calibration, names, where), calibration, where)
    rig = load_rig(Path(calibration))
    return Cameras(_calibrated(rig, names, str(calibration)), rig, str(calibration))


def clip_of(
    cameras: Cameras, sizes: Mapping[ViewerNumber, Size], bound: Size, rate_hz: float
) -> Clip:
    """The images' facts in the form of a clip: views and rig at the working size.

    Args:
        cameras: Source of the images.
        sizes: Size of each camera's images.
        bound: Bound of the working pictures.
        rate_hz: Images per second of each camera.

    Raises:
        CalibrationError: When the calibration belongs to other pictures, or no cameras stand so.
    """
    views = tuple(
        ClipView(n, name, sizes[n], working_size(sizes[n], bound), rate_hz, 0, name=name)
        for name, n in cameras.numbers.items()
    )
    rig, where = cameras.rig, cameras.where
    if rig is not None:
        seen = [fitted(fitted(rig, view.source_size, where), view.size, where) for view in views]
        places = [_place(rig, view.number) for view in views]
        own = tuple(one.cameras[place] for one, place in zip(seen, places, strict=True))
        rig, views = upright_views(msgspec.structs.replace(seen[0], cameras=own), views)
    clip = Clip("images", views, 1, rig, Meta())
    filed = filed_rig(clip)
    if filed is not None:
        refuse_absurd(filed, where)
    return clip


def _place(rig: Rig, number: ViewerNumber) -> int:
    """Index of a viewer's camera in a calibration."""
    return 0 if len(rig.cameras) == 1 else place_in_rig(number)


def _uncalibrated(names: Sequence[str]) -> dict[str, ViewerNumber]:
    if len(names) > 1:
        raise SettingsError(
            "several cameras need a calibration: make one (tritrack calibrate person), or track a "
            "recorded clip (tritrack track), which can do without"
        )
    return dict.fromkeys(names or ("cam1",), 1)


def _calibrated(rig: Rig, wanted: Sequence[str], where: str) -> dict[str, ViewerNumber]:
    names = [camera.name for camera in rig.cameras]
    missing = [name for name in wanted if name not in names]
    if missing:
        raise CalibrationError(f"{where} has no camera {missing[0]!r}; it has {', '.join(names)}")
    if len(names) > MOST_VIEWS:
        raise CalibrationError(
            f"{where} has {len(names)} cameras: keep {MOST_VIEWS} at most (tritrack calibrate "
            "import --camera)"
        )
    return {name: names.index(name) + 1 for name in wanted or names}
