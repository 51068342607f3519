"""Training the network of landmarks: the same wish gives the same work, stopped or not."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synth.picture.picture_examples import PictureExample, picture_examples
from tritrack.landmark_lessons.picture_store import Part, PictureStore, draw

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")


@pytest.fixture(scope="module")
def people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return draw(Part(tmp_path_factory.mktemp("people") / "two", 7, 2))


@pytest.fixture
def training(monkeypatch: pytest.MonkeyPatch) -> Any:
    from tritrack.landmark_lessons import landmark_training

    monkeypatch.setattr(landmark_training, "BATCH", 4)
    monkeypatch.setattr(landmark_training, "BACKDROPS", 5)
    monkeypatch.setattr(landmark_training, "WARM", 1)
    return landmark_training


def wanted(training: Any, people: Path, batch: int) -> Any:
    return training.composed(training.Wanted((people,), 0, batch))


def test_what_was_drawn_is_read_as_it_was_drawn(people: Path) -> None:
    store, drawn = PictureStore([people]), [*picture_examples(7), *picture_examples(8)]
    assert len(store) == len(drawn)
    for at in (0, 5, len(drawn) - 1):
        for name in PictureExample._fields:
            assert np.allclose(getattr(store[at], name), getattr(drawn[at], name))


def test_the_same_batch_is_made_up_of_the_same_pictures(training: Any, people: Path) -> None:
    first, again, other = (wanted(training, people, batch) for batch in (3, 3, 4))
    assert all(np.array_equal(a.picture, b.picture) for a, b in zip(first, again, strict=True))
    assert not np.array_equal(first[0].picture, other[0].picture)


def test_work_that_was_stopped_goes_on_where_it_was(
    training: Any, people: Path, tmp_path: Path
) -> None:
    from tritrack.landmark_lessons import landmark_learning

    straight = training._begun(tmp_path / "none", [people], 0)
    stopped = training._begun(tmp_path / "none", [people], 0)
    for batch in range(2):
        shown = wanted(training, people, batch)
        straight, stopped = training._step(straight, shown), training._step(stopped, shown)
    landmark_learning.keep(stopped, tmp_path / "kept.pt")
    resumed = training._begun(tmp_path / "kept.pt", [people], 0)
    assert resumed.batch == 2
    shown = wanted(training, people, 2)
    straight, resumed = training._step(straight, shown), training._step(resumed, shown)
    for name, value in straight.mean.state_dict().items():
        assert torch.allclose(value.float(), resumed.mean.state_dict()[name].float(), atol=1e-6)


def test_learning_makes_it_miss_less(training: Any, people: Path, tmp_path: Path) -> None:
    from tritrack.landmark_lessons import landmark_loss

    work, shown = training._begun(tmp_path / "none", [people], 0), wanted(training, people, 0)
    before = landmark_loss.loss(work.network, shown).item()
    for _ in range(12):
        work = training._step(work, shown)
    assert landmark_loss.loss(work.network, shown).item() < before - 0.5


def test_a_map_that_peaks_at_a_joint_finds_it() -> None:
    from tritrack.landmark_lessons import landmark_loss

    joints = torch.tensor([[[20.0, 50.0]] * 15])
    due = landmark_loss._maps_due(joints)
    assert torch.allclose(landmark_loss.peaks(torch.log(due)), joints, atol=0.1)
