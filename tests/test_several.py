"""Several people: each has one number, and a body where they stand."""

from pathlib import Path

import msgspec
import numpy as np
import pytest
from crowd_of_two import BLUE, LEFT_M, RED, RIGHT_M, Crowd, of_all, pose_at, shown
from staging import RIG
from test_rig_agreement import turned

from calibration.gate import rig_agreement
from common.body.proportions import thesis_bdp
from common.bus.control_messages import Command
from common.bus.messages import Agreement, Body
from common.config.settings import Settings
from integrator.measuring.known_body import Measured, Unmeasured
from integrator.people import recognition, several
from integrator.people.lived_instant import KEPT_S
from integrator.people.recognition import BORN_S, State
from lab.accuracy.identity import gaps_of, presences
from runtime.offline.lockstep import Decoders, track_clip
from runtime.store.pose_arrays import poses
from runtime.unfinished.state_codec import packed, unpacked
from synth.scene.people_scene import LEAVING_TAKE
from synth.scene.scene_clips import SceneSet, write_scenes

LEFT, RIGHT = shown(LEFT_M, (0, 0), RED), shown(RIGHT_M, (1, 1), BLUE)
AFTER_BIRTH = round(BORN_S * 15) + 1


def places_m(bodies: tuple[Body, ...]) -> dict[int, tuple[float, float]]:
    """Where each stands, (X, Z), by number."""
    return {body.person: (body.joints_m[0][0], body.joints_m[0][2]) for body in bodies}


@pytest.mark.parametrize("order", [1, -1])
def test_two_people_are_two_bodies_where_they_stand(order: int) -> None:
    crowd = Crowd()
    for _ in range(8):
        bodies = crowd.see(LEFT, RIGHT, order=order)
    found = places_m(bodies)
    assert sorted(found) == [1, 2]
    by_x = sorted(found.values())
    np.testing.assert_allclose(by_x, [LEFT_M, RIGHT_M], atol=0.1)
    assert {body.status for body in bodies} <= {"tracking", "measuring"}


def test_a_person_alone_is_there_at_once_and_an_empty_room_has_one_empty_body() -> None:
    crowd = Crowd()
    assert [(body.person, body.status) for body in crowd.see()] == [(0, "empty")]
    assert [body.person for body in crowd.see(LEFT)] == [1]


@pytest.mark.parametrize("tracks", [(1, 1), (1, -1), (-1, 1)])
def test_a_second_person_must_be_shown_for_a_third_of_a_second(tracks: tuple[int, int]) -> None:
    """By one view or both: at 15 Hz the sixth instant is a third of a second after the first."""
    crowd = Crowd()
    crowd.see(LEFT)
    counts = [len(crowd.see(LEFT, shown(RIGHT_M, tracks, BLUE))) for _ in range(6)]
    assert counts == [1] * 5 + [2]


def test_numbers_stay_where_a_viewer_exchanges_its_own() -> None:
    crowd = Crowd()
    before = places_m(crowd.last(8, LEFT, RIGHT))
    after = crowd.last(8, shown(LEFT_M, (0, 1), RED), shown(RIGHT_M, (1, 0), BLUE))
    assert sorted(places_m(after)) == sorted(before)
    for number, place in places_m(after).items():
        np.testing.assert_allclose(place, before[number], atol=0.1)


def number_at(bodies: tuple[Body, ...], place_m: tuple[float, float]) -> int:
    found = places_m(tuple(body for body in bodies if body.joints_m))
    return min(found, key=lambda number: float(np.hypot(*np.subtract(found[number], place_m))))


def test_who_comes_back_has_the_number_of_before_and_who_was_away_for_long_a_new_one() -> None:
    for away_s, is_same in ((0.8 * KEPT_S, True), (1.2 * KEPT_S, False)):
        crowd = Crowd()
        number = number_at(crowd.last(8, LEFT, RIGHT), RIGHT_M)
        gone = crowd.last(round(away_s * 15), LEFT)
        assert [body.status for body in gone if body.person == number] == ["lost"] * is_same
        back = crowd.last(AFTER_BIRTH, LEFT, shown(RIGHT_M, (7, 7), BLUE))
        assert (number_at(back, RIGHT_M) == number) == is_same
        assert len({body.person for body in back}) == 2


