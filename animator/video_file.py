"""A video file: pictures written one after the other, completely or not at all."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import cv2

from animator.h264_file import h264_writer
from animator.video_codec import CODECS, H264, Codec, Picture, Put, best_codec, pictures_in
from common.atomic_file import replacing
from common.video.camera_file import writable_hz


class VideoError(RuntimeError):
    """A video that cannot be written: the text names it and the cure."""


class WrittenVideo(NamedTuple):
    """A written video."""

    path: Path
    codec: Codec


def write_video(path: Path, pictures: Iterable[Picture], fps: float) -> WrittenVideo:
    """Write a video with the best codec of this machine; it replaces the old file once complete.

    Args:
        path: Without a suffix, which the codec determines. A video of that name in another codec is
            removed.
        pictures: All of one size.
        fps: Pictures a second.

    Raises:
        VideoError: When it cannot be written; the old file is unchanged then.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        coming = iter(pictures)
        first = next(coming, None)
        if first is None:
            raise VideoError("it got no picture")
        codec = best_codec()
        with replacing(_named(path, codec)) as new:
            _write(new, chain([first], coming), codec, fps)
        for other in CODECS:
            if other.suffix != codec.suffix:
                _named(path, other).unlink(missing_ok=True)
        return WrittenVideo(_named(path, codec), codec)
    except (OSError, VideoError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise VideoError(
            f"cannot write {path}: {reason}; free some space or name another folder"
        ) from error


def _write(path: Path, pictures: Iterator[Picture], codec: Codec, fps: float) -> None:
    first = next(pictures)
    size, due = (first.shape[1], first.shape[0]), 0
    writer = h264_writer(path, size, fps) if codec == H264 else _writer(path, codec, size, fps)
    with writer as put:
        for picture in chain([first], pictures):
            own = (picture.shape[1], picture.shape[0])
            if own != size:
                raise VideoError(f"a picture of {own} does not follow those of {size}")
            put(picture)
            due += 1
    # OpenCV does not report a full disk
    kept = pictures_in(path, codec)
    if kept != due:
        raise VideoError(f"only {kept} of {due} pictures could be written")


@contextmanager
def _writer(path: Path, codec: Codec, size: tuple[int, int], fps: float) -> Iterator[Put]:
    """OpenCV's writer of a codec."""
    code = cv2.VideoWriter.fourcc(*codec.code)
    writer = cv2.VideoWriter(str(path), codec.by, code, writable_hz(fps), size)

    def put(picture: Picture) -> None:
        writer.write(picture)

    try:
        yield put
    finally:
        writer.release()


def _named(path: Path, codec: Codec) -> Path:
    return path.with_name(path.name + codec.suffix)
