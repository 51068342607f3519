"""Silhouettes from files: what is read is what was written; what is none is refused."""

from pathlib import Path

import numpy as np
import pytest

from common.raster.silhouette_report import unpack
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
    assert np.array_equal(np.stack([unpack(each) for each in found.reports]), MASKS)
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
