"""Silhouettes from files: what is read is what was written; what is none is refused."""

from pathlib import Path

import numpy as np
import pytest

from common.raster.silhouette_report import mask_of
from tritrack.single import mask_file
from tritrack.single.mask_file import MaskFileError, is_mask_file, read_masks

MASKS = np.random.default_rng(3).random((5, 20, 13)) > 0.5


def written(path: Path, **arrays: np.ndarray) -> Path:
    np.savez(path, allow_pickle=True, **arrays)
    return path


def packed(name: str) -> dict[str, np.ndarray]:
    return {name: np.packbits(MASKS, axis=2), f"{name}__shape": np.array(MASKS.shape)}


@pytest.mark.parametrize("arrays", [packed("walk"), {"walk": MASKS}], ids=["packed", "plain"])
def test_masks_come_back(tmp_path: Path, arrays: dict[str, np.ndarray]) -> None:
    found = read_masks(written(tmp_path / "a.npz", **arrays))
    assert {(each.width, each.height) for each in found.reports} == {(13, 20)}
    assert np.array_equal(np.stack([mask_of(each) for each in found.reports]), MASKS)
    assert [each.captured_s for each in found.reports] == [0.0, 0.04, 0.08, 0.12, 0.16]


def test_one_of_many_is_named_after_a_hash(tmp_path: Path) -> None:
    path = written(tmp_path / "a.npz", **packed("walk"), **packed("run"))
    assert read_masks(Path(f"{path}#run")).name == "run"
    assert is_mask_file(Path(f"{path}#run"))
    assert not is_mask_file(tmp_path / "a.avi")
    with pytest.raises(MaskFileError, match=r"has 2 sequences .*a\.npz#walk"):
        read_masks(path)
    with pytest.raises(MaskFileError, match="none is 'jump'"):
        read_masks(Path(f"{path}#jump"))


@pytest.mark.parametrize(
    "arrays",
    [
        {"walk": np.zeros((5, 20, 3), np.uint8), "walk__shape": np.array([5, 20, 13])},
        {"walk": np.zeros((5, 20, 2), np.uint8), "walk__shape": np.array([5, 20, 13, 1])},
        {"walk": np.zeros((20, 13), np.bool_)},
        {"walk": np.zeros((0, 20, 13), np.bool_)},
    ],
    ids=["rows", "shape", "flat", "empty"],
)
def test_what_is_no_sequence_is_refused(tmp_path: Path, arrays: dict[str, np.ndarray]) -> None:
    with pytest.raises(MaskFileError, match="walk"):
        read_masks(written(tmp_path / "a.npz", **arrays))


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.npz").write_text("no archive")
    for name in ("text.npz", "missing.npz"):
        with pytest.raises(MaskFileError, match=name):
            read_masks(tmp_path / name)


def test_frames_of_another_rate_are_that_far_apart_and_numbered(tmp_path: Path) -> None:
    found = read_masks(written(tmp_path / "the walk.npz", walk=MASKS), 10.0)
    assert found.name == "the walk"
    assert [each.captured_s for each in found.reports] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])
    assert [(each.viewer, each.frame) for each in found.reports] == [(1, i) for i in range(5)]


def test_sequences_are_limited_in_their_pixels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(tmp_path / "a.npz", walk=MASKS)
    monkeypatch.setattr(mask_file, "MAX_PIXELS", MASKS.size)
    assert len(read_masks(path).reports) == 5
    monkeypatch.setattr(mask_file, "MAX_PIXELS", MASKS.size - 1)
    with pytest.raises(MaskFileError, match=r"walk has shape \(5, 20, 13\), not frames x H x W"):
        read_masks(path)


@pytest.mark.parametrize("width", [8, 9, 16, 17])
def test_rows_are_packed_into_whole_bytes(tmp_path: Path, width: int) -> None:
    masks = np.random.default_rng(1).random((2, 3, width)) > 0.4
    arrays = {"walk": np.packbits(masks, axis=2), "walk__shape": np.array(masks.shape)}
    found = read_masks(written(tmp_path / "a.npz", **arrays))
    assert np.array_equal(np.stack([mask_of(each) for each in found.reports]), masks)


def test_what_a_file_holds_is_named_four_of_it_at_most(tmp_path: Path) -> None:
    path = written(tmp_path / "a.npz", **dict.fromkeys("abcde", MASKS))
    due = f"{path} has 5 sequences (a, b, c, d ...), none is '': name one as {path}#a"
    with pytest.raises(MaskFileError) as refused:
        read_masks(path)
    assert str(refused.value) == due
    empty = written(tmp_path / "empty.npz")
    with pytest.raises(MaskFileError, match=r"has 0 sequences \( \.\.\.\), .*empty\.npz#NAME$"):
        read_masks(empty)
    with pytest.raises(MaskFileError, match=r"missing\.npz: No such file or directory; name an"):
        read_masks(tmp_path / "missing.npz")


def test_an_array_of_another_kind_is_not_taken_for_packed_masks(tmp_path: Path) -> None:
    packed_rows = np.packbits(MASKS, axis=2)
    for rows in (packed_rows.astype(np.int64), packed_rows[0]):
        path = written(tmp_path / "a.npz", walk=rows, walk__shape=np.array(MASKS.shape))
        with pytest.raises(MaskFileError, match=r"walk is .*, no packed masks of \(5, 20, 13\)"):
            read_masks(path)
