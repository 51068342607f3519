"""A person who is hidden behind another before one camera: predicted there, and lost elsewhere."""

from collections.abc import Sequence
from typing import Literal

import msgspec
import numpy as np
import pytest
from crowd_of_two import BLUE, RED, of_all, shown
from staging import PERIOD_S, RIG

from common.body.observation import Box, Observation
from common.bus.instant import Instant
from common.bus.messages import Body
from common.config.settings import Settings
from common.method import DEFAULT
from common.rig.camera import arrays_of, project
from integrator import merge_state
from integrator.merge_state import Start
from integrator.people import several
from integrator.people.hidden_person import ASIDE_M, HIDDEN_S, behind
from integrator.people.known_life import Places
from integrator.people.recognition import State

CAMERA = RIG.cameras[0]
FRONT_M, BACK_M, AWAY_M = (0.0, 0.8), (0.1, -0.8), (1.6, -0.8)
"""Where who is nearer to camera 1 stands, who is behind them, and beside both, (X, Z)."""
FRONT = shown(FRONT_M, (0, 0), RED)


def back(place_m: tuple[float, float] = BACK_M, track: int = 1) -> list[Observation | None]:
    return shown(place_m, (track, track), BLUE)


class Room:
    """The integrator of several people before one camera, stepped."""

    def __init__(self, views: Literal[1, 2] = 1) -> None:
        start = Start(alone=views == 1)
        self.state = State(merge_state.init(RIG, PERIOD_S, Settings(people="all"), DEFAULT, start))
        self.views, self.n = views, 0

    def see(self, *people: Sequence[Observation | None]) -> dict[int, Body]:
        """The bodies of one instant, by number."""
        now = of_all(self.n, people)
        if self.views == 1:
            now = Instant((now.views[0], None))
        self.state, merged = several.step(self.state, now)
        self.n += 1
        return {body.person: body for body in merged.bodies}

    def last(self, instants: int, *people: Sequence[Observation | None]) -> dict[int, Body]:
        """Those of the last of some instants."""
        for _ in range(instants):
            bodies = self.see(*people)
        return bodies


def number_of(bodies: dict[int, Body], place_m: tuple[float, float]) -> int:
    """Of the body that is nearest to a place."""
    off = {
        n: np.subtract(np.array(body.joints_m)[0, [0, 2]], place_m) for n, body in bodies.items()
    }
    return min(off, key=lambda n: float(np.hypot(*off[n])))


