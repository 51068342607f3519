"""Pictures of synthetic people say truly where their joints are."""

from functools import lru_cache

import numpy as np

from common.body.body import JOINT_NAMES
from synth.picture.picture_examples import PICTURES, SIDE_PX, PictureExample, picture_examples

TRUNK = [JOINT_NAMES.index(name) for name in ("pelvis", "l_hip", "r_hip", "neck")]


@lru_cache(maxsize=1)
def some() -> list[PictureExample]:
    return [shown for seed in range(12) for shown in picture_examples(seed)]


def test_a_seed_is_a_person_always_the_same() -> None:
    first, again = (list(picture_examples(3)) for _ in range(2))
    assert all(np.array_equal(a.body, b.body) for a, b in zip(first, again, strict=True))
    assert PICTURES - 2 <= len(first) <= PICTURES


def test_joints_lie_within_the_body_that_is_drawn() -> None:
    """Joints are inside of limbs: those in the picture stand on covered pixels."""
    on, all_of_them = 0, 0
    for shown in some():
        inside = ((shown.joints_px > 1) & (shown.joints_px < SIDE_PX - 1)).all(axis=1)
        columns, rows = shown.joints_px[inside].astype(int).T
        on += int((shown.body[rows, columns, 3] > 0).sum())
        all_of_them += int(inside.sum())
    assert on / all_of_them > 0.97


def test_the_left_hand_is_on_the_right_of_whoever_faces_the_camera() -> None:
    left, right = (JOINT_NAMES.index(f"{side}_shoulder") for side in "lr")
    upright = [
        shown
        for shown in some()
        if abs(shown.facing[1]) > 0.9 and shown.joints_px[0, 1] > shown.joints_px[1, 1] + 5
    ]
    towards = [shown.facing[1] > 0 for shown in upright]
    beside = [shown.joints_px[left, 0] > shown.joints_px[right, 0] for shown in upright]
    assert len(upright) > 20
    assert np.mean(np.equal(towards, beside)) > 0.9


def test_a_person_fills_the_window_that_a_viewer_would_cut_out() -> None:
    spans = []
    for shown in some():
        rows = np.flatnonzero(shown.outline.any(axis=1))
        columns = np.flatnonzero(shown.outline.any(axis=0))
        spans.append(max(np.ptp(rows), np.ptp(columns)) / SIDE_PX)
    assert 0.6 < np.median(spans) < 0.95
    assert np.quantile(spans, 0.02) < 0.5


def test_the_stature_is_that_of_somebody_upright() -> None:
    """From crown to ankles is some 0.93 of a stature where the body is straight and upright."""
    top, left, right = (JOINT_NAMES.index(name) for name in ("head_top", "l_ankle", "r_ankle"))
    shares = []
    for shown in some():
        ankles = (shown.joints_px[left] + shown.joints_px[right]) / 2
        shares.append(float(np.linalg.norm(shown.joints_px[top] - ankles)) / shown.stature_px)
    assert 0.85 < np.quantile(shares, 0.9) < 1.1
