"""Decoders that begin as forks, where their viewer did: real processes, no bus."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import psutil
import pytest
from test_own_process import SOON_S, ended_within, sleeps, written

from common.platform.linux.forked_child import can_fork
from common.platform.linux.zygote import Zygote
from common.video.decoding import Decoder
from common.video.pictures import DecoderDied
from runtime.live.process_table import Part, end, started
from runtime.live.session import WARMED

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


ANSWERS = """
import os, signal, sys
def main(asker):
    print("no answer"); sys.stderr.write("nor this"); sys.stdout.flush(); sys.stderr.flush()
    deaf = signal.SIGTERM in signal.pthread_sigmask(signal.SIG_BLOCK, ())
    line = next(iter(asker.requests))
    facts = [line, asker.picture, os.getpgrp() == os.getpid(), deaf]
    facts.append(open("/proc/self/comm").read().strip())
    asker.answers.write(repr(facts).encode())
    asker.answers.flush()
    if line == b"wait\\n":
        import time; time.sleep(60)
    sys.exit(7)
"""
STARTER = """
import multiprocessing, os, signal, subprocess, sys
from common.platform.linux import forked_child
forked_child.FORK = multiprocessing.get_context("fork")
signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
asked, ask = os.pipe()
heard, answer = os.pipe()
os.write(ask, sys.argv[1].encode() + b"\\n")
before = len(os.listdir("/proc/self/fd"))
child = forked_child.ForkedChild("answering.part", asked, answer)
os.close(answer)
pid = child._process.pid
said = os.read(heard, 4096).decode()
if sys.argv[1] == "wait":
    try:
        child.wait(0.05)
    except subprocess.TimeoutExpired as late:
        print(late.cmd == str(child.pid), late.timeout)
    child.kill()
code = child.wait()
child._process.close()
after = len(os.listdir("/proc/self/fd"))
print(said, code, pid == child.pid, after - before)
"""
"""Forks itself, as a zygote would: it has no threads."""


@pytest.mark.parametrize(("line", "late", "code"), [("go on", "", 7), ("wait", "True 0.05\n", -9)])
def test_a_forked_module_hears_answers_and_dies_as_one_that_was_started(
    tmp_path: Path, line: str, late: str, code: int
) -> None:
    """It is silent, leads a group of its own, and can be ended by SIGTERM though its parent is deaf
    to it; its starter has but its own ends of the pipes, one of which it closed."""
    (tmp_path / "answering").mkdir()
    (tmp_path / "answering" / "part.py").write_text(ANSWERS)
    done = subprocess.run(
        [sys.executable, "-c", STARTER, line],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": f"{Path(__file__).parents[1]}{os.pathsep}{tmp_path}"},
    )
    said = [f"{line}\n".encode(), None, True, False, "part"]
    assert (done.stdout, done.stderr) == (f"{late}{said} {code} True -1\n", "")


@pytest.mark.slow
def test_a_decoder_is_forked_and_dies_alone_and_with_its_viewer(clip: Path, tmp_path: Path) -> None:
    zygote = Zygote(WARMED)
    zygote.wait(threading.Event(), lambda: None)
    assert zygote.warm
    video = str(next(clip.glob("*.avi")))
    with Decoder() as decoder:
        frames = sum(1 for _ in decoder.frames(video, (160, 120)))
    arguments = (video, str(tmp_path))
    one = started(Part("viewer 1", looks, arguments, nests=True, launcher=zygote))
    part, child = written(tmp_path / "part"), written(tmp_path / "decoder")
    assert (tmp_path / "said").read_text() == (f"killed by SIGSEGV; then {frames}; forked True")
    os.kill(part, signal.SIGKILL)
    assert ended_within(child, SOON_S)
    end(one)
