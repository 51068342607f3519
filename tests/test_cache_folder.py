"""The folder of what is compiled: whose it is, where it lies, and how long."""

import logging
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from common import cache_folder
from common.cache_folder import KEPT, digest_of, first_writable, parents, prune
from common.packages import PACKAGES, ROOT


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    root = tmp_path / "sources"
    for package in PACKAGES:
        (root / package / "room").mkdir(parents=True)
        (root / package / "room" / "stage.py").write_text("STEP = 1\n")
    return root


def no_folder(path: Path) -> Path:
    """A place that nobody can write, root neither."""
    path.write_text("a file")
    return path


@pytest.mark.parametrize("package", PACKAGES)
def test_any_change_in_any_package_gives_another_digest(sources: Path, package: str) -> None:
    before, stage = digest_of(sources), sources / package / "room" / "stage.py"
    times = stage.stat().st_atime_ns, stage.stat().st_mtime_ns
    stage.write_text("STEP = 2\n")
    os.utime(stage, ns=times)
    assert digest_of(sources) != before


@pytest.mark.parametrize(
    "change",
    [
        lambda room: (room / "stage.py").rename(room / "stage_two.py"),
        lambda room: (room / "stage.py").unlink(),
        lambda room: (room / "more.py").write_text(""),
    ],
)
def test_a_file_that_moves_comes_or_goes_gives_another_digest(
    sources: Path, change: Callable[[Path], object]
) -> None:
    before = digest_of(sources)
    change(sources / "viewer" / "room")
    assert digest_of(sources) != before


def test_what_is_no_source_leaves_the_digest(sources: Path) -> None:
    before = digest_of(sources)
    (sources / "viewer" / "room" / "network.npz").write_bytes(b"1")
    (sources / "README.md").write_text("1")
    assert digest_of(sources) == before


def test_the_digest_reads_each_of_our_sources_once_and_nothing_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Every process takes it as it starts; how long that takes `tritrack bench` tells."""
    opened: list[Path] = []
    content = cache_folder._content

    def counted(path: str) -> bytes:
        opened.append(Path(path))
        return content(path)

    monkeypatch.setattr(cache_folder, "_content", counted)
    digest_of(ROOT)
    ours = [path for name in PACKAGES for path in (ROOT / name).rglob("*.py")]
    assert sorted(opened) == sorted(ours)


def test_the_folder_lies_in_the_checkout_or_where_numba_is_told(tmp_path: Path) -> None:
    environ = {"XDG_CACHE_HOME": "/caches"}
    user = Path("/caches/tritrack")
    assert list(parents(tmp_path, environ)) == [user]
    (tmp_path / "pyproject.toml").touch()
    assert list(parents(tmp_path, environ)) == [tmp_path / ".cache", user]
    told = {**environ, "NUMBA_CACHE_DIR": "/scratch"}
    assert next(parents(tmp_path, told)) == Path("/scratch")


def test_a_user_without_a_home_has_no_cache_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.path.expanduser", lambda path: path)
    assert list(parents(tmp_path, {})) == []


def test_what_cannot_be_written_is_passed_over(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    closed, user = no_folder(tmp_path / "checkout"), tmp_path / "user"
    assert first_writable([closed / ".cache", user], "name") == user / "name"
    assert (user / "name").is_dir()
    assert len(caplog.records) == 1
    assert "about a minute" in caplog.text
    assert first_writable([closed / ".cache", user], "name") == user / "name"
    assert len(caplog.records) == 1


def test_a_folder_without_the_right_to_write_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "checkout" / "name").mkdir(parents=True)
    monkeypatch.setattr("os.access", lambda path, _: "checkout" not in str(path))
    found = first_writable([tmp_path / "checkout", tmp_path / "user"], "name")
    assert found == tmp_path / "user" / "name"


def test_another_users_folder_is_passed_over(tmp_path: Path) -> None:
    """What was compiled is loaded without a question: theirs would be a stranger's program."""
    if os.getuid() != 0:
        pytest.skip("only an administrator can give a folder away")
    theirs, own = tmp_path / "shared", tmp_path / "user"
    (theirs / "name").mkdir(parents=True)
    assert first_writable([theirs, own], "name") == theirs / "name"
    os.chown(theirs / "name", 12_345, 12_345)
    assert first_writable([theirs, own], "name") == own / "name"


@pytest.mark.parametrize("mode", [0o700, 0o777])
def test_the_last_resort_is_this_users_alone(
    tmp_path: Path, mode: int, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A folder of that name that others may write is a stranger's: code would be loaded from it."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    own = tmp_path / f"tritrack-{os.getuid()}"
    own.mkdir()
    own.chmod(mode)
    closed = no_folder(tmp_path / "closed")
    found = first_writable([closed], "name")
    assert found.is_relative_to(tmp_path)
    assert found.parent.stat().st_mode & 0o777 == 0o700
    assert (found.parent == own) == (mode == 0o700)
    told = [record for record in caplog.records if str(closed) in record.getMessage()]
    assert [record.levelno for record in told] == [logging.WARNING]


def test_only_the_folders_that_were_used_last_stay(tmp_path: Path) -> None:
    for age in range(KEPT + 2):
        folder = tmp_path / f"tritrack-{age:032x}"
        folder.mkdir()
        (folder / "kernel.nbc").touch()
        os.utime(folder, (1e9 - age, 1e9 - age))
    (tmp_path / "somebody else's").mkdir()
    prune(tmp_path)
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"somebody else's", *(f"tritrack-{age:032x}" for age in range(KEPT))}
