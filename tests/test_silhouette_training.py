"""Learning silhouettes: what is taught, and what is refused."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from drawn_pool import Draws, pool_here
from rich.console import Console

from lab.training import silhouette_training
from lab.training.silhouette_training import (
    Examples,
    LabelledVideo,
    examples_of,
    films,
    fitted,
    train_silhouettes,
)
from lab.training.training import TrainingError
from synth.motion.motions import EMPTY, MOTION, POSTURES, performance
from synth.person.people import person
from synth.picture.render import Shot
from viewer.silhouette.boundary_features import FEATURES
from viewer.silhouette.pixel_classifier import load, log_odds, save, shipped


def test_a_network_learns_a_feature_that_tells() -> None:
    """The third feature says it; features that never change do no harm."""
    rng = np.random.default_rng(3)
    features = np.zeros((4000, FEATURES), np.float32)
    features[:, :6] = rng.normal(5, 3, (4000, 6))
    taught = Examples(features, features[:, 2] > 5)
    told = log_odds(fitted(taught, 0), features) > 0
    assert np.mean(told == taught.body) > 0.95


def test_where_no_file_can_be_written_is_said_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(TrainingError, match="there is no folder"):
        train_silhouettes(tmp_path / "no" / "file.npz", 0, Console(quiet=True))


@pytest.mark.slow
def test_films_show_the_empty_room_then_somebody() -> None:
    for film in films(4, np.random.default_rng(4)):
        present = np.array([mask.any() for mask in film.masks])
        assert (len(film.frames), film.frames[0].shape) == (len(present), (240, 320, 3))
        assert np.flatnonzero(present)[0] == len(present) - silhouette_training.MOMENTS >= 8


@pytest.mark.slow
def test_what_is_learnt_is_repeatable_and_can_be_loaded(tmp_path: Path) -> None:
    one, again = examples_of(1), examples_of(1)
    assert all(np.array_equal(a, b) for a, b in zip(one, again, strict=True))
    save(fitted(one, 0), tmp_path / "learnt.npz")
    told = log_odds(load(tmp_path / "learnt.npz"), one.features) > 0
    assert np.mean(told == one.body) > 0.9


@pytest.mark.slow
def test_the_shipped_network_tells_the_pixels_of_people_it_never_saw() -> None:
    """P3: nine in ten of the doubtful ones, clothes of the wall's colour among them."""
    first = silhouette_training.PERFORMANCES
    new = [examples_of(seed) for seed in range(first, first + 3)]
    right = [(log_odds(shipped(), each.features) > 0) == each.body for each in new]
    assert np.mean(right) > 0.9


def test_scales_of_features_end_up_in_the_weights() -> None:
    """The network that was fitted says of scaled features what ours says of them as they are."""
    rng = np.random.default_rng(3)
    features = rng.normal(5, 3, (600, FEATURES)).astype(np.float32)
    features[:, 1] = 100 * features[:, 0]
    features[:, 4] = 7.0
    taught = Examples(features, features[:, 1] > 500)
    found = fitted(taught, 0)
    shifted = Examples(4 * features + 9, taught.body)
    again = log_odds(fitted(shifted, 0), shifted.features)
    told = log_odds(found, features)
    assert np.corrcoef(told, again)[0, 1] > 0.999


def test_a_small_pixel_is_body_where_half_of_it_is() -> None:
    mask = np.zeros((240, 320), np.bool_)
    mask[10, 20:22] = mask[30, 41] = True
    frame = np.zeros((240, 320, 3), np.uint8)
    frame[10, 20] = (40, 80, 120)
    found = silhouette_training._small(LabelledVideo([frame], [mask]), 2)
    assert np.argwhere(found.masks[0]).tolist() == [[5, 10]]
    assert found.frames[0].shape == (120, 160, 3)
    assert found.frames[0][5, 10].tolist() == [10, 20, 30]
    assert (found.frames[0] > 0).any(axis=2).sum() == 1


def test_a_clip_is_the_empty_room_and_fourteen_frames_of_what_follows() -> None:
    moved = performance(person(400_003), "squat", 3)
    empty = int((moved.phase == EMPTY).sum())
    draws: Any = Draws(integers=[empty + 40])
    found = silhouette_training._cut(moved, draws)
    rows = [*range(empty), *range(empty + 40, empty + 54)]
    assert draws.asked == [("integers", empty, len(moved.phase) - 16)]
    for name in ("joints_m", "bones", "angles_deg", "root_m", "phase"):
        assert np.array_equal(
            getattr(found, name), getattr(moved, name)[rows], equal_nan=name != "phase"
        )
    assert MOTION in found.phase