def test_another_person_in_the_place_of_one_who_left_is_another() -> None:
    crowd = Crowd()
    number = number_at(crowd.last(8, LEFT, RIGHT), RIGHT_M)
    crowd.last(20, LEFT)
    other = crowd.last(AFTER_BIRTH, LEFT, shown(RIGHT_M, (7, 7), (80.0, 0.0, 0.0) * 2))
    assert number_at(other, RIGHT_M) == max(body.person for body in other) > number


def test_who_is_hidden_in_one_view_stays_who_they_are() -> None:
    crowd = Crowd()
    number = number_at(crowd.last(8, LEFT, RIGHT), RIGHT_M)
    hidden = crowd.last(20, LEFT, shown(RIGHT_M, (1, -1), BLUE))
    (own,) = (body for body in hidden if body.person == number)
    assert own.seen == (True, False)
    back = crowd.last(3, LEFT, shown(RIGHT_M, (1, 5), BLUE))
    (own,) = (body for body in back if body.person == number)
    assert own.seen == (True, True)
    assert len(back) == 2


def test_one_person_whom_each_view_took_for_another_is_one_again() -> None:
    crowd = Crowd()
    crowd.last(20, LEFT, shown(RIGHT_M, (1, -1), BLUE))
    state = crowd.state
    (_, one) = state.lives
    double = one._replace(number=3, tracks=(-1, 9), views_s=(-1.0, one.seen_s))
    crowd.state = state._replace(lives=(*state.lives, double), fresh=4)
    bodies = crowd.last(10, LEFT, shown(RIGHT_M, (1, 9), BLUE))
    assert sorted(body.person for body in bodies) == [1, 2]


def test_a_saved_state_goes_on_to_the_same_bodies() -> None:
    crowd = Crowd()
    crowd.last(6, LEFT, RIGHT)
    again = Crowd()
    again.state, again.n = unpacked(packed(crowd.state), State), crowd.n
    assert again.see(LEFT, RIGHT) == crowd.see(LEFT, RIGHT)


def test_a_new_rig_is_everybodys() -> None:
    crowd = Crowd()
    crowd.last(6, LEFT, RIGHT)
    rig = turned(RIG, 5.0)
    room = crowd.state.room._replace(rig=rig, calibration=1)
    state = several.with_room(crowd.state, room)
    assert [life.state.rig for life in state.lives] == [rig, rig]
    assert [life.number for life in state.lives] == [1, 2]


def test_the_rooms_agreement_is_of_the_person_who_agrees_best() -> None:
    """The lowest number, the room's own person, may have another's observation in a view; a wrong
    rig contradicts everybody."""
    room = Crowd().state.room
    agreement = Agreement(apart_mm=9.0, soles_mm=0.0, facing_deg=0.0, motion_mm=9.0, believed=0.2)
    doubted, believed = (
        room._replace(agreement=rig_agreement.State(told=one))
        for one in (agreement, msgspec.structs.replace(agreement, believed=0.9))
    )
    for states in ((room, doubted, believed), (believed, doubted, room)):
        assert several._agreed(room, states).agreement is believed.agreement
    assert several._agreed(room, (doubted, room)).agreement is doubted.agreement
    assert several._agreed(room, (room,)) == room


def test_the_guide_is_of_the_first_person_in_sight() -> None:
    crowd = Crowd()
    crowd.last(8, LEFT, RIGHT)
    first = number_at(crowd.see(LEFT, RIGHT), LEFT_M)
    state, merged = several.step(crowd.state, of_all(crowd.n, (LEFT, RIGHT)))
    lowest = merged.bodies[0]
    assert merged.guide.pose[:3] == pytest.approx(lowest.pose[:3], abs=0.05)
    assert lowest.person == 1
    assert first in {1, 2}
    assert state.room is state.lives[0].state


