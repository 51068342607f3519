"""Dropped files piece by piece: what comes whole, what is refused, what is left behind."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from waiting import until

from animator.start.wishes import Begin, Chunk
from common.bus.messages import MOST_VIEWS
from common.folder_owner import OWNER
from tritrack.starting.uploads import (
    MOST_BYTES,
    SPARE_BYTES,
    UploadRefused,
    Uploads,
    safe_name,
)


def piece(file: int, start: int, content: bytes) -> Chunk:
    return Chunk(file, start, memoryview(content))


@pytest.fixture
def uploads(tmp_path: Path) -> Uploads:
    return Uploads(tmp_path / "uploads", 1000)


def test_a_file_comes_whole_though_a_piece_comes_twice(uploads: Uploads) -> None:
    content = os.urandom(700)
    found = uploads.begin(Begin(7, "walk.mp4", 700))
    for start, end in ((0, 300), (0, 300), (300, 600), (200, 500), (600, 700)):
        uploads.take(piece(7, start, content[start:end]))
    assert found.is_whole
    assert found.path.read_bytes() == content


def test_a_file_never_grows_beyond_what_was_said(uploads: Uploads) -> None:
    found = uploads.begin(Begin(7, "walk.mp4", 10))
    uploads.take(piece(7, 0, b"x" * 500))
    uploads.take(piece(7, 10, b"x" * 500))
    assert found.path.stat().st_size == 10


def test_a_file_keeps_its_users_name_for_it(uploads: Uploads) -> None:
    found = uploads.begin(Begin(7, "C:\\Videos\\Tür 'vorne' 1.mp4", 10))
    assert (found.title, found.path.name) == ("Tür 'vorne' 1.mp4", "Tur_vorne_1.mp4")


def test_a_file_of_a_job_can_be_had_again(uploads: Uploads, tmp_path: Path) -> None:
    kept = tmp_path / "cam1.avi"
    kept.write_bytes(b"video")
    found = uploads.put_back(kept, "walk.avi")
    kept.unlink()
    assert found.is_whole
    assert (found.path.name, found.path.read_bytes()) == ("walk.avi", b"video")
    with pytest.raises(UploadRefused, match="drop the file again"):
        uploads.put_back(kept, "walk.avi")
    kept.write_bytes(b"video")
    for _ in range(MOST_VIEWS - 1):
        uploads.put_back(kept, "walk.avi")
    with pytest.raises(UploadRefused, match="take one away"):
        uploads.put_back(kept, "walk.avi")


def test_what_belongs_to_no_file_changes_nothing(uploads: Uploads) -> None:
    assert uploads.take(piece(1, 0, b"x")) is None


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("../../etc/passwd", "passwd"),
        ("C:\\films\\walk 1.MP4", "walk_1.MP4"),
        (".bashrc", "bashrc"),
        ("-rf.avi", "rf.avi"),
        ("a\0b\n.avi", "a_b_.avi"),
        ("größe Å.mp4", "grosse_A.mp4"),
        ("..", "video"),
        ("x" * 300 + ".mkv", "x" * 76 + ".mkv"),
        ("walk." + "x" * 200, "walk." + "x" * 10),
    ],
)
def test_a_name_leads_nowhere_else(uploads: Uploads, tmp_path: Path, name: str, kept: str) -> None:
    assert safe_name(name) == kept
    found = uploads.begin(Begin(1, name, 10))
    assert found.path == tmp_path / "uploads/1" / kept


@pytest.mark.parametrize(
    ("wish", "says"),
    [
        (Begin(1, "walk.mp4", 1001), "at most"),
        (Begin(1, "walk.mp4", 0), "is empty"),
        (Begin(1, "walk.mp4", -5), "is empty"),
        (Begin(-1, "walk.mp4", 10), "number"),
        (Begin(1 << 40, "walk.mp4", 10), "number"),
    ],
)
def test_what_is_too_much_or_nothing_is_refused(uploads: Uploads, wish: Begin, says: str) -> None:
    with pytest.raises(UploadRefused, match=says):
        uploads.begin(wish)
    assert uploads.files == []


def test_a_file_that_would_leave_less_than_a_gigabyte_is_refused(
    uploads: Uploads, monkeypatch: pytest.MonkeyPatch
) -> None:
    free = SimpleNamespace(free=SPARE_BYTES + 100)
    monkeypatch.setattr("tritrack.starting.uploads.shutil.disk_usage", lambda _: free)
    with pytest.raises(UploadRefused, match="no space"):
        uploads.begin(Begin(1, "walk.mp4", 101))
    assert uploads.begin(Begin(1, "walk.mp4", 100)) in uploads.files


def test_files_that_come_at_once_share_the_space(
    uploads: Uploads, monkeypatch: pytest.MonkeyPatch
) -> None:
    free = SimpleNamespace(free=SPARE_BYTES + 100)
    monkeypatch.setattr("tritrack.starting.uploads.shutil.disk_usage", lambda _: free)
    uploads.begin(Begin(1, "cam1.mp4", 60))
    with pytest.raises(UploadRefused, match="no space"):
        uploads.begin(Begin(2, "cam2.mp4", 41))
    uploads.take(piece(1, 0, b"x" * 60))
    assert uploads.begin(Begin(2, "cam2.mp4", 41)) in uploads.files


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_file_that_fills_the_disk_is_taken_away(uploads: Uploads) -> None:
    """Closing it fails too: what is still to be written has no space either."""
    found = uploads.begin(Begin(1, "walk.mp4", 700))
    uploads._open[1].close()
    uploads._open[1] = Path("/dev/full").open("wb")  # noqa: SIM115
    uploads.take(piece(1, 0, b"x" * 600))
    with pytest.raises(UploadRefused, match="free some space or take the file away"):
        uploads.take(piece(1, 600, b"x" * 100))
    uploads.begin(Begin(2, "walk.mp4", 700))
    uploads._open[2].close()
    uploads._open[2] = Path("/dev/full").open("wb")  # noqa: SIM115
    uploads.take(piece(2, 0, b"x" * 600))
    uploads.drop(2)
    assert uploads.files == []
    assert not found.path.exists()


def test_a_disk_keeps_its_last_space(tmp_path: Path) -> None:
    uploads = Uploads(tmp_path / "uploads", 1 << 62)
    with pytest.raises(UploadRefused, match="no space"):
        uploads.begin(Begin(1, "walk.mp4", 1 << 61))
    with pytest.raises(UploadRefused, match=r"17\.2 GB, the page takes 8\.6 at most"):
        Uploads(tmp_path / "uploads", MOST_BYTES).begin(Begin(1, "walk.mp4", 2 * MOST_BYTES))


def test_a_calibration_is_small(tmp_path: Path) -> None:
    uploads = Uploads(tmp_path / "uploads")
    with pytest.raises(UploadRefused, match="at most"):
        uploads.begin(Begin(1, "Calib.toml", 1 << 26))
    assert uploads.begin(Begin(1, "Calib.toml", 100)).is_calibration


def test_there_are_no_more_files_than_cameras(uploads: Uploads) -> None:
    for number in range(MOST_VIEWS):
        uploads.begin(Begin(number, "cam.avi", 10))
    with pytest.raises(UploadRefused, match="take one away"):
        uploads.begin(Begin(99, "cam.avi", 10))
    uploads.drop(3)
    assert uploads.begin(Begin(99, "cam.avi", 10)) in uploads.files
    with pytest.raises(UploadRefused, match="number"):
        Uploads(uploads.files[0].path.parents[2] / "other", 1000).begin(Begin(1 << 33, "a", 1))


def test_the_order_is_that_of_the_cameras(uploads: Uploads) -> None:
    for number in (5, 6, 7):
        uploads.begin(Begin(number, "cam.avi", 10))
    uploads.earlier(7)
    uploads.earlier(5)
    assert [one.number for one in uploads.files] == [5, 7, 6]


def test_nothing_is_left_of_what_was_only_dropped(uploads: Uploads, tmp_path: Path) -> None:
    uploads.begin(Begin(1, "walk.mp4", 10))
    (tmp_path / "uploads/old").mkdir()
    again = Uploads(tmp_path / "uploads")
    assert [path.name for path in (tmp_path / "uploads").iterdir()] == [OWNER]
    again.begin(Begin(1, "walk.mp4", 10))
    again.close()
    assert not (tmp_path / "uploads").exists()


def test_two_pages_never_work_in_one_folder(tmp_path: Path) -> None:
    """One that was killed leaves its number, which may be another program's by now."""
    folder = tmp_path / "uploads"
    folder.mkdir()
    (folder / OWNER).write_text(str(os.getppid()))
    with pytest.raises(UploadRefused, match=f"process {os.getppid()}.*name another --runs"):
        Uploads(folder)
    os.utime(folder / OWNER, (1000.0, 1000.0))
    Uploads(folder).close()
    folder.mkdir()
    for stale in ("999999999", "", "no number"):
        (folder / OWNER).write_text(stale)
        Uploads(folder)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system keeps no dead processes")
def test_a_page_that_was_killed_and_not_waited_for_is_gone(tmp_path: Path) -> None:
    """As in a container, whose first process waits for none."""
    folder = tmp_path / "uploads"
    folder.mkdir()
    killed = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    (folder / OWNER).write_text(str(killed.pid))
    with pytest.raises(UploadRefused, match="another start page"):
        Uploads(folder)
    killed.kill()
    assert until(lambda: psutil.Process(killed.pid).status() == psutil.STATUS_ZOMBIE)
    Uploads(folder).close()
    killed.communicate()


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "runs").write_text("a file")
    with pytest.raises(UploadRefused, match="name another --runs"):
        Uploads(tmp_path / "runs/.uploads")
