"""The worst frames: which are shown, and what is drawn into them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from test_accuracy import PERSON

from tritrack.accuracy.accuracy import INDEX, Compared
from tritrack.accuracy.worst_frames import APART, stick, worst


def clip_of(off_mm: list[float]) -> Compared:
    """A clip in which every joint is as far off, from frame 9 on."""
    n = len(off_mm)
    true = np.tile(PERSON, (n, 1, 1))
    moved = true + 1e-3 * np.array(off_mm)[:, None, None] * [0.0, 0.0, 1.0]
    return Compared(np.arange(9, 9 + n), np.arange(n), moved, true, np.ones((n, 12)), n, 0, 0)


def test_neighbours_are_left_out_and_other_clips_are_not() -> None:
    off = [10.0] * 25
    off[5], off[6], off[16] = 80.0, 90.0, 70.0
    found = worst({"a": clip_of(off), "b": clip_of([85.0])}, most=3)
    assert [(one.clip, one.frame, round(one.mean_mm)) for one in found] == [
        ("a", 15, 90),
        ("b", 9, 85),
        ("a", 25, 70),
    ]


def test_the_joint_that_is_worst_is_named() -> None:
    clip = clip_of([10.0])
    clip.tracked_m[0, INDEX["r_ankle"], 1] += 0.3
    (one,) = worst({"a": clip})
    assert one.joint == "r_ankle"
    assert round(one.joint_mm) == 300


@given(
    st.dictionaries(
        st.sampled_from("abc"), st.lists(st.floats(0.0, 500.0), max_size=60), max_size=3
    ),
    st.integers(1, 12),
)
def test_what_is_shown_is_worse_than_all_that_is_not_beside_it(
    off_mm: dict[str, list[float]], most: int
) -> None:
    found = worst({name: clip_of(off) for name, off in off_mm.items()}, most)
    means = [one.mean_mm for one in found]
    assert means == sorted(means, reverse=True)
    for i, one in enumerate(found):
        for other in found[:i]:
            assert one.clip != other.clip or abs(one.frame - other.frame) >= APART
    for name, off in off_mm.items():
        for place, error in enumerate(off):
            beside = any(one.clip == name and abs(one.place - place) < APART for one in found)
            assert beside or (len(found) == most and error <= means[-1] + 1e-6)


def test_the_stick_joins_joints_at_pixel_centres() -> None:
    """A thigh from the centre of pixel (10, 5) to that of (10, 25); what is unknown is left out."""
    at_px = np.full((12, 2), np.nan)
    at_px[INDEX["l_hip"]], at_px[INDEX["l_knee"]] = (10.5, 5.5), (10.5, 25.5)
    picture = np.zeros((40, 40, 3), np.uint8)
    stick(picture, at_px, ((255, 0, 0), (0, 0, 255)))
    assert picture[15, 10].tolist() == [255, 0, 0]
    rows, columns = np.nonzero(picture.any(axis=2))
    assert columns.min() + columns.max() == 2 * 10
    assert not picture[:, :, 2].any()
    assert abs(int(rows.min()) + int(rows.max()) - (5 + 25)) <= 1


def test_a_joint_far_outside_draws_nothing() -> None:
    picture = np.zeros((40, 40, 3), np.uint8)
    stick(picture, np.full((12, 2), 1e12), ((255, 0, 0), (0, 0, 255)))
    assert not picture.any()
