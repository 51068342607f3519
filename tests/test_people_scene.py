"""Scenes: their people keep clear of each other, in sight, and each has a motion of their own."""

from itertools import combinations, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.rig.camera import centre, project
from synth.motion.motions import EMPTY, LOWERING, MOTION, TPOSE
from synth.person.skeleton import JOINTS
from synth.picture import render
from synth.picture.random_rig import rig_around
from synth.scene import people_scene as made
from synth.scene.floor import OUT_M, ground, way_out
from synth.scene.people_scene import (
    CLEAR_M,
    LEADS,
    TOUCHING_M,
    TRUNK,
    Scene,
    SceneSeed,
    least_m,
    refuse_collisions,
    scene,
)
from synth.scene.plot import Clash

FPS = 15.0


def scene_of(people: int, cameras: int, take: int, seed: int = 3, lasts_s: float = 7.0) -> Scene:
    rig = rig_around((64, 48), cameras, seed)
    return scene(SceneSeed(people, lasts_s, seed, take, 10 * seed + take), rig, FPS)


@pytest.fixture(scope="module")
def scenes() -> list[Scene]:
    """One of each first beat."""
    return [scene_of(2, 2, take) for take in range(1, len(LEADS) + 1)]


def touch(one: Scene, pair: tuple[int, int]) -> np.ndarray:
    """In which frames two people touch each other on purpose."""
    time_s = np.arange(len(one.parts[0].motion.phase)) / FPS
    found = np.zeros(len(time_s), np.bool_)
    for contact in one.contacts:
        if set(contact.people) == set(pair):
            found |= (time_s >= contact.from_s) & (time_s <= contact.to_s)
    return found


def test_people_are_never_closer_than_allowed(scenes: list[Scene]) -> None:
    """Any joints 12 cm, where they embrace the trunks 18 cm: measured pair by pair, frame by
    frame."""
    nearest = []
    for one in [*scenes, scene_of(3, 2, 1), scene_of(5, 2, 4, lasts_s=5.0)]:
        for pair in combinations(range(len(one.parts)), 2):
            a, b = (one.parts[who].motion.joints_m for who in pair)
            near = touch(one, pair)
            for i in range(len(a)):
                gaps = np.linalg.norm(a[i][:, None] - b[i][None], axis=2)
                if np.isfinite(gaps).all():
                    trunk = gaps[np.ix_(TRUNK, TRUNK)].min()
                    assert trunk >= TOUCHING_M if near[i] else gaps.min() >= CLEAR_M
                    nearest.append(trunk)
    assert min(nearest) < 0.4
    assert max(nearest) > 1.2


@pytest.mark.parametrize("seed", [3, 4])
def test_who_is_given_postures_performs_their_own_at_the_same_time_again_and_again(
    seed: int,
) -> None:
    """At the place of their T-pose: three people, two postures in turn."""
    given = ("squat", "raise_both_lateral")
    rig = rig_around((64, 48), 2, seed)
    one = scene(SceneSeed(3, 10.0, seed, 1, seed, postures=given), rig, FPS)
    acts = [part.motion.acts for part in one.parts]
    assert [{act.name for act in each} for each in acts] == [{given[0]}, {given[1]}, {given[0]}]
    assert [[act[1:] for act in each] for each in acts] == [[act[1:] for act in acts[0]]] * 3
    assert len(acts[0]) == 3
    for part in one.parts:
        there = part.motion.root_m[part.motion.present][:, [0, 2]]
        assert np.linalg.norm(there - there[0], axis=1).max() < 0.3
        squats = part.motion.acts[0].name == "squat"
        assert (np.nanmin(part.motion.root_m[:, 1]) < 0.75) == squats


def test_who_performs_hides_others_as_little_as_can_be() -> None:
    """The line from a camera to the farther of two passes the nearer one at three tenths of a
    metre at least, in 3 cameras: worked out by angles."""
    rig = rig_around((64, 48), 3, 5)
    one = scene(SceneSeed(3, 4.0, 5, 1, 5, postures=("squat",)), rig, FPS)
    places = [part.motion.root_m[part.motion.present][0, [0, 2]] for part in one.parts]
    for eye in (centre(camera)[[0, 2]] for camera in rig.cameras):
        for near, far in permutations(places, 2):
            ways = near - eye, far - eye
            turned = np.subtract(*(np.arctan2(*way) for way in ways))
            if np.linalg.norm(ways[0]) < np.linalg.norm(ways[1]):
                assert np.linalg.norm(ways[0]) * abs(np.sin(turned)) > 0.3


