"""Plots: who keeps clear of whom."""

import numpy as np
import pytest

from synth.scene.plot import (
    Clash,
    Contact,
    Plot,
    later,
    refuse_clashes,
    spots,
    touching,
    walk_through,
    walked,
)
from synth.scene.script import Script, Walk

RNG = np.random.default_rng(0)


def meeting(gap_m: float, **more: object) -> tuple[Plot, Plot]:
    """Two people who walk past each other at a distance, before and after."""
    starts = np.array([[-1.0, 0.0], [1.0, gap_m]])
    before = Plot(tuple(Script(start) for start in starts), 2.0)._replace(**more)  # type: ignore[arg-type]
    after = before
    for who in (0, 1):
        ends = np.array([starts[who], starts[who] * [-1.0, 1.0]])
        after = walked(after, who, Walk(2.0, 4.0, ends))
    return before, later(after, 2.0)


def test_people_who_pass_too_close_are_refused_unless_they_touch_on_purpose() -> None:
    refuse_clashes(*meeting(0.7))
    with pytest.raises(Clash, match="too close"):
        refuse_clashes(*meeting(0.6))
    refuse_clashes(*meeting(0.3, contacts=(Contact("hug", (1, 0), 2.0, 4.0),)))
    with pytest.raises(Clash):
        refuse_clashes(*meeting(0.3, contacts=(Contact("hug", (1, 0), 3.5, 4.0),)))
    refuse_clashes(*meeting(0.3, out=frozenset({1})))


def test_spots_are_apart_from_each_other_and_from_those_who_stay() -> None:
    grid = np.stack(np.meshgrid([0.0, 1.0, 2.0], [0.0, 5.0]), axis=-1).reshape(-1, 2)
    plot = Plot(tuple(Script(place) for place in grid[:3]), 0.0)
    found = spots(plot, [1, 2], grid[:3], 0.9, RNG)
    assert sorted(place[0] for place in found.values()) == [1.0, 2.0]
    with pytest.raises(Clash, match="no free places"):
        spots(plot, [1, 2], grid[:3], 1.1, RNG)
    away = plot._replace(out=frozenset({0}))
    assert len(spots(away, [1, 2], grid[:2], 0.9, RNG)) == 2


def test_a_walk_takes_its_time_and_touching_is_of_a_pair() -> None:
    walk = walk_through(1.0, np.array([[0.0, 0.0], [3.0, 0.0]]), RNG)
    assert 3.0 / 1.2 <= walk.to_s - 1.0 <= 3.0 / 0.85
    short = walk_through(1.0, np.array([[0.0, 0.0], [0.1, 0.0]]), RNG)
    assert short.to_s == pytest.approx(1.9)
    plot = Plot((), 0.0, contacts=(Contact("hug", (0, 2), 1.0, 2.0),))
    times = np.array([0.9, 1.0, 2.0, 2.1])
    assert touching(plot, (2, 0), times).tolist() == [False, True, True, False]
    assert not touching(plot, (0, 1), times).any()
