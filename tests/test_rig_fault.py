"""What is said of a rig that is not believable: the cause, its size, and what to do."""

from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
from test_person_calibration import PAPER
from test_rig_trust import PERIOD_S, SHOWN

from calibration.gate import rig_fault
from calibration.gate.rig_fault import AGAIN, FREED, advice_on
from calibration.gate.rig_trust import Trust
from calibration.tracks.lateness import Clock
from calibration.tracks.rig_guess import LATE, PLACE


def doubted(*odd: str, late_frames: float = 0.0) -> Trust:
    return Trust(
        believed=False,
        apart_mm=90.0,
        apart_px=5.0,
        late_frames=late_frames,
        soles_mm=0.0,
        stature_m=1.75,
        facing_deg=0.0,
        motion_mm=10.0,
        moments=30,
        odd=odd,
    )


@pytest.mark.parametrize(
    ("freed", "change", "told"),
    [
        ("turned", {"yaw_2": 0.03, "pitch_2": -0.04}, "camera 2 seems turned by 3 degrees against"),
        ("focal", {"log_focal_1": 0.1, "log_focal_2": -0.2231}, "the focal lengths seem 20% wrong"),
        ("moved", {"x_2": 0.3, "z_2": -0.4}, "camera 2 seems to stand 0.5 m from where the"),
        ("floor", {"height_1": 0.1, "height_2": 0.2}, "the floor seems 0.15 m below its place"),
        ("floor", {"height_1": -0.1, "height_2": -0.3}, "the floor seems 0.20 m above its place"),
    ],
)
def test_the_fault_whose_mending_explains_most_is_told_with_its_size(
    monkeypatch: pytest.MonkeyPatch, freed: str, change: dict[str, float], told: str
) -> None:
    """Each fit is asked for with its own numbers free; this one costs ten less than the others."""
    asked: list[tuple[str, ...]] = []

    def fit(start: Any, _evidence: Any, free: Any, *_: int) -> Any:
        assert free[LATE]
        names = tuple(name for name, at in PLACE.items() if free[at])
        asked.append(names)
        guess = start.copy()
        for name, value in change.items():
            guess[PLACE[name]] += value
        own = names == tuple(name for name in PLACE if name in FREED[freed])
        return SimpleNamespace(guess=guess, cost=-10.0 * own)

    monkeypatch.setattr(rig_fault, "fitted", fit)
    monkeypatch.setattr(rig_fault, "_size", lambda *_: 0.0)
    said = advice_on(PAPER, SHOWN, PERIOD_S, doubted("apart"))
    assert said.startswith(told)
    assert said.endswith(AGAIN)
    assert len(asked) == len(FREED)


def test_a_number_more_must_explain_better(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of equal costs the fault of two numbers is told, not that of three."""

    def fit(start: Any, *_: Any) -> Any:
        return SimpleNamespace(guess=start, cost=5.0)

    monkeypatch.setattr(rig_fault, "fitted", fit)
    monkeypatch.setattr(rig_fault, "_size", lambda *_: 0.0)
    said = advice_on(PAPER, SHOWN, PERIOD_S, doubted("apart"))
    assert said.startswith("the focal lengths seem 0% wrong")


def test_a_late_view_is_told_by_frames_and_only_where_it_is_late_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(rig_fault, "_size", lambda *_: 2.0)
    said = advice_on(PAPER, SHOWN, PERIOD_S, doubted("late", late_frames=-6.26))
    assert said.startswith("view 2 is -6.3 frames late")
    again = advice_on(
        PAPER, SHOWN, PERIOD_S, doubted("late", late_frames=6.0), Clock(0.4), set_back_s=1.0
    )
    assert f"--offset {1.0 + 6.0 * PERIOD_S:.2f}" in again, (
        "an offset that is stated replaces the one before"
    )
    said = advice_on(PAPER, SHOWN, PERIOD_S, doubted("late", "apart", late_frames=-6.26))
    assert "pictures 2 times as large" in said
    believed = msgspec.structs.replace(doubted("late"), believed=True)
    assert advice_on(PAPER, SHOWN, PERIOD_S, believed) == ""


def test_of_a_motion_that_repeats_all_delays_are_named_from_the_videos_own_times() -> None:
    clock = Clock(0.4, (-0.6, 1.4))
    said = advice_on(PAPER, SHOWN, PERIOD_S, doubted("late"), clock, set_back_s=0.25)
    assert "which of -0.35, +0.65, +1.65 s" in said


@pytest.mark.parametrize(("odd", "exchanged"), [(("apart",), True), (("facing",), False)])
def test_cameras_are_exchanged_where_facings_agree_in_the_other_order(
    monkeypatch: pytest.MonkeyPatch, odd: tuple[str, ...], exchanged: bool
) -> None:
    asked: list[Any] = []

    def trust(rig: Any, *_: Any) -> Trust:
        asked.append(rig)
        return doubted(*odd)

    monkeypatch.setattr(rig_fault, "trust_of", trust)
    monkeypatch.setattr(rig_fault, "_size", lambda *_: 3.0)
    said = advice_on(PAPER, SHOWN, PERIOD_S, doubted("facing", "apart"))
    assert said.startswith("the cameras are exchanged") is exchanged
    assert asked[0].cameras == PAPER.cameras[::-1]


@pytest.mark.parametrize(("miss", "late_s"), [(0.7, 0.0), (0.7, 0.4), (0.3, 0.0), (None, 0.0)])
def test_different_people_are_asked_for_before_any_fault_of_the_cameras(
    monkeypatch: pytest.MonkeyPatch, miss: float | None, late_s: float
) -> None:
    monkeypatch.setattr(
        "calibration.gate.sight_clash.miss_at", lambda _, at: miss if at == late_s else 0.0
    )
    monkeypatch.setattr(rig_fault, "trust_of", lambda *_: doubted())
    far = msgspec.structs.replace(doubted("facing", "apart"), apart_mm=300.0)
    said = advice_on(PAPER, SHOWN, PERIOD_S, far, Clock(late_s))
    assert said.startswith("the views follow different people") == (miss == 0.7)
    assert said.startswith("the cameras are exchanged") == (miss != 0.7)
    near = advice_on(PAPER, SHOWN, PERIOD_S, doubted("facing", "apart"), Clock(late_s))
    assert near.startswith("the cameras are exchanged")
