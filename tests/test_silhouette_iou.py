"""Silhouettes against true ones, held against pixels counted by hand and the tracker itself."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from common.config.settings import Settings
from lab.accuracy.silhouette_iou import iou, overlaps, shrunk
from runtime.offline.lockstep import Decoders

masks = arrays(np.bool_, (8, 6))


def test_a_pixel_of_half_the_size_is_in_where_two_of_four_are() -> None:
    mask = np.array([[1, 0, 1, 1, 0, 0], [0, 1, 0, 0, 0, 1]], np.uint8)
    assert shrunk(mask, (3, 1)).tolist() == [[True, True, False]]
    assert shrunk(mask, (6, 2)).tolist() == (mask > 0).tolist()


@given(arrays(np.uint8, (24, 32), elements=st.integers(0, 1)))
def test_half_the_size_is_the_mean_of_two_by_two(mask: np.ndarray) -> None:
    mean = mask.reshape(12, 2, 16, 2).mean(axis=(1, 3))
    assert (shrunk(mask, (16, 12)) == (mean >= 0.5)).all()


def test_iou_counted_by_hand() -> None:
    one, other = np.zeros((2, 4, 4), np.bool_)
    one[:2], other[1:3] = True, True
    assert iou(one, other) == pytest.approx(4 / 12)


@given(masks, masks)
def test_iou_has_no_sides_and_is_whole_for_the_same(one: np.ndarray, other: np.ndarray) -> None:
    assert iou(one, other) == iou(other, one)
    assert 0.0 <= iou(one, other) <= 1.0
    assert iou(one, one) == 1.0
    if (one != other).any():
        assert iou(one, other) < 1.0


def truth_of(clip: Path) -> dict[str, np.ndarray]:
    with np.load(clip / "truth.npz") as file:
        return {name: file[name] for name in file.files}


def test_every_frame_of_a_clip_counts_in_either_view(clip: Path) -> None:
    truth = truth_of(clip)
    there = int(truth["present"].sum())
    with Decoders() as decoders:
        found = overlaps(Settings(clip=str(clip)), truth, decoders)
    assert sorted(found) == ["cam1", "cam2"]
    for view in found.values():
        assert (len(view.iou), view.empty, view.ghosts) == (there, len(truth["present"]) - there, 0)
        assert view.iou.mean() > 0.8


def test_masks_of_somewhere_else_overlap_little(clip: Path) -> None:
    """Truth turned upside down is no truth, and a room full of truth has no empty frame."""
    truth = truth_of(clip)
    upside_down = {
        **truth,
        "mask_cam1": truth["mask_cam1"][:, ::-1],
        "mask_cam2": truth["mask_cam2"],
    }
    with Decoders() as decoders:
        found = overlaps(Settings(clip=str(clip)), upside_down, decoders)
        alone = overlaps(
            Settings(clip=str(clip)),
            {"mask_cam2": truth["mask_cam2"], "mask_shape": truth["mask_shape"]},
            decoders,
        )
    assert found["cam1"].iou.mean() < 0.6 < found["cam2"].iou.mean()
    assert list(alone) == ["cam2"]
    assert alone["cam2"].iou == pytest.approx(found["cam2"].iou)
