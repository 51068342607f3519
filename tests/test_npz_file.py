"""Arrays in a file: what is damaged, foreign or too large is refused, and nothing is run."""

from pathlib import Path

import numpy as np
import pytest

from common.npz_file import DamagedFile, read_arrays, write_arrays

NUMBERS = {"a": np.arange(12.0).reshape(3, 4), "b": np.array(["x", "yz"])}


def test_what_is_written_is_read(tmp_path: Path) -> None:
    write_arrays(tmp_path / "n.npz", NUMBERS)
    held = read_arrays(tmp_path / "n.npz", 10_000)
    assert held.keys() == NUMBERS.keys()
    assert all(np.array_equal(held[name], NUMBERS[name]) for name in NUMBERS)


def test_the_same_arrays_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one.npz", "other.npz"):
        write_arrays(tmp_path / name, NUMBERS)
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "other.npz").read_bytes()


def test_a_file_that_would_unpack_to_too_much_is_refused(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "bomb.npz", a=np.zeros(1_000_000))
    with pytest.raises(DamagedFile, match="bytes unpacked, at most 10000 are taken"):
        read_arrays(tmp_path / "bomb.npz", 10_000)


@pytest.mark.parametrize("kept", [0, 10, 200])
def test_a_file_that_was_cut_short_is_refused(tmp_path: Path, kept: int) -> None:
    path = tmp_path / "n.npz"
    write_arrays(path, NUMBERS)
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(DamagedFile):
        read_arrays(path, 10_000)


def test_objects_are_not_read(tmp_path: Path) -> None:
    np.savez(tmp_path / "n.npz", allow_pickle=True, a=np.array([None], object))
    with pytest.raises(DamagedFile, match="allow_pickle"):
        read_arrays(tmp_path / "n.npz", 10_000)


def test_a_missing_file_is_told_apart(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_arrays(tmp_path / "gone.npz", 10_000)


def test_a_file_may_be_as_large_as_is_taken_and_lies_in_a_folder_that_is_made(
    tmp_path: Path,
) -> None:
    """By hand: an array's head of 128 bytes, and twelve numbers of eight."""
    path = tmp_path / "deep" / "n.npz"
    write_arrays(path, {"a": NUMBERS["a"]})
    assert read_arrays(path, 224)["a"].shape == (3, 4)
    with pytest.raises(DamagedFile, match=r"^224 bytes unpacked, at most 223 are taken$"):
        read_arrays(path, 223)


def test_a_reason_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "n.npz").write_text("no archive")
    with pytest.raises(DamagedFile, match=r"^File is not a zip file$"):
        read_arrays(tmp_path / "n.npz", 10_000)
