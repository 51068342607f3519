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
from synth.picture import composites
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

    for name, value in {"BATCH": 2, "BACKDROPS": 3, "WARM": 1, "BATCHES": 2}.items():
        monkeypatch.setattr(landmark_training, name, value)
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


def test_something_stands_before_a_third_of_the_people(
    training: Any, people: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls, obstructed = [], composites._obstructed

    def counted(*given: Any) -> Any:
        calls.append(1)
        return obstructed(*given)

    monkeypatch.setattr(composites, "_obstructed", counted)
    monkeypatch.setattr(training, "BATCH", 120)
    wanted(training, people, 0)
    assert 0.2 < len(calls) / 120 < 0.5


def begun(training: Any) -> Any:
    from lab.landmark_lessons.landmark_learning import begun
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_start import movenet

    training.torch.manual_seed(0)
    network = MovenetLandmarks(movenet())
    return begun(network, [network.heads(), network.trunk()])


@pytest.mark.slow
def test_work_that_was_stopped_goes_on_where_it_was(
    torch: Any, training: Any, people: Path, tmp_path: Path
) -> None:
    """What is pulled back is so to where the first start was."""
    from lab.landmark_lessons.landmark_learning import keep, resumed

    straight = begun(training)
    straight = training._step(straight, wanted(training, people, 0), 2)
    keep(straight, tmp_path / "kept.pt")
    again = resumed(begun(training), tmp_path / "kept.pt")
    assert again.batch == 1
    shown = wanted(training, people, 1)
    straight, again = training._step(straight, shown, 2), training._step(again, shown, 2)
    for name, value in straight.mean.state_dict().items():
        assert torch.allclose(value.float(), again.mean.state_dict()[name].float(), atol=1e-6)


@pytest.mark.slow
def test_learning_makes_it_miss_less(training: Any, people: Path) -> None:
    from lab.landmark_lessons import landmark_loss

    work, shown = begun(training), wanted(training, people, 0)
    before = landmark_loss.loss(work.network, shown).item()
    for _ in range(12):
        work = training._step(work, shown, 40)
    assert landmark_loss.loss(work.network, shown).item() < before - 0.5


@pytest.mark.slow
def test_of_all_stages_comes_a_file_and_what_is_learnt_is_not_learnt_twice(
    training: Any, people: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from viewer.landmarks.landmark_looks import opened

    pytest.importorskip("onnxscript", reason="the extra `train` is not installed")
    pool_here(monkeypatch)
    for name, value in {"HEAD_BATCHES": 1, "HELD_BATCHES": 2, "RANGED": 2}.items():
        monkeypatch.setattr(training, name, value)
    monkeypatch.setattr(
        training, "_drawn", lambda work, *_: work.mkdir(exist_ok=True) or [people] * 2
    )
    out = tmp_path / "n.onnx"
    facts = training.train_landmarks(out, 0, QUIET)
    assert facts["pictures"] == 3 * 2
    assert [each.name for each in opened(out).get_outputs()] == ["maps", "told", "mask"]
    monkeypatch.setattr(training, "learnt_from", None)
    assert training.train_landmarks(out, 0, QUIET) == facts


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


@pytest.mark.parametrize("batches", [2400, 450])
def test_the_rate_rises_stays_and_falls(untrained: Any, batches: int) -> None:
    """Whole after 50 batches, until four tenths of all; then it falls evenly, to a hundredth."""
    shares = {0.4: 1.0, 0.7: 0.5, 0.85: 0.25, 0.9999: 0.01}
    for at, rate in {0: 0.02, 24: 0.5, 49: 1.0}.items():
        assert untrained._rate(at, batches) == pytest.approx(rate)
    for share, rate in shares.items():
        assert untrained._rate(share * batches, batches) == pytest.approx(rate)


def test_early_batches_replace_more_of_the_running_mean(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(untrained, "learnt_from", lambda *given: given)
    for at, share in ((0, 1.0), (10, 0.5), (980, 1 / 99), (2000, 1 / 100)):
        work = SimpleNamespace(batch=at)
        found = untrained._step(work, "shown", 2400)
        assert found == (work, "shown", untrained._rate(at, 2400), pytest.approx(share))


def test_work_is_kept_every_hundred_batches_and_at_the_end(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The batches of a stage are numbered from its first on."""
    pool_here(monkeypatch)
    shown, kept = list[Any](), list[Any]()

    def step(work: Any, batch: Any, batches: int) -> Any:
        assert batches == 230
        shown.append(batch)
        return SimpleNamespace(batch=work.batch + 1)

    monkeypatch.setattr(untrained, "_step", step)
    monkeypatch.setattr(untrained, "composed", lambda wanted: wanted)
    monkeypatch.setattr(untrained, "keep", lambda work, path: kept.append((work.batch, path)))
    stage = untrained.Stage(Path("l.pt"), 1000, 230)
    wanted = untrained.Wanted((Path("a"),), 5, 0)
    work = untrained._learnt(SimpleNamespace(batch=97), stage, wanted, QUIET)
    assert work.batch == 230
    assert kept == [(100, Path("l.pt")), (200, Path("l.pt")), (230, Path("l.pt"))]
    assert shown == [((Path("a"),), 5, 1000 + at) for at in range(97, 230)]


def test_heads_and_trunk_learn_then_the_heads_alone_on_a_trunk_halfway_back(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    seeds, noted = list[int](), list[Any]()

    class Network:
        def __init__(self, name: str) -> None:
            self.name = name

        def to(self, memory_format: str) -> Any:
            assert memory_format == "last"
            return self

        def heads(self) -> str:
            return f"heads of {self.name}"

        def trunk(self) -> str:
            return f"trunk of {self.name}"

    def learnt(work: Any, stage: Any, wanted: Any, console: Any) -> Any:
        noted.append((*work, stage, wanted))
        return SimpleNamespace(mean=f"learnt {work[0]}")

    library = numpy_torch(manual_seed=seeds.append, channels_last="last")
    monkeypatch.setattr(untrained, "torch", library)
    monkeypatch.setattr(untrained, "movenet", lambda: "published")
    monkeypatch.setattr(untrained, "MovenetLandmarks", Network)
    monkeypatch.setattr(untrained, "between", lambda *given: Network(" ".join(map(str, given))))
    monkeypatch.setattr(untrained, "begun", lambda network, parts: (network.name, parts))
    monkeypatch.setattr(untrained, "resumed", lambda work, kept: (*work, kept))
    monkeypatch.setattr(untrained, "_learnt", learnt)
    found = untrained._trained([Path("a")], Path("w"), 5, QUIET)
    first, second = Path("w/learnt.pt"), Path("w/heads.pt")
    both, wanted = ["heads of published", "trunk of published"], ((Path("a"),), 5, 0)
    again = "learnt published published 0.5"
    assert noted == [
        ("published", both, first, (first, 0, 2400), wanted),
        (again, [f"heads of {again}"], second, (second, 2400, 450), wanted),
    ]
    assert (found, seeds) == (f"learnt {again}", [5])


def test_a_batch_follows_from_its_wish(untrained: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    class Store(list[int]):
        def any(self, rng: np.random.Generator) -> int:
            return self[int(rng.integers(len(self)))]

    monkeypatch.setattr(untrained, "_opened", lambda folders: Store(range(1000)))
    monkeypatch.setattr(untrained, "_backdrops", lambda seed: Store(range(-1000, 0)))
    monkeypatch.setattr(
        untrained, "composite", lambda one, other, back, _, share: (one, other(), back(), share)
    )
    found = untrained.composed(untrained.Wanted((Path("a"),), 5, 3))
    rng = np.random.default_rng([5, 3, 81])
    due = [[int(rng.integers(1000)) for _ in range(3)] for _ in range(32)]
    share = untrained.OBSTRUCTED
    assert found == [(one, other, behind - 1000, share) for one, other, behind in due]


def test_a_training_says_what_it_wrote_and_how_good_that_is(
    untrained: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Confidence is set by all who are held back, ranges are those of 64 pictures of them."""
    noted: Any = []
    folders = [Path("own"), Path("anny"), Path("held_back")]
    held = list(range(100))
    monkeypatch.setattr(untrained, "_drawn", lambda *given: noted.append(given) or folders)
    monkeypatch.setattr(untrained, "_trained", lambda *given: noted.append(given) or "network")
    monkeypatch.setattr(untrained, "_held", lambda *given: noted.append(given) or held)
    monkeypatch.setattr(untrained, "set_confidence", lambda *given: noted.append(given))
    monkeypatch.setattr(untrained, "write_both", lambda *given: noted.append(given))
    monkeypatch.setattr(untrained, "_right", lambda *given: noted.append(given) or 0.75)
    out, kept = tmp_path / "n.onnx", tmp_path / "n.onnx.work"
    facts = untrained.train_landmarks(out, 5, QUIET)
    assert facts == {"model": str(out), "pictures": 2850 * 32, "within_a_tenth": 0.75}
    assert noted == [
        (kept, 5, QUIET),
        (folders[:2], kept, 5, QUIET),
        (Path("held_back"), 5),
        ("network", held),
        ("network", held[:64], kept, out),
        ("network", held),
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
    monkeypatch.setattr(untrained.landmark_loss, "joints_off", lambda *given: off)
    assert untrained._right("network", ["shown"]) == pytest.approx(3 / 5)


def test_who_is_held_back_is_shown_in_batches_from_which_nothing_was_learnt(
    untrained: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(untrained, "composed", lambda wanted: [wanted])
    found = [*untrained._held(Path("held"), 5)]
    assert found == [((Path("held"),), 5, 2850 + at) for at in range(20)]
