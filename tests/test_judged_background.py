"""Which background is taken, held against a room of which one is known to be wrong."""

from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from test_own_landmarks import RIG

from common.config.part_settings import SilhouetteSettings
from common.raster.similarity import Mask
from common.video.decoding import Image
from synth.motion.motions import MOTION, performance
from synth.person.people import person
from synth.picture.render import render
from viewer.background.background import Background, learn
from viewer.background.occluded_background import learn_around
from viewer.room.judged_background import best_of
from viewer.room.room_people import AROUND, looked_at
from viewer.silhouette import silhouette

EMPTY = SilhouetteSettings()


@lru_cache(maxsize=1)
def film() -> tuple[Image, list[Image], list[Mask]]:
    """The empty room, then frames of a movement, and where the person is in each."""
    someone = person(4321)
    motion = performance(someone, "walk_sideways", 3)
    shots = list(render(someone, motion, RIG, 77, 3))
    shown = [shot for shot, phase in zip(shots, motion.phase, strict=True) if phase == MOTION][::4]
    return shots[0].frame1, [shot.frame1 for shot in shown], [shot.mask1 for shot in shown]


def test_a_background_with_somebody_in_it_gives_way_to_the_empty_room() -> None:
    empty, frames, _ = film()
    right, wrong = learn([empty]), learn(frames[:1])
    looks = looked_at(frames)
    alone = [[[lambda: wrong], [lambda: right]], [[lambda: right], [lambda: wrong]]]
    together = [[[lambda: wrong, lambda: right]], [[lambda: right, lambda: wrong]]]
    for groups in (*alone, *together):
        assert best_of(groups, frames, looks, EMPTY) is right


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