def test_who_is_hidden_behind_another_is_predicted_where_they_were_and_then_lost() -> None:
    room = Room()
    before = room.last(10, FRONT, back())
    own = number_of(before, BACK_M)
    place_m = np.array(before[own].joints_m)
    begins, lasts = room.n, round(HIDDEN_S / PERIOD_S)
    for n in (1, 2, lasts // 2, lasts - 1):
        room.n = begins + n - 1
        body = room.see(FRONT)[own]
        assert (body.status, body.views, set(body.confidence)) == ("predicted", "none", {0.0}), n
        np.testing.assert_allclose(np.array(body.joints_m), place_m, atol=0.1)
        in_first = project(CAMERA, np.array(body.joints_m))
        np.testing.assert_allclose(np.array(body.joints_px)[0], in_first, atol=1e-6)
    room.n = begins + lasts
    lost = room.see(FRONT)[own]
    assert (lost.status, lost.joints_m) == ("lost", ())


def test_where_another_view_could_see_them_or_nobody_hides_them_they_are_lost_at_once() -> None:
    for views, people, place_m in ((2, [FRONT], BACK_M), (1, [FRONT], AWAY_M), (1, [], BACK_M)):
        room = Room(1 if views == 1 else 2)
        before = room.last(10, FRONT, back(place_m))
        own = number_of(before, place_m)
        assert room.see(*people)[own].status == "lost"


def test_before_one_camera_everyone_has_a_number_at_once_in_a_room_without_known_people() -> None:
    """No other view can tell more."""
    assert sorted(Room().see(FRONT, back())) == [1, 2]


@pytest.mark.parametrize(("sure", "instants"), [(0.71, 2), (0.69, 5)])
def test_who_comes_has_a_number_soon_where_the_only_view_shows_them_surely(
    sure: float, instants: int
) -> None:
    """Else after a third of a second."""
    room = Room()
    room.see(FRONT, back())
    comes = back(AWAY_M, 2)[0]
    assert comes is not None
    assert comes.landmarks is not None
    looks = msgspec.structs.replace(comes.landmarks, confidence=(sure,) * 15)
    own = [msgspec.structs.replace(comes, landmarks=looks), None]
    counts = [len(room.see(FRONT, back(), own)) for _ in range(instants + 1)]
    assert counts == [2] * instants + [3]


def test_of_an_unsure_body_nothing_is_predicted() -> None:
    first = back()[0]
    assert first is not None
    assert first.landmarks is not None
    unsure = msgspec.structs.replace(first.landmarks, confidence=(0.35,) * 15)
    room = Room()
    own = number_of(room.last(10, FRONT, back()), BACK_M)
    body = room.last(10, FRONT, [msgspec.structs.replace(first, landmarks=unsure), None])[own]
    assert body.joints_m
    assert np.mean(body.confidence) < 0.3
    assert room.see(FRONT)[own].status == "lost"


def test_who_walks_behind_another_is_predicted_on_their_way_and_stops() -> None:
    room = Room()
    room.last(8, FRONT, back((-0.5, -0.8)))
    for n in range(6):
        before = room.see(FRONT, back((-0.5 + 0.06 * n, -0.8 - 0.06 * n)))
    own = number_of(before, (-0.2, -1.1))
    start_m = np.array(before[own].joints_m)[0]
    moved_m = np.array(room.last(10, FRONT)[own].joints_m)[0] - start_m
    assert 0.2 < moved_m[0] < 0.45  # at the same speed 0.6
    assert abs(moved_m[2]) < 0.01


def test_who_comes_out_again_has_their_own_number() -> None:
    room = Room()
    own = number_of(room.last(10, FRONT, back()), BACK_M)
    room.last(8, FRONT)
    again = room.see(FRONT, back(track=7))
    assert again[own].status in {"tracking", "measuring"}
    assert number_of(again, BACK_M) == own
    assert len(again) == 2


def person_at(x_m: float) -> Places:
    """Joints in a column, 4 m from the camera."""
    known = arrays_of(CAMERA)
    ahead_m = known.centre + 4.0 * known.R[2] + x_m * known.R[0]
    return np.asarray(ahead_m + np.linspace(-0.5, 0.5, 15)[:, None] * known.R[1])


@pytest.mark.parametrize(
    ("x_m", "by_m"),
    [(0.0, 0.0), (0.19, 0.0), (0.5, -0.3), (-0.5, 0.3), (0.2 + 1.1 * ASIDE_M, None)],
    ids=["behind", "at the edge", "right of them", "left of them", "too far"],
)
def test_a_hidden_person_is_where_another_hides_them(x_m: float, by_m: float | None) -> None:
    """The other covers .2 m to both sides of the axis at the hidden person's depth."""
    half_px, middle_px = 0.2 * CAMERA.K[0][0] / 4.0, CAMERA.K[0][2]
    box = Box(round(middle_px - half_px), round(middle_px + half_px), 20, 100)
    found_m = behind(CAMERA, RIG.width, person_at(x_m), [box])
    assert (found_m is None) == (by_m is None)
    if found_m is not None and by_m is not None:
        right = arrays_of(CAMERA).R[0]
        np.testing.assert_allclose(
            found_m - person_at(x_m), by_m * np.tile(right, (15, 1)), atol=0.02
        )


def test_outside_the_picture_and_before_nobody_no_one_is_hidden() -> None:
    whole = Box(0, RIG.width - 1, 0, RIG.height - 1)
    assert behind(CAMERA, RIG.width, person_at(0.0), [whole]) is not None
    assert behind(CAMERA, RIG.width, person_at(0.0), []) is None
    assert behind(CAMERA, RIG.width, person_at(1.7), [whole]) is None
