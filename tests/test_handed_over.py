"""What an integrator leaves to its successor, and what that makes of it."""

from pathlib import Path

import msgspec

from calibration.gate.moved_cameras import AS_IT_WAS, MovedCameras
from common.body.body import rest_pose
from common.body.proportions import thesis_bdp
from common.bus.control_messages import Ended
from common.config.settings import Settings
from common.method import METHODS
from common.rig.camera import paper_rig
from common.rig.upright import Shift
from integrator import merge_state
from integrator.handed_over import NAME, Estate
from integrator.measuring.known_body import Measured, Unmeasured
from integrator.person import Following, Posed, Waiting
from integrator.pose import smoothing

RIG = paper_rig((160, 120), (200.0, 200.0), (4.5, 4.5))
FRESH = merge_state.init(None, 1 / 15, Settings(), METHODS["default"])
BODY = Measured(thesis_bdp(1.6), (0.0, 0.9, 2.0))
KNOWN = FRESH._replace(rig=RIG, person=Waiting(BODY), numbered=70)


def test_a_successor_knows_body_rig_and_count_and_begins_its_poses_anew(tmp_path: Path) -> None:
    smooth, found = smoothing.init(17, 1 / 15), Posed(rest_pose(), ("facade", "flank"))
    person = Following(BODY, found, smooth, doubted=3)
    Estate(tmp_path).leave(KNOWN._replace(person=person, calibration=2), 0.1, 9.0)
    estate = Estate(tmp_path)
    taken = estate.taken_up(FRESH)
    assert (taken.person, taken.rig, taken.numbered) == (Waiting(BODY), RIG, 70)
    assert (taken.calibration, estate.late_s) == (2, 0.1)


def test_a_successor_knows_who_has_ended(tmp_path: Path) -> None:
    """They do not say it again, and would be waited for in vain."""
    over = (Ended(viewer=2, frames=330),)
    Estate(tmp_path).leave(KNOWN, 0.0, 9.0, over)
    estate = Estate(tmp_path)
    estate.taken_up(FRESH)
    assert estate.over == over


def test_a_successor_knows_when_the_run_began_at_once(tmp_path: Path) -> None:
    """Its viewers may have died with the one before: nobody else could tell it."""
    estate = Estate(tmp_path)
    estate.leave(KNOWN, 0.0, 9.0)
    estate.leave(KNOWN, 0.0, 9.1, start_s=8.5)
    successor = Estate(tmp_path)
    successor.taken_up(FRESH)
    assert successor.start_s == 8.5


def test_nothing_is_left_before_anything_is_known_and_nothing_twice(tmp_path: Path) -> None:
    estate = Estate(tmp_path)
    estate.leave(FRESH, 0.0, 9.0)
    assert not (tmp_path / NAME).exists()
    estate.leave(KNOWN, 0.0, 9.5)
    (tmp_path / NAME).unlink()
    estate.leave(KNOWN._replace(numbered=71), 0.0, 20.0)
    assert not (tmp_path / NAME).exists()
    estate.leave(KNOWN, 0.2, 20.0)
    (tmp_path / NAME).unlink()
    estate.leave(KNOWN, 0.3, 20.5)
    assert not (tmp_path / NAME).exists(), "within the same second"
    estate.leave(KNOWN, 0.3, 21.1)
    assert (tmp_path / NAME).exists()
    Estate(None).leave(KNOWN, 0.0, 9.0)


def test_a_body_that_has_just_been_measured_is_left_at_once(tmp_path: Path) -> None:
    """Who is killed within the second would else have the person stand in a T again."""
    estate, measuring = Estate(tmp_path), Unmeasured(BODY.bdp)
    estate.leave(KNOWN._replace(person=Waiting(measuring)), 0.0, 9.0)
    assert Estate(tmp_path).taken_up(FRESH).person.body == measuring
    estate.leave(KNOWN, 0.0, 9.1)
    assert Estate(tmp_path).taken_up(FRESH).person.body == BODY


def test_what_cannot_be_read_is_as_if_nothing_were_left(tmp_path: Path) -> None:
    (tmp_path / NAME).write_bytes(msgspec.msgpack.encode({"bdp": 3}))
    assert Estate(tmp_path).taken_up(FRESH) == FRESH


def test_where_the_cameras_stand_is_where_the_rig_that_was_left_had_them(tmp_path: Path) -> None:
    """A successor takes them for unmoved until its viewers say otherwise."""
    moved = MovedCameras((Shift(9.0, 0.0, 0.0), AS_IT_WAS), (Shift(3.0, 1.0, 0.5), AS_IT_WAS))
    Estate(tmp_path).leave(KNOWN._replace(stands=moved), 0.0, 9.0)
    taken = Estate(tmp_path).taken_up(FRESH).stands
    assert taken.now == taken.of_rig == moved.of_rig
    assert taken.moved == ()


def test_without_a_folder_or_a_file_nothing_is_taken_up(tmp_path: Path) -> None:
    for folder in (None, tmp_path, tmp_path / "none"):
        estate = Estate(folder)
        assert estate.taken_up(FRESH) is FRESH
        assert (estate.late_s, estate.over, estate.start_s) == (0.0, (), None)


def test_where_nothing_can_be_written_the_run_goes_on(tmp_path: Path) -> None:
    Estate(tmp_path / "none").leave(KNOWN, 0.0, 9.0)
