"""Decoders that begin as forks, where their viewer did: real processes, no bus."""

import os
import signal
import sys
import threading
from pathlib import Path

import psutil
import pytest
from test_parent_death import SOON_S, ended_within, sleeps, written

from common.video.decoding import Decoder, DecoderDied
from common.video.forked_child import can_fork
from tritrack.forking.zygote import SPAWN, Zygote
from tritrack.live.process_table import Part, end, inherited, started

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="parts are forked on Linux alone")


def looks(video: str, folder: str) -> None:
    """A part that reads a film twice; the first decoder dies of it."""
    with Decoder() as decoder:
        frames = decoder.frames(video, (160, 120))
        next(frames)
        os.kill(decoder.pid or 0, signal.SIGSEGV)
        try:
            said = f"{sum(1 for _ in frames)} frames more"
        except DecoderDied as error:
            said = error.how
        whole = sum(1 for _ in decoder.frames(video, (160, 120)))
        zygote = psutil.Process(decoder.pid).parent()
        forked = zygote is not None and zygote.ppid() == os.getppid()
        Path(folder, "said").write_text(f"{said}; then {whole}; forked {forked}")
        Path(folder, "decoder").write_text(str(decoder.pid))
        sleeps(f"{folder}/part")


def test_who_was_not_forked_forks_nobody() -> None:
    assert not can_fork()


@pytest.mark.slow
def test_a_decoder_is_forked_and_dies_alone_and_with_its_viewer(clip: Path, tmp_path: Path) -> None:
    zygote = Zygote(inherited)
    zygote.wait(threading.Event(), lambda: None)
    assert zygote.context is not SPAWN
    video = str(next(clip.glob("*.avi")))
    with Decoder() as decoder:
        frames = sum(1 for _ in decoder.frames(video, (160, 120)))
    arguments = (video, str(tmp_path))
    one = started(Part("viewer 1", looks, arguments, nests=True, zygote=zygote))
    part, child = written(tmp_path / "part"), written(tmp_path / "decoder")
    assert (tmp_path / "said").read_text() == (f"killed by SIGSEGV; then {frames}; forked True")
    os.kill(part, signal.SIGKILL)
    assert ended_within(child, SOON_S)
    end(one)
