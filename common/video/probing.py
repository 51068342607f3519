"""Facts of a file or a camera; what is no video is refused."""

from pathlib import Path
from typing import Final

from common.video.clip_sources import ClipError
from common.video.decoding import Decoder
from common.video.pictures import DecoderDied, Source, Undecodable, VideoInfo, is_recorded

AVI_HEAD: Final = b"RIFF"


def probed(source: Source, decoder: Decoder) -> VideoInfo:
    """The facts of a file or camera.

    Raises:
        ClipError: When it does not exist, cannot be read, is empty, or has no picture.
    """
    if is_recorded(source):
        refuse_unreadable(Path(source))
    try:
        info = decoder.probe(source)
    except (Undecodable, DecoderDied) as error:
        raise ClipError(str(error)) from error
    if is_recorded(source):
        _refuse_a_lost_head(Path(source))
    return info


def refuse_no_video(source: Source, frames: int, fps: float) -> None:
    """Refuse a single picture, or what has no frame rate, in the place of a video.

    Raises:
        ClipError: When it is one.
    """
    if fps > 0:
        return
    if frames == 1:
        raise ClipError(f"{source} is one picture, no video: name a video")
    raise ClipError(f"{source} has no frame rate: set fps in a meta.json beside it")


def refuse_unreadable(path: Path) -> None:
    """Refuse a file that does not exist, is empty, or cannot be read.

    Raises:
        ClipError: When it cannot be used.
    """
    if path.is_dir():
        raise ClipError(f"{path} is a folder: name a file in it")
    if not path.is_file():
        raise ClipError(f"there is no file {path}: check the path")
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except OSError as error:
        raise ClipError(
            f"cannot read {path}: {error.strerror}; see that you may read it (chmod u+r)"
        ) from error
    if empty:
        raise ClipError(f"{path} is empty: copy or record it again")


def _refuse_a_lost_head(path: Path) -> None:
    """OpenCV decodes a file with a damaged header too, but then makes up rate and number of
    frames."""
    with path.open("rb") as file:
        if path.suffix.lower() == ".avi" and file.read(4) != AVI_HEAD:
            raise ClipError(f"{path} is no AVI from its first byte on: copy or record it again")
