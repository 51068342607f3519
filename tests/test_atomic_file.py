"""Files that take another's place: whole ones, of ordinary files alone."""

import os
import stat
from pathlib import Path

import pytest

from common.atomic_file import FileRefused, replacing


def test_a_file_takes_the_place_of_one_when_all_is_written(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("before")
    with replacing(path) as new:
        new.write_text("after")
        assert path.read_text() == "before"
    assert path.read_text() == "after"
    with pytest.raises(ZeroDivisionError), replacing(path) as new:
        new.write_text(str(1 // 0))
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("mask", "mode"), [(0o077, 0o600), (0o022, 0o644), (0o002, 0o664)])
def test_who_may_read_a_file_is_as_the_user_has_it(tmp_path: Path, mask: int, mode: int) -> None:
    """POSIX: a new file is for everybody to read and write, less the umask."""
    before = os.umask(mask)
    try:
        with replacing(tmp_path / "a.txt") as new:
            new.write_text("how somebody moves")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == mode


def test_no_file_takes_the_place_of_what_is_no_ordinary_file(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    (tmp_path / "linked").symlink_to(pipe)
    for path in (pipe, tmp_path / "linked"):
        said = rf"{path} is no ordinary file: name another --out"
        with pytest.raises(FileRefused, match=said), replacing(path) as new:
            new.write_text("")
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert sorted(tmp_path.iterdir()) == [tmp_path / "linked", pipe]
