"""Whether a path through a network was a performance: each bound from either side."""

import numpy as np
import pytest
from acting import standing

from common.body.body import ANGLE_INDEX
from recognizer import performance_judge
from recognizer.features import ROW_NAMES, bearings
from recognizer.forward import forward
from recognizer.path_network import SCALE, PathNetwork
from recognizer.performance_judge import (
    DRIFT,
    DRIFT_SHARE,
    LEAST_FRAMES,
    LEAST_STATES,
    MISFIT,
    RIVAL,
    event_of,
)
from recognizer.postures import Card, DensityModel

TURNS_DEG = (0.0, 40.0, 80.0, 120.0, 160.0)
"""Of a shoulder, in the five states of a posture."""


def raised(side: str, *turns_deg: float) -> np.ndarray:
    """A row for each turn of one arm."""
    rows = np.repeat(standing(1), len(turns_deg), axis=0)
    rows[:, ANGLE_INDEX[f"{side}_shoulder_x"]] = turns_deg
    return rows


def network(fit: float = 0.0) -> PathNetwork:
    """Two postures that raise either arm, through the same turns."""
    mean = np.stack([bearings(raised(side, *TURNS_DEG)) for side in "rl"])
    mean[..., -3:] = 0.0
    variance = np.full_like(mean, 0.05)
    return PathNetwork(
        DensityModel(
            names=("right", "left"),
            start=np.full((2, 5), 0.2),
            transition=np.full((2, 5, 5), 0.2),
            card=Card(recognizer="default", topology="ergodic", seed=0,
                      sequences={"right": 1, "left": 1}, frames=9, performers=()),
            mean=mean,
            variance=variance,
            rest_mean=mean[0, 0],
            rest_variance=np.full(27, 0.05),
            fit=np.full(2, fit),
        )
    )  # fmt: skip


OVER = np.array([40, 3, 0, 54])
WHOLE = raised("r", *np.repeat(TURNS_DEG, 3))


def test_a_whole_performance_is_told_as_the_path_has_it() -> None:
    event = event_of(network(), OVER, WHOLE)
    assert event is not None
    assert event[:3] == ("right", 40, 54)
    assert event.times == 3
    other = event_of(network(), np.array([1, 0, 0, 9]), raised("l", *np.repeat(TURNS_DEG, 2)))
    assert other is not None
    assert other[:3] == ("left", 1, 9)
    assert other.times == 1, "once at least"


def test_the_posterior_is_its_share_of_all_that_hold_and_of_one_that_fits_too_badly() -> None:
    made = network(fit=20.0)
    model = made.model
    logs = model.log_emission(WHOLE)
    total = forward(model.start, model.transition, logs)[0]
    filler = (20.0 - MISFIT) * len(WHOLE)
    event = event_of(made, OVER, WHOLE)
    assert event is not None
    odds = np.exp(SCALE * (total - filler))
    assert event.posterior == pytest.approx(odds / (1.0 + odds))


@pytest.mark.parametrize(("frames", "told"), [(LEAST_FRAMES - 1, False), (LEAST_FRAMES, True)])
def test_a_twitch_is_no_performance(frames: int, told: bool) -> None:
    rows = raised("r", *np.linspace(0.0, 160.0, frames))
    assert (event_of(network(), OVER, rows) is not None) == told


@pytest.mark.parametrize(
    ("turns_deg", "told"),
    [((0.0, 80.0, 160.0), True), ((0.0, 160.0), False), ((0.0, 40.0, 80.0), False)],
    ids=["three states", "two states", "not to its height"],
)
def test_a_part_of_a_posture_is_not_the_posture(turns_deg: tuple[float, ...], told: bool) -> None:
    assert LEAST_STATES == 3
    rows = raised("r", *np.repeat(turns_deg, 5))
    assert (event_of(network(), OVER, rows) is not None) == told


@pytest.mark.parametrize("by", [-0.1, 0.1])
def test_what_fits_much_worse_than_what_was_learnt_from_is_none(by: float) -> None:
    best = network().model.log_emission(WHOLE)[:, 0].max(axis=1).mean()
    event = event_of(network(fit=float(best) + MISFIT + by), OVER, WHOLE)
    assert (event is None) == (by > 0.0)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_who_travels_where_the_posture_does_not_performs_something_else(share: float) -> None:
    """And of one that does travel, so much the more may be missing."""
    for meant in (0.0, 0.5):
        made = network()
        made.model.mean[..., -1] = meant
        rows = WHOLE.copy()
        rows[:, ROW_NAMES.index("root_x") :] = 0.0
        due = meant - share * (DRIFT + DRIFT_SHARE * meant)
        step = due / np.abs(travel_of(np.arange(15.0)))
        rows[:, ROW_NAMES.index("root_z")] = np.arange(15.0) * step
        assert bearings(rows)[:, -1].mean() == pytest.approx(due)
        assert (event_of(made, OVER, rows) is not None) == (share < 1.0)


def travel_of(ahead: np.ndarray) -> float:
    """Mean of the feature of who is so far ahead in each frame."""
    rows = WHOLE.copy()
    rows[:, ROW_NAMES.index("root_x") :] = 0.0
    rows[:, ROW_NAMES.index("root_z")] = ahead
    return float(bearings(rows)[:, -1].mean())


@pytest.mark.parametrize("by", [-0.1, 0.1])
def test_a_posture_that_does_not_hold_but_fits_much_better_leaves_none(
    monkeypatch: pytest.MonkeyPatch, by: float
) -> None:
    """So many nats a frame."""
    totals = np.array([-100.0, -100.0 + (RIVAL + by) * len(WHOLE)])
    monkeypatch.setattr(performance_judge, "forward", lambda *_: totals)
    monkeypatch.setattr(performance_judge, "_holds", lambda _, p, *__: p == 0)
    event = event_of(network(), OVER, WHOLE)
    assert (event is None) == (by > 0.0)
    assert event is None or event.name == "right"
