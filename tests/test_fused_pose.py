"""The pose of the angles that the viewers found: whom it faces, where it is, what is voted on."""

from typing import Any

import msgspec
import numpy as np
import pytest
from staging import PERIOD_S, PERSON, RIG, observation, silhouettes, standing

from common.body.body import POSE_INDEX, YAW_DEG, Vector
from common.body.observation import Facing, Observation, Search
from common.body.proportions import LOWER_LEG_HEIGHT, UPPER_LEG_HEIGHT, body_vector
from common.config.settings import Settings
from common.method import DEFAULT, PAPER, Method
from integrator import merge_state
from integrator.measuring.known_body import Known, Measured, Sample, Unknown, Unmeasured
from integrator.merge_state import State
from integrator.paper import fused_pose
from integrator.person import Following, Posed, Waiting
from integrator.pose import smoothing
from integrator.rig.best_pair import Two
from integrator.rig.body_position import scales_at


def view(number: Any, vote: Facing, width_px: float, at: tuple[float, float]) -> Observation:
    """A report that votes so, of an upper body so wide, the navel at a pixel."""
    search = Search(at, {}, False, 0.0, 0)
    made = observation(silhouettes(standing())[number - 1])
    return msgspec.structs.replace(
        made, vote=vote, upper_body_px=width_px, thresholds_px=(18.0, 22.0), search=search
    )


FIRST, SECOND = view(1, "facade", 24.0, (85.0, 61.0)), view(2, "flank", 12.0, (78.0, 63.0))


PRIOR, MEASURED = Unmeasured(PERSON), Measured(PERSON, (0.0, 0.9, 0.0))


def state(method: Method, known: Known = PRIOR, **more: Any) -> State:
    made = merge_state.init(RIG, PERIOD_S, Settings(), method)
    return made._replace(person=Waiting(known), **more)


def following(made: State, pose: Vector) -> State:
    """Somebody had a pose at the instant before."""
    found, body = Posed(pose, ("facade", "flank")), made.person.body
    assert not isinstance(body, Unknown)
    return made._replace(person=Following(body, found, smoothing.init(17, PERIOD_S)))


def posed(made: State, *seen: Observation | None, settled_at: Vector | None = None) -> Posed:
    first, second = seen
    assert not isinstance(made.person.body, Unknown)
    return fused_pose.step(made, made.person.body, Two(RIG, (first, second)), settled_at)


def faced(made: State, *seen: Observation | None) -> tuple[Facing, ...]:
    return posed(made, *seen).facing


@pytest.mark.parametrize("opening", [PRIOR, MEASURED], ids=["prior", "measured"])
@pytest.mark.parametrize("holds", [False, True])
def test_one_view_alone_decides_unless_both_have_measured_and_it_is_held(
    opening: Known, holds: bool
) -> None:
    method = msgspec.structs.replace(PAPER, held_facing=holds)
    made = state(method, opening, facing=("flank", "facade"))
    held = holds and opening is MEASURED
    assert faced(made, FIRST, None) == (("flank", "facade") if held else ("facade", "flank"))
    assert faced(made, None, FIRST) == (("flank", "facade"))
    other = state(method, opening, facing=("facade", "flank"))
    assert faced(other, SECOND, None) == (("facade", "flank") if held else ("flank", "facade"))
    assert faced(other, None, SECOND) == ("facade", "flank")


def test_the_place_is_where_the_navel_is_seen_and_the_trunk_is_upright() -> None:
    """Eq. (3) for the paper's rig: both lambda 200 px, both distances 4 m."""
    found = posed(state(PAPER), FIRST, SECOND).pose
    x1, z2, focal, far_m = 85.0 - 80.0, 78.0 - 80.0, 200.0, 4.0
    shared = focal * focal + x1 * z2
    assert found[0] == pytest.approx(x1 * (far_m * focal - z2 * far_m) / shared)
    assert found[2] == pytest.approx(z2 * (x1 * far_m + far_m * focal) / shared)
    assert found[POSE_INDEX["torso_y"]] == YAW_DEG[0]
    measured_at = np.array([0.3, 1.1, -0.2])
    placed = posed(state(PAPER), FIRST, SECOND, settled_at=measured_at).pose
    assert placed[:3] == pytest.approx(measured_at)


def test_widths_are_compared_at_one_distance_where_that_is_asked() -> None:
    """View 1 turns to the flank, 4 px below its threshold; view 2 stays it, 6 px below the other,
    but its camera is twice as near."""
    first, second = view(1, "flank", 14.0, (80.0, 60.0)), view(2, "flank", 16.0, (80.0, 60.0))
    before = standing((-2.0, 0.0))
    scales = scales_at(RIG, before[:3])
    assert scales[1] / scales[0] == pytest.approx(2.0)
    for scaled, expected in ((False, ("facade", "flank")), (True, ("flank", "facade"))):
        method = msgspec.structs.replace(PAPER, scaled_arbiter=scaled)
        made = following(state(method), before)
        assert faced(made, first, second) == expected


def asked(monkeypatch: pytest.MonkeyPatch, made: State) -> list[tuple[Any, ...]]:
    """What is voted on by two views."""
    heard: list[tuple[Any, ...]] = []

    def votes_of(*given: Any) -> list[str]:
        heard.append(given)
        return ["a vote"]

    def settled(pose: np.ndarray, *given: Any) -> np.ndarray:
        heard.append((pose.copy(), *given))
        return pose + 1.0

    monkeypatch.setattr(fused_pose, "votes_of", votes_of)
    monkeypatch.setattr(fused_pose, "settled", settled)
    made = following(made, standing(torso_x=20.0))
    pose = posed(made, FIRST, SECOND).pose
    assert pose == pytest.approx(heard[1][0] + 1.0)
    assert posed(made, FIRST, None).pose is not None
    assert len(heard) == 2, "one view alone does not vote"
    return heard


def test_both_silhouettes_vote_on_an_upright_body_whose_legs_and_navel_are_known(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    body = body_vector(PERSON)
    leg_m = body[UPPER_LEG_HEIGHT] + body[LOWER_LEG_HEIGHT]
    of, votes = asked(monkeypatch, state(DEFAULT))
    assert of == (DEFAULT, pytest.approx(leg_m), pytest.approx(leg_m), False)
    assert votes[0][POSE_INDEX["torso_x"]] == 0.0
    assert votes[2] == pytest.approx(body)
    assert votes[4] == ["a vote"]
    of, _ = asked(monkeypatch, state(DEFAULT, MEASURED))
    assert of == (DEFAULT, pytest.approx(0.9), pytest.approx(leg_m), False)


def test_a_prior_that_was_fitted_is_turned_too_and_a_measured_body_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sample = Sample(standing(), (FIRST, SECOND))
    assert asked(monkeypatch, state(DEFAULT, PRIOR._replace(samples=(sample,))))[0][3]
    measured = MEASURED._replace(samples=(sample,))
    assert not asked(monkeypatch, state(DEFAULT, measured))[0][3]


def test_the_paper_does_not_vote(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fused_pose, "settled", pytest.fail)
    assert posed(state(PAPER), FIRST, SECOND).pose.shape == (25,)
