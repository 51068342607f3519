"""Files that take another's place: whole ones, of ordinary files alone."""

import errno
import os
import stat
from pathlib import Path

import pytest

from common.atomic_file import FileRefused, refuse_special, refuse_to_replace, replacing, unwritten


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


def test_what_is_there_is_lost_only_where_it_may_be(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    refuse_to_replace(path, replace=False)
    path.touch()
    refuse_to_replace(path, replace=True)
    with pytest.raises(FileRefused, match=rf"^{path} is there already: name another --out, or add"):
        refuse_to_replace(path, replace=False)
    with pytest.raises(FileRefused, match="name another --clip, or add --force"):
        refuse_to_replace(path, False, "--clip")


def test_a_file_a_folder_and_nothing_are_ordinary(tmp_path: Path) -> None:
    (tmp_path / "a").touch()
    for name in (".", "a", "b"):
        refuse_special(tmp_path / name)


def test_what_is_not_whole_yet_is_hidden_beside_it_with_its_ending(tmp_path: Path) -> None:
    """Two that write at once do not meet."""
    path = tmp_path / "a.tar.gz"
    with replacing(path) as one, replacing(path) as other:
        assert one != other
        assert {new.parent for new in (one, other)} == {tmp_path}
        assert all(new.name.startswith(".a.tar.") and new.suffix == ".gz" for new in (one, other))
        assert len(one.name) == len(".a.tar..gz") + 16
        assert not path.exists()
        one.write_text("one")
        other.write_text("other")
    assert path.read_text() == "one"


@pytest.mark.parametrize(
    ("number", "said"),
    [
        (errno.ENOSPC, "cannot write a/b: No space left on device; free some space or go away"),
        (errno.EDQUOT, "cannot write a/b: Disk quota exceeded; free some space or go away"),
        (errno.EACCES, "cannot write a/b: Permission denied; go away"),
    ],
)
def test_space_is_a_cure_where_space_is_what_lacks(number: int, said: str) -> None:
    assert unwritten(Path("a/b"), OSError(number, os.strerror(number)), "go away") == said
    assert unwritten(Path("a"), OSError("odd"), "go away") == "cannot write a: odd; go away"