def coloured() -> Any:
    """Rooms whose pixels tell their row and column; the second camera's is 30 brighter."""
    rows, columns = np.indices((240, 320))
    first = np.stack([rows, columns / 2, np.full_like(rows, 60)], axis=2).astype(float)
    return SimpleNamespace(pictures=(first, first + 30))


def test_a_piece_of_clothes_is_its_own_or_about_what_is_behind_it() -> None:
    """Behind rows 100 to 119 and columns 150 to 169 of the second picture: medians 109.5 and
    79.5, + 30; times 1.1, and (1, -2, 3) off."""
    own = (1, 2, 3)
    kept: Any = Draws(random=[0.55])
    assert silhouette_training._worn(own, coloured(), kept) == own
    draws: Any = Draws(
        random=[0.549], integers=[1, 100, 150], uniform=[1.1], normal=[np.array([1.0, -2.0, 3.0])]
    )
    found = silhouette_training._worn(own, coloured(), draws)
    assert found == (int(139.5 * 1.1 + 1), int(109.5 * 1.1 - 2), int(90 * 1.1 + 3))
    assert draws.asked[1:] == [
        ("integers", 2),
        ("integers", 70, 190),
        ("integers", 110, 200),
        ("uniform", 0.8, 1.2),
        ("normal", 0, 6, 3),
    ]


def test_clothes_are_neither_black_nor_white() -> None:
    room: Any = SimpleNamespace(pictures=(np.zeros((240, 320, 3)), np.full((240, 320, 3), 255.0)))
    for view, level in ((0, 10), (1, 245)):
        draws: Any = Draws(
            random=[0.0], integers=[view, 70, 110], uniform=[1.0], normal=[np.zeros(3)]
        )
        assert silhouette_training._worn((1, 2, 3), room, draws) == (level,) * 3


def test_six_in_ten_wear_the_colours_of_the_room_trousers_first() -> None:
    someone, room = person(400_001), coloured()
    kept: Any = Draws(random=[0.6])
    assert silhouette_training._dressed(someone, room, kept) is someone
    draws: Any = Draws(
        random=[0.59, 0.0, 0.9], integers=[0, 100, 150], uniform=[1.0], normal=[np.zeros(3)]
    )
    look = silhouette_training._dressed(someone, room, draws).look
    assert look.trousers != someone.look.trousers
    assert look == someone.look._replace(trousers=look.trousers)


