"""One silhouette alone: the body goes on from where both views had it (T21)."""

from collections.abc import Iterator

import numpy as np
import pytest
from staging import Stage, between, exact, opening, silhouettes, standing

from common.body.body import JOINT_NAMES, Vector
from common.bus.messages import Body, ViewerNumber
from common.config.settings import Settings


@pytest.fixture(autouse=True, scope="module")
def exact_silhouettes() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        exact(monkeypatch)
        yield


def lone(stage: Stage, poses: list[Vector], view: int = 1) -> list[Body]:
    """What is told while only one camera is left."""
    told = []
    for pose in poses:
        masks = silhouettes(pose)
        seen = (masks[0], None) if view == 1 else (None, masks[1])
        told.append(stage.see(seen).body)
    return told


def met(*poses: Vector) -> Stage:
    """A person whom both views have measured and followed."""
    stage = Stage(settings=Settings())
    stage.show([opening()] * 5)
    stage.show(between(opening(), standing(), 6))
    stage.show(list(poses))
    return stage


def joint(body: Body, name: str) -> Vector:
    return np.array(body.joints_m[JOINT_NAMES.index(name)])


@pytest.mark.parametrize("view", [1, 2])
def test_a_view_that_was_always_alone_is_a_run_of_one_viewer(view: ViewerNumber) -> None:
    """Whether the other viewer is not there, or never says a word: the same bodies, bit for bit."""
    poses = [opening(), *between(opening(), standing(r_hip_x=30.0), 8)]
    one, two = Stage(settings=Settings(), views=(view,)), Stage(settings=Settings())
    for alone, silent in zip(lone(one, poses, view), lone(two, poses, view), strict=True):
        assert alone == silent
        assert alone.lifting is not None


def test_a_leg_that_points_to_the_camera_keeps_doing_so() -> None:
    """Its outline would be the same if it pointed away: the sign of its depth is remembered."""
    lifted = standing(r_hip_x=60.0)
    stage = met(*between(standing(), lifted, 6), lifted)
    for body in lone(stage, [lifted] * 12):
        assert (joint(body, "r_knee") - joint(body, "r_hip"))[2] > 0.0


def test_who_walks_towards_the_only_camera_left_is_followed_by_the_feet() -> None:
    stage = met(standing())
    told = lone(stage, between(standing(), standing((0.0, 0.8)), 20))
    assert told[-1].pose[2] == pytest.approx(0.8, abs=0.25)


def test_the_facing_is_not_changed_on_the_word_of_one_view() -> None:
    """Raised arms narrow the upper body as a turn would: the other view would have said no."""
    raised = standing(r_shoulder_z=20.0, l_shoulder_z=340.0)
    stage = met(standing())
    told = lone(stage, [*between(standing(), raised, 10), *[raised] * 10])
    assert {body.facing for body in told} == {("facade", "flank")}
