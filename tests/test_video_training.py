"""Teaching on films by a teacher that knows the joints: resumable, and judged by what was held."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from drawn_pool import pool_here
from numpy_torch import importable
from rich.console import Console
from truth_teacher import keypoints_of

from lab.training.training import TrainingError
from viewer.landmarks.landmark_looks import refuse_no_network

QUIET = Console(quiet=True)


@pytest.fixture(scope="module")
def lesson(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A film, its teacher, a folder, and how little is shown; in the folder a network that
    photographs alone taught, in the place of the shipped one."""
    for extra in ("torch", "onnx", "onnxscript"):
        pytest.importorskip(extra, reason="the extra `train` is not installed")
    from lab.landmark_lessons.landmark_file import write_network
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_start import movenet
    from lab.video_lessons.video_training import Plan

    folder = tmp_path_factory.mktemp("lesson")
    write_network(MovenetLandmarks(movenet()), folder / "start.onnx")
    teacher = keypoints_of(clip, 1, folder / "keypoints")
    return next(clip.glob("cam1.*")), str(teacher), folder, Plan(3, 0, 2, 5, 20, 16)


@pytest.mark.slow
def test_what_became_better_is_written_what_did_not_is_not_and_nothing_is_done_twice(
    lesson: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from lab.video_lessons import video_training

    film, teacher, folder, plan = lesson
    monkeypatch.setattr(video_training, "FEWEST", 20)
    monkeypatch.setattr(video_training, "SHIPPED", folder / "start.onnx")
    out, quiet = folder / "mine.onnx", Console(quiet=True)
    monkeypatch.setattr(video_training, "FORGETS", 0.0)
    with pytest.raises(TrainingError, match="no better, so nothing is written: joints"):
        video_training.teach_on_videos([film], teacher, out, quiet, plan)
    assert not out.exists()
    kept = (folder / "mine.onnx.work" / "learnt.pt").stat().st_mtime_ns
    monkeypatch.setattr(video_training, "FORGETS", 2.0)
    facts = video_training.teach_on_videos([film], teacher, out, quiet, plan)
    assert (folder / "mine.onnx.work" / "learnt.pt").stat().st_mtime_ns == kept
    assert facts["film"][1] < facts["film"][0]
    refuse_no_network(str(out))
    assert out.stat().st_size < 0.5 * (folder / "mine.onnx.work" / "whole.onnx").stat().st_size


@pytest.fixture(scope="module")
def training() -> Any:
    """The module, also where the extra `train` is not installed."""
    with importable("onnx"):
        from lab.video_lessons import video_training

        return video_training


def test_it_is_better_that_is_so_on_the_films_and_forgot_nothing(training: Any) -> None:
    Verdict = training.Verdict
    assert Verdict((0.06, 0.05), (0.05, 0.0514)).better
    assert not Verdict((0.06, 0.05), (0.05, 0.0516)).better
    assert Verdict((0.06, 0.05), (0.05, 0.05)).better
    assert not Verdict((0.06, 0.06), (0.05, 0.05)).better
    assert not Verdict((0.06, 0.03), (0.05, 0.06)).better
    assert Verdict((0.06, 0.05), (0.05, 0.05)).line() == (
        "joints 6.0 -> 5.0 % of the stature off at the films' ends, 5.0 -> 5.0 % of made-up people"
    )


def test_the_shipped_network_is_judged_on_the_same_as_the_taught_one(
    training: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    looked = [training.Looked(Path(f"learnt{n}"), Path(f"held{n}")) for n in range(2)]
    noted: Any = []
    plan = training.Plan(batches=7)
    people = [Path("own"), Path("anny"), Path("held_back")]
    offs = {"shipped": (0.06, 0.05), "mean": (0.04, 0.051)}

    def off(network: str, held: Any) -> Any:
        noted.append((network, held))
        return offs[network]

    def learnt(*given: Any) -> Any:
        noted.append(given)
        return SimpleNamespace(mean="mean", network="last")

    monkeypatch.setattr(training, "_looked", lambda *given: noted.append(given) or looked)
    monkeypatch.setattr(training, "_drawn", lambda *given: noted.append(given) or people)
    monkeypatch.setattr(training, "_shipped", lambda: "shipped")
    monkeypatch.setattr(training, "_learnt", learnt)
    monkeypatch.setattr(training, "_off", off)
    monkeypatch.setattr(training, "_spoilt", lambda held: ("spoilt", held))
    monkeypatch.setattr(training, "set_confidence", lambda *given: noted.append(given))
    monkeypatch.setattr(training, "composed", lambda wanted: ("composed", wanted))
    monkeypatch.setattr(training, "write_both", lambda *given: noted.append(given))
    out, films = tmp_path / "mine.onnx", [Path("a.mp4"), Path("b.mp4")]
    facts = training.teach_on_videos(films, "mediapipe", out, QUIET, plan)
    work = tmp_path / "mine.onnx.work"
    wanted = training.Wanted((Path("learnt0"), Path("learnt1")), tuple(people[:2]), 0, plan)
    held = training.Wanted((Path("held0"), Path("held1")), (people[2],), 0, plan)
    assert noted == [
        (films, "mediapipe", work, QUIET),
        (work, plan, QUIET),
        (wanted, work / "learnt.pt", QUIET),
        ("shipped", held),
        ("mean", held),
        ("mean", ("spoilt", held)),
        ("mean", ("composed", wanted._replace(at=7)), work, out),
    ]
    assert facts == {
        "model": str(out),
        "verdict": "joints 6.0 -> 4.0 % of the stature off at the films' ends, "
        "5.0 -> 5.1 % of made-up people",
        "film": (0.06, 0.04),
        "made_up": (0.05, 0.051),
    }
    offs["mean"] = (0.07, 0.05)
    with pytest.raises(TrainingError, match=r"nothing is written: joints 6\.0 -> 7\.0"):
        training.teach_on_videos(films, "mediapipe", out, QUIET, plan)
    assert noted[-1] == ("mean", held)


def looking(training: Any, monkeypatch: pytest.MonkeyPatch, *counts: tuple[int, int]) -> list[Any]:
    """Films that give so many examples to learn from, and held back."""
    left, noted = list(counts), list[Any]()

    def through(film: Path, teacher: str, folder: Path, tell: Any) -> Any:
        tell(0.5)
        noted.append((film, teacher, folder))
        learnt, held = left.pop(0)
        return training.Looked(Path(str(learnt)), Path(str(held)))

    monkeypatch.setattr(training, "looked_through", through)
    monkeypatch.setattr(training, "PictureStore", lambda folders: range(int(folders[0].name)))
    return noted


def test_each_film_is_looked_through_into_a_folder_of_its_own(
    training: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    noted = looking(training, monkeypatch, (20, 5), (30, 7))
    films = [Path("x/one.mp4"), Path("y/two.mov")]
    found = training._looked(films, "mediapipe", Path("work"), QUIET)
    assert found == [(Path("20"), Path("5")), (Path("30"), Path("7"))]
    assert noted == [
        (films[0], "mediapipe", Path("work/film0_one")),
        (films[1], "mediapipe", Path("work/film1_two")),
    ]


@pytest.mark.parametrize("counts", [((49, 5), (0, 8)), ((30, 6), (20, 5))])
def test_too_few_examples_are_counted_and_refused(
    training: Any, monkeypatch: pytest.MonkeyPatch, counts: Any
) -> None:
    """At least 50 to learn from and 12 held back."""
    looking(training, monkeypatch, *counts)
    total = sum(counts[0]) + sum(counts[1])
    due = f"^the teacher saw a person in {total} frames: name videos of more"
    with pytest.raises(TrainingError, match=due):
        training._looked([Path("a.mp4"), Path("b.mp4")], "mediapipe", Path("work"), QUIET)


def test_made_up_people_are_others_than_those_who_are_held_back(
    training: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    pool_here(monkeypatch)
    monkeypatch.setattr(training, "draw", lambda part: part)
    own, anny, held_back = training._drawn(Path("w"), training.Plan(300, 150, 40), QUIET)
    assert own == (Path("w/own"), 30_000_000, 300, False)
    assert anny == (Path("w/anny"), 30_000_000, 150, True)
    assert held_back == (Path("w/held_back"), 30_000_300, 40, False)
    own, held_back = training._drawn(Path("w"), training.Plan(3, 0, 2), QUIET)
    assert (own.folder.name, held_back.folder.name) == ("own", "held_back")


class Stored:
    """Examples of which any is drawn by a number that follows from the generator."""

    def __init__(self, name: str, count: int = 1000) -> None:
        self.name, self.count = name, count

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, at: int) -> tuple[str, int]:
        return self.name, at

    def any(self, rng: np.random.Generator) -> tuple[str, int]:
        return self[int(rng.integers(self.count))]


def composing(training: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A composite is what it is made of."""
    monkeypatch.setattr(training, "_opened", lambda folders: Stored(folders[0].name))
    monkeypatch.setattr(training, "_backdrops", lambda plan: Stored(f"backdrops{plan.backdrops}"))
    monkeypatch.setattr(
        training,
        "composite",
        lambda example, other, backdrop, rng: (example, other(), backdrop(), rng),
    )


def test_a_batch_is_half_of_films_before_people_and_backdrops_that_are_made_up(
    training: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    composing(training, monkeypatch)
    plan = training.Plan(backdrops=5, batch=400)
    wanted = training.Wanted((Path("films"),), (Path("people"),), 3, plan)
    found, again = training.composed(wanted), training.composed(wanted)
    assert len(found) == 400
    assert [one[:3] for one in found] == [one[:3] for one in again]
    other = training.composed(wanted._replace(at=4))
    assert [one[:3] for one in found] != [one[:3] for one in other]
    share = np.mean([example[0] == "films" for example, *_ in found])
    assert share == pytest.approx(0.5, abs=0.07)
    assert {example[0] for example, *_ in found} == {"films", "people"}
    assert {(a[0], b[0]) for _, a, b, _ in found} == {("people", "backdrops5")}
    rng = np.random.default_rng([3, 83])
    assert found[0][0][0] == ("films" if rng.random() < 0.5 else "people")
    assert found[0][0][1] == rng.integers(1000)


def learning(
    training: Any, monkeypatch: pytest.MonkeyPatch, batches: int, at: int
) -> tuple[Any, list[Any], list[int]]:
    """What is learnt from, and what is kept, of a work that is taken up at a batch."""
    pool_here(monkeypatch)
    noted, kept = list[Any](), list[int]()

    def resumed(work: Any, path: Path) -> Any:
        assert (work, path) == (("begun", "network", ["heads", "trunk"]), Path("learnt.pt"))
        return SimpleNamespace(batch=at)

    def learnt_from(work: Any, shown: Any, rate: float, share: float) -> Any:
        noted.append((work.batch, shown, rate, share))
        return SimpleNamespace(batch=work.batch + 1)

    network = SimpleNamespace(heads=lambda: "heads", trunk=lambda: "trunk")
    monkeypatch.setattr(training, "_shipped", lambda: network)
    monkeypatch.setattr(
        training, "begun", lambda one, paces: ("begun", "network" if one is network else "", paces)
    )
    monkeypatch.setattr(training, "resumed", resumed)
    monkeypatch.setattr(training, "composed", lambda wanted: wanted.at)
    monkeypatch.setattr(training, "learnt_from", learnt_from)
    monkeypatch.setattr(training, "keep", lambda work, path: kept.append(work.batch))
    wanted = training.Wanted((), (), 0, training.Plan(batches=batches))
    return training._learnt(wanted, Path("learnt.pt"), QUIET), noted, kept


def test_the_rate_rises_over_twenty_batches_falls_to_nothing_and_work_is_kept(
    training: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    work, noted, kept = learning(training, monkeypatch, 130, 0)
    assert work.batch == 130
    assert kept == [50, 100, 130]
    assert [shown for _, shown, _, _ in noted] == list(range(130))
    rates = {at: rate for at, _, rate, _ in noted}
    assert rates[0] == pytest.approx(0.5 / 20)
    assert rates[9] == pytest.approx(0.5 * 10 / 20)
    assert rates[65] == pytest.approx(0.5 / 2)
    assert rates[129] == pytest.approx(0.5 / 130)
    shares = {at: share for at, _, _, share in noted}
    assert [shares[at] for at in (0, 1, 9, 48, 60)] == pytest.approx(
        [1.0, 1 / 2, 1 / 10, 1 / 49, 1 / 50]
    )


def test_work_that_was_kept_goes_on_where_it_was(
    training: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, noted, kept = learning(training, monkeypatch, 33, 31)
    assert [(at, shown) for at, shown, _, _ in noted] == [(31, 31), (32, 32)]
    assert kept == [33]


def test_films_are_judged_as_they_are_and_made_up_people_before_backdrops(
    training: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    composing(training, monkeypatch)
    monkeypatch.setattr(training, "_opened", lambda folders: Stored(folders[0].name, 3))
    monkeypatch.setattr(training, "_plain", lambda example: ("plain", *example))
    monkeypatch.setattr(training, "_mean_off", lambda network, shown: (network, shown))
    held = training.Wanted((Path("films"),), (Path("people"),), 0, training.Plan(backdrops=5))
    (network, films), (same, people) = training._off("network", held)
    assert (network, same) == ("network", "network")
    assert films == [("plain", "films", at) for at in range(3)]
    assert [one[0] for one in people] == [("people", at) for at in range(3)]
    rng = np.random.default_rng(89)
    for _, other, backdrop, _ in people:
        assert other == ("people", rng.integers(3))
        assert backdrop == ("backdrops5", rng.integers(1000))


def test_an_example_of_a_film_keeps_its_picture_and_joints_at_its_border_are_outside(
    training: Any,
) -> None:
    body = np.arange(128 * 128 * 4).reshape(128, 128, 4).astype(np.uint8)
    outline = np.zeros((128, 128), np.uint8)
    outline[3, 5] = 1
    joints = np.full((15, 2), 64.0, np.float32)
    joints[:5] = [(0, 9), (9, 0), (128, 9), (9, 128), (127.9, 0.1)]
    found = training._plain(
        SimpleNamespace(
            body=body, outline=outline, joints_px=joints, facing=np.ones(2), stature_px=77.0
        )
    )
    assert (found.picture == body[..., :3]).all()
    assert np.argwhere(found.outline == 255).tolist() == [[3, 5]]
    assert np.argwhere(found.outline).tolist() == [[3, 5]]
    assert (found.mask == 128).all(), "what a recorded silhouette is worth is not known"
    assert found.inside.tolist() == [False] * 4 + [True] * 11
    assert (found.stature_px, found.nobody) == (77.0, False)
    assert (found.joints_px == joints).all()
    assert (found.facing == 1).all()


def test_a_joint_that_is_far_off_counts_three_tenths_and_one_that_is_not_seen_nothing(
    training: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        training.landmark_loss, "joints_off", lambda _, group: np.array(group)[:, None]
    )
    shown: Any = [0.1] * 64 + [0.2, np.nan, 0.5]
    assert training._mean_off("network", shown) == pytest.approx((6.4 + 0.2 + 0.3) / 66)