def test_a_run_that_follows_one_person_has_one_body_of_number_0() -> None:
    crowd = Crowd()
    settings = msgspec.structs.replace(crowd.state.room.settings, people=1)
    crowd.state = State(crowd.state.room._replace(settings=settings))
    bodies = crowd.last(3, LEFT, RIGHT)
    assert [body.person for body in bodies] == [0]
    assert bodies[0].joints_m[0][1] == pytest.approx(pose_at(LEFT_M)[1], abs=0.1)


def test_a_command_to_measure_the_body_anew_is_for_everyone() -> None:
    crowd = Crowd()
    crowd.last(8, LEFT, RIGHT)
    state = several.commanded(crowd.state, Command(what="measure"))
    bodies = [life.state.person.body for life in state.lives]
    assert [isinstance(body, Unmeasured) and not body.samples for body in bodies] == [True] * 2
    unknown = Command(what="front")
    assert several.commanded(crowd.state, unknown) == crowd.state


def test_of_each_person_it_is_known_who_shows_them_and_whether_they_were_measured() -> None:
    crowd = Crowd()
    crowd.last(8, LEFT, RIGHT)
    one, other = crowd.state.lives
    known = Measured(thesis_bdp(1.7), (0.0, 1.0, 0.0))
    person = msgspec.structs.replace(other.state.person, body=known)
    lives = (one, other._replace(state=other.state._replace(person=person)))
    hidden = of_all(8, (LEFT, shown(RIGHT_M, (-1, 1), BLUE)), 1)
    state, merged = several.step(crowd.state._replace(lives=lives), hidden)
    there = {own.number: own for own in several.present(state, merged)}
    assert [own.measured for own in there.values()] == [False, True]
    right = number_at(merged.bodies, RIGHT_M)
    assert [one is not None for one in there[right].seen] == [False, True]
    assert [one is not None for one in there[3 - right].seen] == [True, True]


def test_of_a_run_that_follows_one_person_it_is_known_whether_they_were_measured() -> None:
    crowd = Crowd(people=1)
    for measured in (False, True):
        if measured:
            known = Measured(thesis_bdp(1.7), (0.0, 1.0, 0.0))
            person = msgspec.structs.replace(crowd.state.room.person, body=known)
            crowd.state = crowd.state._replace(room=crowd.state.room._replace(person=person))
        crowd.state, merged = several.step(crowd.state, of_all(crowd.n, (LEFT,), 1))
        crowd.n += 1
        (own,) = several.present(crowd.state, merged)
        assert (own.number, own.measured, all(own.seen)) == (0, measured, True)


def test_bodies_come_by_number_whoever_was_exchanged() -> None:
    """The one whose number was given back stands second among the lives."""
    crowd = Crowd()
    crowd.last(8, LEFT, RIGHT)
    one, other = crowd.state.lives
    swapped = (one._replace(number=other.number), other._replace(number=one.number))
    crowd.state = crowd.state._replace(lives=swapped)
    assert [body.person for body in crowd.see(LEFT, RIGHT)] == [1, 2]


def test_no_more_people_are_known_than_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recognition, "MOST", 1)
    crowd = Crowd()
    crowd.see(LEFT)
    assert [body.person for body in crowd.last(2 * AFTER_BIRTH, LEFT, RIGHT)] == [1]


@pytest.mark.slow
def test_who_leaves_a_scene_and_comes_back_has_the_old_number_and_the_other_keeps_theirs(
    tmp_path: Path,
) -> None:
    """Before three cameras: one is away for 2.2 s."""
    wanted = SceneSet(2, 10.0, 1, 90_001, 3, first_take=LEAVING_TAKE)
    (clip,) = write_scenes(tmp_path, wanted, (240, 180))
    with Decoders() as decoders:
        tracked = track_clip(Settings(clip=str(clip), people="all", size="240x180"), decoders)
    with np.load(clip / "truth.npz") as truth:
        found = presences(gaps_of(poses(tracked.bodies), dict(truth)), 15)
    stayed, before, after = sorted(found, key=lambda one: (one.first > 9 or one.last < 149, one))
    assert (stayed.first, stayed.last, before.who) == (9, 149, after.who)
    assert 1.0 < (after.first - before.last) / 15 < KEPT_S
    assert stayed.number != before.number == after.number is not None
    assert min(one.share for one in found) > 0.7
