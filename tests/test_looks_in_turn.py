"""People who are looked at in turn: what is carried on, how far, and how sure."""

import numpy as np
import pytest

from common.body.observation import Landmarks
from viewer.landmarks.landmark_window import Window
from viewer.landmarks.person_mask import LandmarkResult, PersonMask
from viewer.people.looks_in_turn import CARRIED_S, KEPT, LastLook, carried, step

DT_S = 1 / 15


def look(x_px: float, sure: float = 0.8) -> LandmarkResult:
    """A person upright; the last joint is not seen."""
    joints_px = tuple((x_px + n, 20.0 + 5.0 * n) for n in range(14))
    landmarks = Landmarks((*joints_px, (0.0, 0.0)), (*(sure,) * 14, 0.0), 30.0, 0.5)
    mask = PersonMask(np.zeros((48, 48), np.float32), Window(round(x_px), 10, 90))
    return LandmarkResult(landmarks, mask)


def after(*xs_px: float, sure: float = 0.8) -> tuple[LastLook, ...]:
    """The last looks at a person and at one who stands still."""
    looks: tuple[LastLook, ...] = ()
    for n, x_px in enumerate(xs_px):
        looks = step(looks, {3: look(x_px, sure), 5: look(200.0)}, n * DT_S)
    return looks


def test_who_is_not_due_goes_on_as_before_and_is_less_sure() -> None:
    found = carried(after(50.0, 53.0), 5, 2 * DT_S)
    assert set(found) == {3}
    shown, mask = found[3].landmarks, found[3].person
    assert found[3].carried
    assert shown is not None
    assert mask is not None
    assert [x for x, _ in shown.joints_px[:14]] == pytest.approx([56.0 + n for n in range(14)])
    assert shown.joints_px[14] == pytest.approx((3.0, 0.0)), "as the others move"
    assert shown.confidence == pytest.approx([KEPT * 0.8] * 14 + [0.0])
    assert (shown.facing_deg, shown.facing_confidence) == (30.0, KEPT * 0.5)
    assert mask.window == Window(56, 10, 90)


def test_from_one_look_alone_a_person_is_where_they_were() -> None:
    shown = carried(after(50.0), 5, DT_S)[3].landmarks
    assert shown is not None
    assert shown.joints_px[:14] == look(50.0).landmarks.joints_px[:14]  # type: ignore[union-attr]


def test_without_a_turn_all_are_looked_at() -> None:
    looks = after(50.0, 53.0)
    assert carried(looks, None, 2 * DT_S) == {}
    assert carried(looks, 9, 2 * DT_S) == {}, "whose turn it is, is not known here"
    assert set(carried(looks, 3, 2 * DT_S)) == {5}


def test_who_is_not_sure_or_was_not_looked_at_for_long_is_looked_at() -> None:
    assert carried(after(50.0, 53.0, sure=0.5), 5, 2 * DT_S) == {}
    looks = after(50.0)
    assert set(carried(looks, 5, CARRIED_S)) == {3}
    assert carried(looks, 5, CARRIED_S + 0.01) == {}


def test_what_was_carried_on_is_no_look() -> None:
    """Neither its place nor its time: the next goes on from the last true look."""
    looks = after(50.0, 53.0)
    found = carried(looks, 5, 2 * DT_S)
    later = step(looks, {**found, 5: look(200.0)}, 2 * DT_S)
    assert next(each for each in later if each.number == 3) is looks[0]
    assert step(looks, {5: look(200.0)}, 2 * DT_S)[0].number == 5, "who is not seen is forgotten"
