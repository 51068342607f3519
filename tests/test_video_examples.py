"""A film becomes examples whose joints are the teacher's."""

from pathlib import Path

import numpy as np
import pytest
from truth_teacher import keypoints_of

from common.body.observation import Landmarks
from lab.landmark_lessons.picture_store import PictureStore
from lab.training.training import TrainingError
from lab.video_lessons.video_examples import ELSEWHERE, HELD_SHARE, example_of, looked_through
from synth.picture.picture_examples import SIDE_PX, PictureExample


def shown(sure: int) -> Landmarks:
    """Somebody about whose first joints the teacher is sure."""
    joints = tuple((60.0 + 2 * i, 20.0 + 5 * i) for i in range(15))
    return Landmarks(
        joints_px=joints,
        confidence=tuple(0.9 if i < sure else 0.1 for i in range(15)),
        facing_deg=0.0,
        facing_confidence=0.5,
    )


def picture() -> np.ndarray:
    """Every pixel tells its column and row."""
    rows, columns = np.indices((120, 160))
    return np.stack([columns, rows, np.zeros_like(rows)], axis=2).astype(np.uint8)


def example(sure: int = 15) -> PictureExample:
    (one,) = example_of(picture(), np.ones((120, 160), np.bool_), shown(sure), rng())
    return one


def rng() -> np.random.Generator:
    return np.random.default_rng(1)


def test_joints_lie_in_the_window_where_they_lie_in_the_picture() -> None:
    one = example()
    for (x, y), (column, row) in zip(one.joints_px, shown(15).joints_px, strict=True):
        there = one.body[int(y), int(x)].astype(float)
        assert there[:2] == pytest.approx([column - 0.5, row - 0.5], abs=2.0)
    assert one.body.shape == (SIDE_PX, SIDE_PX, 4)
    assert (one.body[..., 3] == 255).all()


def test_what_the_teacher_is_not_sure_of_is_taught_to_lie_nowhere() -> None:
    assert (example(10).joints_px[10:] == ELSEWHERE).all()
    assert (np.abs(example(10).joints_px[:10]) < SIDE_PX).all()


def test_a_frame_in_which_the_teacher_sees_little_teaches_nothing() -> None:
    assert example_of(picture(), np.ones((120, 160), np.bool_), shown(5), rng()) == ()


def test_where_nobody_is_outlined_the_outline_is_that_of_the_joints() -> None:
    nobody = np.zeros((120, 160), np.bool_)
    (one,) = example_of(picture(), nobody, shown(15), rng())
    assert 0.01 < one.outline.mean() < 0.5


def test_a_film_is_looked_through_once_and_its_end_is_held_back(clip: Path, tmp_path: Path) -> None:
    teacher, told = keypoints_of(clip, 1, tmp_path / "keypoints"), list[float]()
    film = next(clip.glob("cam1.*"))
    looked = looked_through(film, str(teacher), tmp_path / "work", told.append)
    learnt, held = PictureStore([looked.learnt]), PictureStore([looked.held])
    assert len(held) / (len(learnt) + len(held)) == pytest.approx(HELD_SHARE, abs=0.02)
    assert len(learnt) + len(held) > 40
    assert told[-1] == 1.0
    inside = [
        (one.joints_px > 0).all() and (one.joints_px < SIDE_PX).all()
        for one in (held[0], learnt[0])
    ]
    assert all(inside)
    for path in teacher.iterdir():
        path.unlink()
    assert looked_through(film, str(teacher), tmp_path / "work", told.append) == looked


def test_a_film_of_nobody_is_named(clip: Path, tmp_path: Path) -> None:
    teacher = keypoints_of(clip, 1, tmp_path / "keypoints")
    for path in sorted(teacher.iterdir())[1:]:
        path.unlink()
    film = next(clip.glob("cam1.*"))
    with pytest.raises(TrainingError, match=r"cam1\.\w+: .*keypoints sees no person there"):
        looked_through(film, str(teacher), tmp_path / "work", lambda _: None)
