"""A video in H.264, which browsers play, by PyAV (the extra `video`)."""

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from animator.video_codec import Picture, Put

OPTIONS: Final = {"preset": "veryfast", "crf": "20"}
"""x264's: 5 ms a picture of 640x480 on one core; lines and letters stay sharp."""
FINEST: Final = 60_000
"""Largest denominator of a rate, pictures a second."""


@contextmanager
def h264_writer(path: Path, size: tuple[int, int], fps: float) -> Iterator[Put]:
    """What takes the pictures of a video one after the other; the file is complete at the end.

    Args:
        path: The file, of a name that ends in .mp4.
        size: Width and height, even.
        fps: Pictures a second.

    Raises:
        OSError: When it cannot be written.
    """
    import av

    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
        stream = container.add_stream("libx264", Fraction(fps).limit_denominator(FINEST))
        stream.width, stream.height = size
        stream.pix_fmt, stream.options = "yuv420p", {**OPTIONS}
        stream.codec_context.thread_count = 1

        def put(picture: Picture) -> None:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")))

        yield put
        container.mux(stream.encode(None))


def is_h264(path: Path) -> bool:
    """Whether a file is a video in H.264; False where PyAV is not there to say so."""
    if find_spec("av") is None:
        return False
    import av

    try:
        with av.open(str(path)) as container:
            return [each.codec_context.name for each in container.streams.video] == ["h264"]
    except av.FFmpegError:
        return False
