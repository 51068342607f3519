"""How many cameras a method takes, and what following everyone needs."""

from common.config.settings import Settings
from common.method import Method
from common.video.clip_facts import Clip
from common.video.clip_sources import ClipError


def refuse_too_many(clip: Clip, method: Method) -> None:
    """Refuse a method that does not support that many cameras.

    Raises:
        ClipError: When the clip has more cameras than the method supports.
    """
    several = len(clip.views)
    if method.stick_lifting and several > 1:
        raise ClipError(f"{clip.name}: the thesis's mode is for one camera: add --views 1")
    if not method.proposals and several > 2:
        raise ClipError(
            f"{clip.name}: the paper's mode is for two cameras: name two of the {several} in the "
            "settings, or add --views 1,2 to tritrack track"
        )


def refuse_uncalibrated(clip: Clip, why: str = "") -> None:
    """Refuse more than two cameras without a calibration.

    Args:
        clip: The clip, with the calibration that was found.
        why: Why the person gave none.

    Raises:
        ClipError: When it is refused.
    """
    several = len(clip.views)
    if clip.rig is None and several > 2:
        cause = f" ({why})" if why else ""
        raise ClipError(
            f"{clip.name}: {several} cameras need a calibration{cause}: make one (tritrack "
            "calibrate person, or board), or name two of the cameras (tritrack track --views 1,2)"
        )


def refuse_everyone_unmeasured(clip: Clip, settings: Settings, why: str = "") -> None:
    """Refuse to follow everyone where no calibration says who is where.

    Args:
        clip: The clip, with the calibration that was found.
        settings: The run's settings.
        why: Why the person gave none.

    Raises:
        ClipError: When there is none.
    """
    if settings.people == "all" and clip.rig is None:
        cause = f" ({why})" if why else ""
        raise ClipError(
            f"{clip.name}: to follow everyone takes a calibration{cause}: make one (tritrack "
            "calibrate person), or follow one person (--people 1)"
        )