def test_bodies_that_collide_are_refused_unless_they_touch_on_purpose(scenes: list[Scene]) -> None:
    motion = scenes[0].parts[0].motion
    always = np.ones(len(motion.phase), np.bool_)
    aside = motion._replace(joints_m=motion.joints_m + np.array([0.3, 0.0, 0.0]))
    far = motion._replace(joints_m=motion.joints_m + np.array([5.0, 0.0, 0.0]))
    with pytest.raises(Clash, match="limbs collide"):
        refuse_collisions(motion, aside, ~always)
    with pytest.raises(Clash, match="trunks collide"):
        refuse_collisions(motion, motion._replace(joints_m=motion.joints_m + 0.05), always)
    refuse_collisions(motion, aside, always)
    refuse_collisions(motion, far, ~always)
    assert least_m(np.zeros((0, 20, 3)), np.zeros((0, 20, 3))) == np.inf
    assert least_m(np.zeros((1, 2, 3)), np.array([[[3.0, 4.0, 0.0], [9.0, 9.0, 9.0]]])) == 5.0


def test_an_embrace_is_close_and_a_thing_goes_from_hand_to_hand(scenes: list[Scene]) -> None:
    for name, joints, most_m in (("hug", ("neck", "neck"), 0.45), ("hand over", HANDS, 0.3)):
        one = scenes[LEADS.index(name)]
        contact = one.contacts[0]
        assert contact.name == name
        a, b = (
            one.parts[who].motion.joints_m[:, JOINTS.index(joint)]
            for who, joint in zip(contact.people, joints, strict=True)
        )
        during = slice(round(contact.from_s * FPS), round(contact.to_s * FPS))
        gap = np.linalg.norm(a - b, axis=1)
        assert np.nanmin(gap[during]) < most_m
        faces = [one.parts[who].motion.angles_deg[:, -1] for who in contact.people]
        middle = (during.start + during.stop) // 2
        assert abs((faces[0][middle] - faces[1][middle]) % 360.0 - 180.0) < 25.0


HANDS = ("r_knuckle", "r_knuckle")


def test_the_room_is_empty_then_each_is_in_a_t_pose_of_their_own(scenes: list[Scene]) -> None:
    for one in scenes:
        for someone, motion in one.parts:
            assert (motion.phase[:9] == EMPTY).all()
            if motion.phase[9] == EMPTY:
                continue
            assert motion.phase[9:30].tolist() == [TPOSE] * 14 + [LOWERING] * 6 + [MOTION]
            wrists = [motion.joints_m[12, JOINTS.index(f"{side}_wrist")] for side in "lr"]
            assert wrists[0][0] - wrists[1][0] > 0.65 * someone.measures["stature_m"]
    assert len({part.someone.seed for one in scenes for part in one.parts}) == 12


def test_without_an_opening_people_are_there_and_move_from_the_first_frame() -> None:
    rig = rig_around((64, 48), 2, 3)
    one = scene(SceneSeed(2, 4.0, 3, 3, 33, opening=False), rig, FPS)
    phases = [part.motion.phase for part in one.parts]
    assert (phases[0] == MOTION).all()
    assert all(set(phase.tolist()) <= {EMPTY, MOTION} for phase in phases)
    moved = one.parts[0].motion.joints_m
    assert np.linalg.norm(moved[25] - moved[0], axis=1).max() > 0.2, "no T-pose before"


