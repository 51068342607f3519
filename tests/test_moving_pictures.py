"""A screen that plays, and trees that sway, on the walls of a room."""

import numpy as np
import pytest
from numpy.typing import NDArray

from common.rig.camera import project
from synth.motion.on_spot import on_spot
from synth.person.people import person
from synth.picture.exposure import default_rig
from synth.picture.render import render
from synth.picture.synth_room import furnished
from synth.things.moving_pictures import CUT_S, FRAME_M, MOVING, framed

SIZE = np.array([1.5, 1.2, 0.02])
ACROSS, UP = np.mgrid[0.0:1.5:0.02, 0.0:1.2:0.02].reshape(2, -1)
INSIDE = (
    (ACROSS >= FRAME_M)
    & (SIZE[0] - FRAME_M >= ACROSS)
    & (UP >= FRAME_M)
    & (SIZE[1] - FRAME_M >= UP)
)
RIG = default_rig(80, 60)


def shown(kind: str, time_s: float, salt: float = 7.0) -> NDArray[np.float64]:
    return framed(kind, np.array([60.0, 150.0, 90.0]), salt, (ACROSS, UP), SIZE, time_s)


@pytest.mark.parametrize("kind", list(MOVING))
def test_what_hangs_there_moves_from_frame_to_frame_and_its_frame_does_not(kind: str) -> None:
    """A third of its places change by 10 grey levels or more within half a second."""
    frames = np.stack([shown(kind, i / 15) for i in range(8)])
    assert (frames[:, ~INSIDE] == 45.0).all()
    assert (np.ptp(frames[:, INSIDE], axis=0).max(axis=1) > 10).mean() > 0.3
    np.testing.assert_array_equal(shown(kind, 0.4), frames[6])
    assert np.abs(shown(kind, 0.4, salt=9.0) - frames[6]).mean() > 5


def test_a_screen_cuts_from_scene_to_scene() -> None:
    """Across a cut more changes than within a scene."""

    def step(at: float) -> float:
        return float(np.abs(shown("screen", at + 0.03) - shown("screen", at - 0.03)).mean())

    cuts = [step(n * CUT_S) for n in range(1, 9)]
    within = [step((n + 0.5) * CUT_S) for n in range(1, 9)]
    assert np.median(cuts) > 2 * np.median(within)


def test_trees_sway_and_stay_where_they_are() -> None:
    """After ten seconds the mean of a second is as it was; only the leaves' places are others."""
    early, late = (
        np.mean([shown("trees", start + i / 15) for i in range(50)], axis=0) for start in (0, 10)
    )
    assert np.abs(early - late).mean() < np.abs(shown("trees", 0.0) - early).mean()


def test_a_moving_room_is_the_still_one_but_for_what_hangs_on_two_walls() -> None:
    still, moving = furnished(5, RIG), furnished(5, RIG, moving=True)
    for n in range(2):
        assert still.playing[n] == ()
        np.testing.assert_array_equal(still.at(n, 3.0), still.pictures[n])
        changed = np.zeros(60 * 80, np.bool_)
        for each in moving.playing[n]:
            changed[each.pixels] = True
        before, after = (moving.at(n, time_s).reshape(-1, 3) for time_s in (0.0, 0.7))
        np.testing.assert_array_equal(before[~changed], after[~changed])
        assert np.abs(before[changed] - after[changed]).mean() > 3
        assert 0.02 < changed.mean() < 0.3
    assert {each.thing.finish.kind for each in moving.playing[0]} <= set(MOVING)


def test_the_pixels_of_a_moving_thing_show_its_own_points() -> None:
    """Every point lies on its box, and is projected into its pixel."""
    for camera, playing in zip(RIG.cameras, furnished(8, RIG, moving=True).playing, strict=True):
        for (low, high, _), pixels, points_m, light in playing:
            assert (points_m >= low - 1e-6).all()
            assert (points_m <= high + 1e-6).all()
            assert (light > 0.2).all()
            rows, columns = np.divmod(pixels, 80)
            off = project(camera, points_m) - np.column_stack([columns + 0.5, rows + 0.5])
            assert np.abs(off).max() < 0.1


def test_behind_a_person_the_picture_moves_and_the_mask_does_not_know() -> None:
    motion = on_spot(person(3), 1)
    names = ("joints_m", "bones", "angles_deg", "root_m", "phase")
    held = motion._replace(**{name: getattr(motion, name)[[0] * 9] for name in names})
    spread = {}
    for moving in (False, True):
        shots = list(render(person(3), held, RIG, 5, 1, moving))
        assert all((shot.masks[0] == shots[0].masks[0]).all() for shot in shots)
        spread[moving] = np.std([shot.frames[0] for shot in shots], axis=0).mean(axis=2)
    mask = shots[0].masks[0]
    assert (spread[True] > 8)[~mask].mean() > 0.02
    assert (spread[False] > 8).mean() < 0.001
