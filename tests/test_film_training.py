"""Teaching on films by a teacher that knows the joints: resumable, and judged by what was held."""

from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from truth_teacher import keypoints_of

from tritrack.training.training import TrainingError
from viewer.landmarks.landmark_looks import refuse_no_network

for extra in ("torch", "onnx", "onnxscript"):
    pytest.importorskip(extra, reason="the extra `train` is not installed")


@pytest.fixture(scope="module")
def lesson(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A film, its teacher, a folder, and how little is shown."""
    from tritrack.film_lessons.film_training import Plan

    folder = tmp_path_factory.mktemp("lesson")
    teacher = keypoints_of(clip, 1, folder / "keypoints")
    return next(clip.glob("cam1.*")), str(teacher), folder, Plan(3, 0, 2, 5, 20, 16)


@pytest.mark.slow
def test_what_became_better_is_written_what_did_not_is_not_and_nothing_is_done_twice(
    lesson: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tritrack.film_lessons import film_training

    film, teacher, folder, plan = lesson
    monkeypatch.setattr(film_training, "FEWEST", 20)
    out, quiet = folder / "mine.onnx", Console(quiet=True)
    monkeypatch.setattr(film_training, "FORGETS", 0.0)
    with pytest.raises(TrainingError, match="no better, so nothing is written: joints"):
        film_training.teach_on_films([film], teacher, out, quiet, plan)
    assert not out.exists()
    kept = (folder / "mine.onnx.work" / "learnt.pt").stat().st_mtime_ns
    monkeypatch.setattr(film_training, "FORGETS", 2.0)
    facts = film_training.teach_on_films([film], teacher, out, quiet, plan)
    assert (folder / "mine.onnx.work" / "learnt.pt").stat().st_mtime_ns == kept
    assert facts["film"][1] < facts["film"][0]
    refuse_no_network(str(out))


def test_it_is_better_that_is_so_on_the_films_and_forgot_nothing() -> None:
    from tritrack.film_lessons.film_training import Verdict

    assert Verdict((0.06, 0.05), (0.05, 0.05)).better
    assert not Verdict((0.06, 0.06), (0.05, 0.05)).better
    assert not Verdict((0.06, 0.03), (0.05, 0.06)).better
    assert Verdict((0.06, 0.05), (0.05, 0.05)).line() == (
        "joints 6.0 -> 5.0 % of the stature off at the films' ends, 5.0 -> 5.0 % of made-up people"
    )
