"""What a run says of its rig and views: what is new, once."""

import pytest
from local_bus import LocalBus
from staging import PERIOD_S, RIG

from calibration.gate.sight_clash import Clash
from common.bus.control_messages import Cameras, TurnedBack
from common.config.settings import Settings
from common.method import DEFAULT
from integrator import diagnostics, merge_state
from integrator.hearing.rig_publisher import RigPublisher
from integrator.rig import same_person

KNOWN = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)
NOBODY = merge_state.init(None, PERIOD_S, Settings(), DEFAULT)


def test_a_rig_is_told_once_it_is_known_and_once_each_time_that_it_changes() -> None:
    bus = LocalBus()
    heard, told = bus.subscribe(Cameras), RigPublisher(bus)
    changed = KNOWN._replace(calibration=1, scale_source="person")
    for state in (NOBODY, KNOWN, KNOWN, changed, changed, KNOWN):
        told.rig(state, 0.25)
    said = heard.drain()
    assert [(each.calibration, each.scale_source) for each in said] == [
        (0, "calibrated"),
        (1, "person"),
    ]
    assert {(each.rig, each.late_s) for each in said} == {(RIG, 0.25)}


def test_a_rig_that_has_a_camera_turned_back_says_which() -> None:
    bus, odd = LocalBus(), TurnedBack(3, (0.05, 0.0, 0.0), 0.06, 0.01)
    heard, told = bus.subscribe(Cameras), RigPublisher(bus)
    told.rig(KNOWN, 0.0)
    told.rig(KNOWN._replace(calibration=1), 0.0, odd)
    assert [each.odd for each in heard.drain()] == [None, odd]


def test_a_doubt_is_kept_as_it_was_first_said_until_there_is_another_rig(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    doubts = ["", "40 mm apart", "90 mm apart", "", "", "10 mm apart"]
    monkeypatch.setattr(diagnostics, "doubt", lambda _: doubts.pop(0))
    told = RigPublisher(LocalBus())
    told.rig(KNOWN, 0.0)
    assert [told.doubts(KNOWN) for _ in range(3)] == [[], ["40 mm apart"], ["40 mm apart"]]
    told.rig(KNOWN._replace(calibration=1), 0.0)
    assert told.doubts(KNOWN) == ["90 mm apart"]


def test_views_that_follow_different_people_are_told_instead_of_a_doubt_about_the_rig(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(diagnostics, "doubt", lambda _: "40 mm apart")
    pair = same_person.Pair((0, 1), Clash(is_apart=True))
    apart = KNOWN._replace(same=same_person.State((0, -1), (pair,), (0, 3), 0.2))
    told = RigPublisher(LocalBus())
    first = diagnostics.different_people(apart)
    assert told.doubts(apart) == first
    later = apart._replace(same=apart.same._replace(left_out=(0, 9)))
    assert told.doubts(later) == first, "a line for each frame"
    assert told.doubts(KNOWN) == ["40 mm apart"]


def test_news_are_new_where_they_differ_from_those_before() -> None:
    told = RigPublisher(LocalBus())
    said = [told.is_new(news) for news in ((), ("a",), ("a",), ("a", "b"), ())]
    assert said == [False, True, False, True, True]
