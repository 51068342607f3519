"""Which background is taken, held against a room of which one is known to be wrong."""

from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from test_own_landmarks import RIG

from common.body.observation import Landmarks
from common.config.part_settings import SilhouetteSettings
from common.raster.similarity import Mask
from common.video.pictures import Image
from synth.motion.motions import MOTION, performance
from synth.person.people import person
from synth.picture.render import render
from viewer.background.background import Background, learn
from viewer.background.occluded_background import learn_around
from viewer.room import judged_background
from viewer.room.body_region import body_region
from viewer.room.judged_background import BESIDE, FAR, Judged, _first, _worth, best_of, fit
from viewer.room.room_people import AROUND, Look, looked_at
from viewer.silhouette import silhouette

EMPTY = SilhouetteSettings()


@lru_cache(maxsize=1)
def film() -> tuple[Image, list[Image], list[Mask]]:
    """The empty room, then frames of a movement, and where the person is in each."""
    someone = person(4321)
    motion = performance(someone, "walk_sideways", 3)
    shots = list(render(someone, motion, RIG, 77, 3))
    shown = [shot for shot, phase in zip(shots, motion.phase, strict=True) if phase == MOTION][::4]
    return shots[0].frames[0], [shot.frames[0] for shot in shown], [shot.masks[0] for shot in shown]


@pytest.mark.slow
def test_a_background_with_somebody_in_it_gives_way_to_the_empty_room() -> None:
    empty, frames, _ = film()
    right, wrong = learn([empty]), learn(frames[:1])
    looks = looked_at(frames)
    alone = [[[lambda: wrong], [lambda: right]], [[lambda: right], [lambda: wrong]]]
    together = [[[lambda: wrong, lambda: right]], [[lambda: right, lambda: wrong]]]
    for groups in (*alone, *together):
        assert best_of(groups, frames, looks, EMPTY) is right


@pytest.mark.slow
def test_each_background_is_judged_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a group all are, though the first is good."""
    empty, frames, _ = film()
    right, wrong = learn([empty]), learn(frames[:1])
    looks, begun = looked_at(frames), []
    init = silhouette.init

    def counted(background: Background, *rest: Any) -> Any:
        begun.append(background)
        return init(background, *rest)

    monkeypatch.setattr(silhouette, "init", counted)
    assert best_of([[lambda: right, lambda: wrong]], frames, looks, EMPTY) is right
    assert len(begun) == 2


def test_what_is_good_is_taken_at_once() -> None:
    """Another need not be made: that costs as much as fifty frames."""
    empty, frames, _ = film()
    right = learn([empty])

    def never() -> Background:
        raise AssertionError("a second background was made")

    assert best_of([[lambda: right], [never]], frames, looked_at(frames), EMPTY) is right


def test_the_room_around_somebody_is_known_and_behind_them_it_is_flagged() -> None:
    empty, frames, masks = film()
    regions = [look.region(empty.shape, AROUND) for look in looked_at(frames)]
    room = learn_around(frames, regions)
    off = np.abs(room.centre - empty).mean(axis=2)
    assert np.quantile(off[~room.uncertain], 0.9) < 6
    assert room.uncertain[np.all(masks, axis=0)].mean() > 0.9


PLAIN = learn([np.full((120, 160, 3), 100, np.uint8)])


def look_at(x: float, is_somebody: bool = True) -> Look:
    places = tuple((x + 2.0 * (n % 4), 10.0 + 6.0 * n) for n in range(15))
    return Look(Landmarks(places, (0.9,) * 15), is_somebody)


@pytest.mark.parametrize(
    ("worths", "good", "taken", "made"),
    [
        ((0.3, 0.7, 0.9), 0.6, 1, 2),
        ((0.6, 0.9), 0.6, 0, 1),
        ((0.3, 0.34, 0.36), 1.0, 2, 3),
        ((0.3, 0.34, 0.35), 1.0, 0, 3),
        ((0.5, 0.2), 1.0, 0, 2),
        ((0.95, 0.99), 1.0, 0, 2),
    ],
)
def test_the_likelier_one_stays_but_for_one_that_is_surely_better(
    worths: tuple[float, ...], good: float, taken: int, made: int
) -> None:
    """By more than 0.05; no more are made than until one is good."""
    tried = []

    def one_by_one() -> Any:
        for worth in worths:
            tried.append(worth)
            yield Judged(PLAIN, worth)

    assert _first(one_by_one(), good).worth == worths[taken]
    assert len(tried) == made


def test_a_fit_is_the_share_of_the_body_times_what_of_the_outline_is_the_bodys() -> None:
    """Of an outline what is far is left out; the rest counts, a door beside the body against it."""
    look = look_at(80.0)
    body, near, around = (
        body_region(look.landmarks, (120, 160), beyond) > 0 for beyond in (0.0, BESIDE, FAR)
    )
    half = body.copy()
    half[60:] = False
    assert fit(body, look) == 1.0
    assert fit(half, look) == pytest.approx(half.sum() / body.sum())
    assert fit(body | ~around, look) == 1.0
    assert fit(around, look) == pytest.approx(near.sum() / around.sum())
    mixed = half | (around & ~near)
    own = half.sum() / (half | (around & ~near)).sum()
    assert fit(mixed, look) == pytest.approx(half.sum() / body.sum() * own)
    assert fit(np.zeros((120, 160), np.bool_), look) == 0.0


def test_outlines_are_looked_for_where_each_look_has_the_body(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []

    def step(state: Any, picture: Image, near_px: tuple[float, float]) -> Any:
        asked.append((int(picture[0, 0, 0]), near_px))
        return state, silhouette.Seen(body, None, 0, 0, cut=False)

    looks = [look_at(80.0), look_at(40.0)]
    body = body_region(looks[0].landmarks, (120, 160), 0.0) > 0
    monkeypatch.setattr(silhouette, "step", step)
    pictures = [np.full((120, 160, 3), level, np.uint8) for level in (7, 9)]
    worth = _worth(PLAIN, list(zip(pictures, looks, strict=True)), EMPTY)
    middle = np.mean(looks[1].landmarks.joints_px, axis=0)
    assert [level for level, _ in asked] == [7, 9]
    assert asked[1][1] == pytest.approx(tuple(middle))
    assert worth == pytest.approx((1.0 + fit(body, looks[1])) / 2)


@pytest.mark.parametrize(
    ("shown", "judged"),
    [(5, [0, 1, 2, 3, 4]), (6, [0, 2, 4]), (11, [0, 3, 6, 9]), (0, [])],
)
def test_five_frames_at_most_of_those_with_somebody_are_judged(
    monkeypatch: pytest.MonkeyPatch, shown: int, judged: list[int]
) -> None:
    told: list[list[int]] = []

    def worth(_background: Background, pairs: Any, _settings: object) -> float:
        told.append([int(picture[0, 0, 0]) for picture, _ in pairs])
        return 0.7

    monkeypatch.setattr(judged_background, "_worth", worth)
    pictures = [np.full((2, 2, 3), n, np.uint8) for n in range(shown)]
    looks = [look_at(80.0)] * shown
    pictures.append(np.full((2, 2, 3), 99, np.uint8))
    looks.append(look_at(80.0, is_somebody=False))
    other = PLAIN._replace(uncertain=PLAIN.uncertain.copy())
    found = best_of([[lambda: PLAIN], [lambda: other]], pictures, looks, EMPTY)
    assert found is PLAIN
    assert told == ([judged] if judged else [])
