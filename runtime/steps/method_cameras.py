"""How many cameras a method takes."""

from common.method import Method
from common.video.clip_facts import Clip
from common.video.clip_sources import ClipError


def refuse_too_many(clip: Clip, method: Method) -> None:
    """Refuse a method that does not support that many cameras.

    Raises:
        ClipError: When the clip has more cameras than the method supports, or more than two
            without a calibration.
    """
    several = len(clip.views)
    if method.stick_lifting and several > 1:
        raise ClipError(f"{clip.name}: the thesis's mode is for one camera: add --views 1")
    if not method.proposals and several > 2:
        raise ClipError(
            f"{clip.name}: the paper's mode is for two cameras: name two of the {several} in the "
            "settings, or add --views 1,2 to tritrack track"
        )
    if clip.rig is None and several > 2:
        raise ClipError(
            f"{clip.name}: {several} cameras need a calibration: make one (tritrack calibrate "
            "board), or track two of them without: --views 1,2"
        )
