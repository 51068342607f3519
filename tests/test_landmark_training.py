"""Training the network of landmarks: the same wish gives the same work, stopped or not."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from drawn_pool import pool_here
from numpy_torch import importable, numpy_torch
from rich.console import Console

from lab.landmark_lessons.picture_store import Part, PictureStore, draw
from synth.picture.picture_examples import PictureExample, picture_examples

QUIET = Console(quiet=True)


@pytest.fixture(scope="module")
def torch() -> Any:
    return pytest.importorskip("torch", reason="the extra `train` is not installed")


@pytest.fixture(scope="module")
def untrained() -> Any:
    """The module, also where the extra `train` is not installed."""
    with importable("onnx"):
        from lab.landmark_lessons import landmark_training

        return landmark_training


@pytest.fixture(scope="module")
def people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return draw(Part(tmp_path_factory.mktemp("people") / "two", 7, 2))


@pytest.fixture
def training(torch: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    from lab.landmark_lessons import landmark_training

    monkeypatch.setattr(landmark_training, "BATCH", 4)
    monkeypatch.setattr(landmark_training, "BACKDROPS", 5)
    monkeypatch.setattr(landmark_training, "WARM", 1)
    return landmark_training


def wanted(training: Any, people: Path, batch: int) -> Any:
    return training.composed(training.Wanted((people,), 0, batch))


def test_what_was_drawn_is_read_as_it_was_drawn(torch: Any, people: Path) -> None:
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
    torch: Any, training: Any, people: Path, tmp_path: Path
) -> None:
    from lab.landmark_lessons import landmark_learning

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
    from lab.landmark_lessons import landmark_loss

    work, shown = training._begun(tmp_path / "none", [people], 0), wanted(training, people, 0)
    before = landmark_loss.loss(work.network, shown).item()
    for _ in range(12):
        work = training._step(work, shown)
    assert landmark_loss.loss(work.network, shown).item() < before - 0.5


def test_a_map_that_peaks_at_a_joint_finds_it(torch: Any) -> None:
    from lab.landmark_lessons import landmark_loss

    joints = torch.tensor([[[20.0, 50.0]] * 15])
    due = landmark_loss._maps_due(joints)
    assert torch.allclose(landmark_loss.peaks(torch.log(due)), joints, atol=0.1)


def test_people_come_in_parts_those_of_the_other_model_twice_and_others_are_held_back(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = pool_here(monkeypatch)
    monkeypatch.setattr(untrained, "draw", lambda part: part.folder)
    monkeypatch.setattr(untrained, "PEOPLE", 700)
    monkeypatch.setattr(untrained, "ANNY_PEOPLE", 450)
    folders = untrained._drawn(Path("w"), 3, QUIET)
    assert [(part.folder.name, *part[1:]) for part in asked] == [
        ("own0", 4200, 300, False),
        ("own300", 4500, 300, False),
        ("own600", 4800, 100, False),
        ("anny0", 4200, 300, True),
        ("anny300", 4500, 150, True),
        ("held_back", 4900, 100, False),
    ]
    own, anny = ["own0", "own300", "own600"], ["anny0", "anny300"]
    assert [folder.name for folder in folders] == [*own, *anny, *anny, "held_back"]


def test_the_rate_rises_stays_and_falls(untrained: Any) -> None:
    """2e-3 after 100 of 4000 batches, until 1600; then it falls evenly, to a hundredth of it."""
    rates = {0: 2e-5, 49: 1e-3, 99: 2e-3, 1600: 2e-3, 2800: 1e-3, 3400: 5e-4, 3999: 2e-5}
    for at, rate in rates.items():
        assert untrained._rate(at) == pytest.approx(rate)


def test_early_batches_replace_more_of_the_running_mean(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    modes: list[str] = []
    monkeypatch.setattr(untrained, "learnt_from", lambda *given: given)
    network = SimpleNamespace(train=lambda: modes.append("train"))
    for at, share in ((0, 1.0), (10, 0.5), (1980, 1 / 199), (3000, 1 / 200)):
        work = SimpleNamespace(network=network, batch=at)
        found = untrained._step(work, "shown")
        assert found == (work, "shown", untrained._rate(at), pytest.approx(share))
    assert modes == ["train"] * 4


def test_work_is_kept_every_hundred_batches_and_at_the_end(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    pool_here(monkeypatch)
    shown, kept = list[Any](), list[Any]()

    def step(work: Any, batch: Any) -> Any:
        shown.append(batch)
        return SimpleNamespace(batch=work.batch + 1)

    def begun(kept_at: Path, folders: Any, seed: int) -> Any:
        assert (kept_at, folders, seed) == (Path("l.pt"), [Path("a")], 5)
        return SimpleNamespace(batch=97)

    monkeypatch.setattr(untrained, "BATCHES", 230)
    monkeypatch.setattr(untrained, "_begun", begun)
    monkeypatch.setattr(untrained, "_step", step)
    monkeypatch.setattr(untrained, "composed", lambda wanted: wanted)
    monkeypatch.setattr(untrained, "keep", lambda work, path: kept.append((work.batch, path)))
    work = untrained._learnt([Path("a")], Path("l.pt"), 5, QUIET)
    assert work.batch == 230
    assert kept == [(100, Path("l.pt")), (200, Path("l.pt")), (230, Path("l.pt"))]
    assert shown == [((Path("a"),), 5, at) for at in range(97, 230)]


def test_a_fresh_start_is_of_pictures_that_no_batch_shows(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    seeds = list[int]()

    class Network:
        def to(self, memory_format: str) -> Any:
            assert memory_format == "last"
            return self

        def paces(self) -> str:
            return "paces"

    network: Any = Network()
    started: Any = []
    library = numpy_torch(manual_seed=seeds.append, channels_last="last")
    monkeypatch.setattr(untrained, "torch", library)
    monkeypatch.setattr(untrained, "composed", lambda wanted: wanted)
    monkeypatch.setattr(
        untrained, "photographed_start", lambda shown: started.append(shown) or network
    )
    monkeypatch.setattr(untrained, "begun", lambda one, paces: (one, paces))
    monkeypatch.setattr(untrained, "resumed", lambda work, path: (work, path))
    found = untrained._begun(Path("l.pt"), [Path("a")], 5)
    assert found == ((network, "paces"), Path("l.pt"))
    assert (started, seeds) == ([((Path("a"),), 5, untrained.BATCHES)], [5])


def test_a_batch_follows_from_its_wish(untrained: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    class Store(list[int]):
        def any(self, rng: np.random.Generator) -> int:
            return self[int(rng.integers(len(self)))]

    monkeypatch.setattr(untrained, "_opened", lambda folders: Store(range(1000)))
    monkeypatch.setattr(untrained, "_backdrops", lambda seed: Store(range(-1000, 0)))
    monkeypatch.setattr(
        untrained, "composite", lambda one, other, backdrop, _: (one, other(), backdrop())
    )
    found = untrained.composed(untrained.Wanted((Path("a"),), 5, 3))
    rng = np.random.default_rng([5, 3, 81])
    due = [[int(rng.integers(1000)) for _ in range(3)] for _ in range(64)]
    assert found == [(one, other, behind - 1000) for one, other, behind in due]


def test_a_training_says_what_it_wrote_and_how_good_that_is(
    untrained: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    noted: Any = []
    folders = [Path("own"), Path("anny"), Path("held_back")]
    work = SimpleNamespace(mean="mean", network="network", batch=30)
    monkeypatch.setattr(untrained, "_drawn", lambda *given: noted.append(given) or folders)
    monkeypatch.setattr(untrained, "_learnt", lambda *given: noted.append(given) or work)
    monkeypatch.setattr(untrained, "write_network", lambda *given: noted.append(given))
    monkeypatch.setattr(untrained, "_right", lambda *given: noted.append(given) or 0.75)
    out, kept = tmp_path / "n.onnx", tmp_path / "n.onnx.work"
    facts = untrained.train_landmarks(out, 5, QUIET)
    assert facts == {"model": str(out), "pictures": 1920, "within_a_tenth": 0.75}
    assert noted == [
        (kept, 5, QUIET),
        (folders[:2], kept / "learnt.pt", 5, QUIET),
        ("mean", out),
        ("mean", [Path("held_back")], 5),
    ]


def test_a_network_that_cannot_be_written_is_named(
    untrained: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def full(*_: Any) -> Any:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(untrained, "_drawn", full)
    with pytest.raises(untrained.TrainingError, match=r"n\.onnx\.work: No space left on device"):
        untrained.train_landmarks(tmp_path / "n.onnx", 5, QUIET)
    with pytest.raises(untrained.TrainingError, match=r"no.n\.onnx: there is no folder .*no$"):
        untrained.train_landmarks(tmp_path / "no" / "n.onnx", 5, QUIET)


def test_joints_that_are_not_seen_are_not_counted_as_right(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    off = np.array([[0.05, 0.0999, np.nan], [0.1, 0.3, 0.01]])
    monkeypatch.setattr(untrained, "composed", lambda wanted: wanted)
    shown: Any = []
    monkeypatch.setattr(
        untrained.landmark_loss, "joints_off", lambda *given: shown.append(given) or off
    )
    assert untrained._right("network", [Path("held")], 5) == pytest.approx(3 / 5)
    assert shown == [("network", ((Path("held"),), 5, untrained.BATCHES))]
