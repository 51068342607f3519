"""What a live run keeps of what was said: the newest, as it was said."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from common.bus.control_messages import Pulse
from tritrack.live.recorded import MessageLog


def test_no_more_than_the_bound_is_kept_and_what_gave_way_is_counted() -> None:
    """However long a run is, its supervisor takes no more room than this."""
    kept = MessageLog(Pulse, most=3)
    beats = [Pulse(process="viewer 1", state="running", frames=n) for n in range(8)]
    kept.add(beats[:2])
    assert (kept.all(), kept.let_go) == (beats[:2], 0)
    kept.add(beats[2:])
    assert (kept.all(), kept.let_go) == (beats[-3:], 5)


def test_the_newest_are_found_from_the_end_up_to_the_first_that_is_not_wanted() -> None:
    kept = MessageLog(Pulse)
    kept.add(Pulse(process="viewer 1", state="running", frames=n) for n in (9, 1, 7, 8))
    assert [pulse.frames for pulse in kept.newest(lambda each: each.frames > 5)] == [7, 8]
    assert [pulse.frames for pulse in kept.newest(lambda _: True, most=1)] == [8]
    assert MessageLog(Pulse).newest(lambda _: True) == []


def beats(numbers: range) -> list[Pulse]:
    return [Pulse(process="viewer 1", state="running", frames=n) for n in numbers]


def test_what_is_kept_takes_no_memory_and_leaves_no_file(tmp_path: Path) -> None:
    """An hour of bodies is 160 MB, and a machine serves many rooms."""
    code = (
        "import sys; from pathlib import Path; import psutil\n"
        "from common.bus.control_messages import Pulse\n"
        "from tritrack.live.recorded import MessageLog\n"
        "said = Pulse(process='viewer 1', state='running', detail='x' * 3000)\n"
        "kept = MessageLog(Pulse, folder=Path(sys.argv[1])); kept.add([said] * 200)\n"
        "before = psutil.Process().memory_info().rss\n"
        "kept.add([said] * 10_000)\n"
        "assert psutil.Process().memory_info().rss - before < 3e6\n"
        "assert len(kept.all()) == 10_200\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=True)
    assert list(tmp_path.iterdir()) == []


def test_what_a_full_disk_does_not_take_is_kept_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    kept, said = MessageLog(Pulse, most=4), beats(range(7))
    kept.add(said[:2])

    def full(*_: object) -> int:
        raise OSError("no space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(os, "pwrite", full)
        kept.add(said[2:3])
    with monkeypatch.context() as patched:
        patched.setattr(os, "pwrite", lambda *_: 1)  # the disk takes a piece
        kept.add(said[3:5])
    kept.add(said[5:])
    assert (kept.all(), kept.let_go) == (said[-4:], 3)


def test_where_no_file_can_be_made_memory_does(tmp_path: Path) -> None:
    kept = MessageLog(Pulse, folder=tmp_path / "nowhere")
    kept.add(beats(range(3)))
    assert kept.all() == beats(range(3))