def test_one_of_three_frames_is_learnt_from_and_colours_of_all_that_show_a_person(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Frames 3, 4 and 6 show a person; of 3 and 6 at most PIXELS of the doubtful pixels."""
    monkeypatch.setattr(silhouette_training, "PIXELS", 3)
    places = np.array([[0, 0], [1, 2], [2, 1], [3, 3]])
    guessed = SimpleNamespace(
        places=places, features=np.arange(8.0).reshape(4, 2), mask="its own mask"
    )
    noted: list[Any] = []

    def learning(state: Any, mask: Any, frame: Any, first: Any) -> Any:
        noted.append((state, mask, int(frame[0, 0, 0]), first is guessed))
        return state[0] + 1, "colours"

    monkeypatch.setattr(silhouette_training, "learn", len)
    monkeypatch.setattr(
        "viewer.silhouette.silhouette.init", lambda model, *_: (0, 1 // (model == 8))
    )
    monkeypatch.setattr(
        "viewer.silhouette.silhouette.in_light_of", lambda state, _: (state[0], "lit")
    )
    monkeypatch.setattr("viewer.silhouette.silhouette.guess", lambda state, _, near_px: guessed)
    monkeypatch.setattr("viewer.silhouette.silhouette.learn_colours", learning)
    frames = [np.full((4, 5, 3), n, np.uint8) for n in range(8)]
    masks = [np.zeros((4, 5), np.bool_) for _ in range(8)]
    for n in (3, 4, 6):
        masks[n][2, 1] = masks[n][3, 3] = True
    masks[6][1, 2] = True
    found = list(silhouette_training._doubtful_pixels(LabelledVideo(frames, masks), Draws()))  # type: ignore[arg-type]
    assert noted == [((n, "lit"), "its own mask", frame, True) for n, frame in enumerate((3, 4, 6))]
    assert [one.body.tolist() for one in found] == [[True, True, False], [True, True, True]]
    assert found[0].features.tolist() == [[6, 7], [4, 5], [2, 3]]


def test_a_film_is_taken_of_both_cameras_and_its_pictures_are_packed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    noted: list[Any] = []

    def render(someone: Any, moved: Any, rig: Any, room_seed: int, seed: int) -> Any:
        noted.append((someone, moved, (rig.width, rig.height), room_seed, seed))
        for n in (1, 2):
            yield Shot(
                (np.full((8, 8, 3), 10 * n, np.uint8), np.full((8, 8, 3), 100 + n, np.uint8)),
                (np.full((8, 8), n == 1), np.full((8, 8), n == 2)),
            )

    def moving(_: Any, posture: str, seed: int) -> Any:
        noted.append((posture, seed))
        return "moved"

    monkeypatch.setattr(silhouette_training, "render", render)
    monkeypatch.setattr(silhouette_training, "performance", moving)
    monkeypatch.setattr(silhouette_training, "room_of", lambda seed, _: seed)
    monkeypatch.setattr(silhouette_training, "person", lambda seed: seed)
    monkeypatch.setattr(silhouette_training, "_dressed", lambda one, room, _: (one, room))
    monkeypatch.setattr(silhouette_training, "_cut", lambda moved, _: (moved, "cut"))
    packed = list[Any]()
    imencode = cv2.imencode

    def packing(kind: str, frame: Any, how: Any) -> Any:
        packed.append((kind, how))
        return imencode(kind, frame, how)

    monkeypatch.setattr(cv2, "imencode", packing)
    draws: Any = Draws(integers=[81])
    seen = films(7, draws)
    posture = POSTURES[7 % len(POSTURES)]
    assert noted == [
        (posture, 7),
        ((400_007, 300_007), ("moved", "cut"), (320, 240), 300_007, 7),
    ]
    assert draws.asked == [("integers", 75, 96)]
    assert packed == [(".jpg", [cv2.IMWRITE_JPEG_QUALITY, 81])] * 4
    assert [[int(frame.mean().round()) for frame in film.frames] for film in seen] == [
        [10, 20],
        [101, 102],
    ]
    assert [[mask.all() for mask in film.masks] for film in seen] == [[True, False], [False, True]]
    films(9, draws)
    assert noted[2] == ("free", 9)


def test_both_cameras_are_learnt_from_at_full_and_at_half_size(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(silhouette_training, "films", lambda seed, _: [seed, seed + 0.5])
    monkeypatch.setattr(silhouette_training, "_small", lambda film, share: (film, share))
    monkeypatch.setattr(
        silhouette_training,
        "_doubtful_pixels",
        lambda film, _: iter([Examples(np.array([[*film]]), np.array([film[1] == 2]))]),
    )
    found = examples_of(4)
    assert found.features.tolist() == [[4, 1], [4, 2], [4.5, 1], [4.5, 2]]
    assert found.body.tolist() == [False, True, False, True]


def test_people_are_learnt_from_one_seed_after_the_other_and_the_network_is_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked, taught = pool_here(monkeypatch), list[Any]()
    monkeypatch.setattr(silhouette_training, "PERFORMANCES", 3)
    monkeypatch.setattr(
        silhouette_training,
        "examples_of",
        lambda seed: Examples(np.full((seed - 30, 2), seed), np.ones(seed - 30, np.bool_)),
    )

    def fitting(examples: Examples, seed: int) -> Any:
        taught.append((examples.features[:, 0].tolist(), len(examples.body), seed))
        return shipped()

    monkeypatch.setattr(silhouette_training, "fitted", fitting)
    out = tmp_path / "silhouettes.npz"
    facts = train_silhouettes(out, 31, Console(quiet=True))
    assert facts == {"model": str(out), "pixels": 6}
    assert asked == [31, 32, 33]
    assert taught == [([31, 32, 32, 33, 33, 33], 6, 31)]
    features = np.random.default_rng(1).normal(0, 1, (5, FEATURES)).astype(np.float32)
    assert log_odds(load(out), features) == pytest.approx(log_odds(shipped(), features))
    with pytest.raises(TrainingError, match=f"^cannot write {tmp_path}: Is a directory"):
        train_silhouettes(tmp_path, 31, Console(quiet=True))
