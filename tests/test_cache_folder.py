"""The folder of what is compiled: whose it is, where it lies, and how long."""

import logging
import os
from pathlib import Path

import pytest

from common.cache_folder import KEPT, first_writable, parents, prune


def no_folder(path: Path) -> Path:
    """A place that nobody can write, root neither."""
    path.write_text("a file")
    return path


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


def test_without_numbers_of_users_the_folder_of_temporary_files_is_ones_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows, where it is below each user's own folder and modes say nothing."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.delattr(os, "getuid")
    closed = no_folder(tmp_path / "closed")
    (tmp_path / "tritrack-0").mkdir(mode=0o777)
    (tmp_path / "tritrack-0").chmod(0o777)
    assert first_writable([closed], "name") == tmp_path / "tritrack-0" / "name"


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
