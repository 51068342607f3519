"""Things that come to stay in a busy clip, held against rooms that are drawn here (T7)."""

import numpy as np
from test_background import HEIGHT, WIDTH, passer_by, room, shot, walker

from common.config.part_settings import SilhouetteSettings
from common.method import DEFAULT
from viewer.background.background import Background, learn
from viewer.background.moved_objects import AT_REST_S, Patch, patches_of
from viewer.background.occluded_background import learn_uncovered
from viewer.silhouette import silhouette
from viewer.silhouette.silhouette import patched

FPS, SPACING, FRAMES = 10.0, 10, 40
CHAIR = (slice(60, 90), slice(20, 40))


def with_chair(picture: np.ndarray) -> np.ndarray:
    picture = picture.copy()
    picture[CHAIR] = (30, 160, 200)
    return picture


def after(background: Background, patches: list[Patch], frame: int) -> np.ndarray:
    """The background that frame is held against."""
    state = silhouette.init(background, SilhouetteSettings(), DEFAULT)
    for patch in patches:
        if patch.frame <= frame:
            state = patched(state, patch)
    return state.model.centre


def test_a_chair_that_is_brought_is_room_from_then_on() -> None:
    """Otherwise it would be taken for somebody to the end of the clip."""
    bare = [passer_by(n) for n in range(FRAMES)]
    film = [shot(with_chair(p) if n >= 20 else p, 2.0, n) for n, p in enumerate(bare)]
    patches = patches_of(learn([shot(room(), 2.0, 99)]), film, SPACING, FPS)
    early, late = (after(learn([shot(room(), 2.0, 99)]), patches, k) for k in (150, 250))
    assert np.abs(early - room()).mean() < 2
    assert np.abs(late - with_chair(room())).mean() < 2


def test_somebody_who_moves_on_the_spot_is_no_thing() -> None:
    film = [shot(walker(n), 2.0, n) for n in range(FRAMES)]
    bare = learn([shot(room(), 2.0, 99)])
    assert sum(int(p.where.sum()) for p in patches_of(bare, film, SPACING, FPS)) < 0.002 * (
        HEIGHT * WIDTH
    )


def test_what_stays_for_less_is_no_thing() -> None:
    """Somebody who lies still does so for some seconds."""
    bare = [passer_by(n) for n in range(FRAMES)]
    stays = range(15, 15 + int(0.8 * AT_REST_S * FPS / SPACING))
    film = [shot(with_chair(p) if n in stays else p, 2.0, n) for n, p in enumerate(bare)]
    assert not patches_of(learn_uncovered(film), film, SPACING, FPS)


def test_a_short_clip_tells_of_no_things() -> None:
    film = [shot(with_chair(room()), 2.0, n) for n in range(30)]
    assert not patches_of(learn([shot(room(), 2.0, 99)]), film, 1, 15.0)