def test_who_leaves_is_gone_and_comes_in_again(scenes: list[Scene]) -> None:
    motions = [part.motion for part in scenes[LEADS.index("leave")].parts]
    (motion,) = (one for one in motions if (one.phase[30:] == EMPTY).any())
    gone = np.flatnonzero(motion.phase == EMPTY)
    assert gone[-1] - gone[9] + 1 == len(gone) - 9, "out once"
    arms = motion.joints_m[32 : gone[9]]
    for side in "lr":
        wrist, shoulder = (JOINTS.index(f"{side}_{name}") for name in ("wrist", "shoulder"))
        assert (arms[:, wrist, 1] < arms[:, shoulder, 1] - 0.2).all(), "no T-pose any more"


def test_people_walk_forward_and_their_feet_hardly_slide(scenes: list[Scene]) -> None:
    """While a foot is down it stays: the lower ankle moves by less than the body does."""
    body, foot, ahead = [], [], []
    for motion in (part.motion for one in scenes[:2] for part in one.parts):
        ankles = np.stack([motion.joints_m[:, JOINTS.index(f"{s}_ankle")] for s in "lr"], axis=1)
        steps = np.diff(motion.root_m, axis=0)[:, [0, 2]]
        walks = np.linalg.norm(steps, axis=1) > 0.5 / FPS
        lower = ankles[:-1, :, 1].argmin(axis=1)
        rows = np.arange(len(lower))
        slid = np.linalg.norm((ankles[rows + 1, lower] - ankles[rows, lower])[:, [0, 2]], axis=1)
        body += np.linalg.norm(steps, axis=1)[walks].tolist()
        foot += slid[walks].tolist()
        yaw = np.radians(motion.angles_deg[:-1, -1])
        ahead += (steps * np.stack([np.sin(yaw), np.cos(yaw)], axis=1)).sum(axis=1)[walks].tolist()
    assert len(body) > 60
    assert np.mean(foot) < 0.45 * np.mean(body)
    assert np.mean(ahead) > 0.9 * np.mean(body)


@pytest.mark.parametrize(("people", "cameras"), [(2, 2), (3, 4), (1, 1), (2, 8)])
def test_who_stays_in_the_room_is_in_every_picture(people: int, cameras: int) -> None:
    """The pelvis, in each camera, in all frames; who comes in later or goes out is left out."""
    rig, stayed = rig_around((64, 48), cameras, 3), 0
    for part in scene_of(people, cameras, 2).parts:
        root_m = part.motion.root_m[9:]
        if (part.motion.phase[9:] == EMPTY).any() or np.abs(root_m[-1, [0, 2]]).max() > 1.5:
            continue
        stayed += 1
        for camera in rig.cameras:
            pixels = project(camera, root_m)
            assert ((pixels > 0) & (pixels < (64, 48))).all()
    assert stayed


@pytest.mark.slow
@given(st.integers(0, 50))
@settings(max_examples=8, deadline=None)
def test_a_seed_is_one_scene_and_another_is_another(seed: int) -> None:
    first, again, other = (scene_of(2, 1, take, seed, 4.0).parts[0].motion for take in (1, 1, 2))
    np.testing.assert_array_equal(first.bones, again.bones)
    assert first.bones.shape != other.bones.shape or (first.bones != other.bones).any()


def test_a_room_without_a_place_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = rig_around((64, 48), 2, 0)
    room = render.room_of(1, rig)
    small = room._replace(low=room.low * [0.1, 1.0, 0.1], high=room.high * [0.1, 1.0, 0.1])
    monkeypatch.setattr(made, "room_of", lambda *_: small)
    with pytest.raises(ValueError, match="the cameras have no place in common"):
        scene(SceneSeed(2, 4.0, 0, 1, 1), rig, FPS)


def test_the_way_out_leads_through_the_nearest_wall_but_not_into_a_camera() -> None:
    rig = rig_around((64, 48), 4, 3)
    place = ground(rig, render.room_of(1, rig))
    start = np.array([0.2, 0.1])
    low, high = place.room.low[[0, 2]], place.room.high[[0, 2]]
    walls = np.abs([*(low - start), *(high - start)])
    out = way_out(place, start)
    assert np.linalg.norm(out - start) == pytest.approx(walls.min() + OUT_M)
    in_way = place._replace(eyes_m=(start + out)[None] / 2)
    other = way_out(in_way, start)
    assert np.linalg.norm(other - start) == pytest.approx(np.sort(walls)[1] + OUT_M)
