"""What the lifting network is trained on, piece by piece, with every draw given by hand."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from drawn_pool import Draws

from common.rig.camera import Camera, Rig, centre
from integrator.landmarks.landmark_rays import AT
from lab.training import lifting_examples as module
from lab.training.lifting_examples import INSTANT_S
from synth.picture.shown_joints import ShownJoints
from synth.picture.silhouette_examples import AT_LARGE, FPS, ORDINARY

LEVEL = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
"""A camera that looks along -z, upright."""


def camera(name: str = "cam1", focal_px: float = 300.0) -> Camera:
    K = ((focal_px, 0.0, 150.0), (0.0, focal_px, 110.0), (0.0, 0.0, 1.0))
    return Camera(name, K, LEVEL, (0.2, 1.1, 4.0))


RIG = Rig(320, 240, (camera(), camera("cam2", 310.0)))


def shown(instants: int, first: float) -> ShownJoints:
    """Everything in an instant is that instant's number, and `first`."""
    at = first + np.arange(float(instants))
    joints_px = np.tile(at[:, None, None], (1, 15, 2))
    return ShownJoints(joints_px, np.tile(at[:, None], (1, 15)), at, at)


def instants(views: list[ShownJoints], draws: Draws) -> list[Any]:
    """Number, what each view shows by its `facing_deg`, and the time since."""
    given: Any = draws
    return [
        (
            i,
            *(None if view is None else view.facing_deg for view in both),
            round(since_s / INSTANT_S),
        )
        for i, both, since_s in module._instants(views, given)
    ]


def test_a_lone_camera_shows_nothing_in_the_second_view() -> None:
    draws = Draws(random=[0.03])
    assert instants([shown(3, 10.0)], draws) == [(i, 10.0 + i, None, 1) for i in range(3)]


def test_an_instant_that_is_missing_makes_the_next_one_later_and_the_first_never_is() -> None:
    """Draws: no gap; then one of each instant but the first."""
    draws = Draws(random=[0.15, 0.029, 0.029, 0.03, 0.03])
    found = instants([shown(5, 10.0), shown(5, 20.0)], draws)
    assert found == [(0, 10.0, 20.0, 1), (3, 13.0, 23.0, 3), (4, 14.0, 24.0, 1)]


def test_one_of_two_views_may_be_gone_for_a_while() -> None:
    """From instant 2, for 3 of them, the second."""
    draws = Draws(random=[0.149, 0.9], integers=[2, 3, 1])
    found = instants([shown(7, 10.0), shown(7, 20.0)], draws)
    assert [second is None for _, _, second, _ in found] == [i in {2, 3, 4} for i in range(7)]
    assert all(first == 10.0 + i for i, first, _, _ in found)
    asked = [given for given in draws.asked if given[0] == "integers"]
    assert asked == [("integers", 7), ("integers", 5, 40), ("integers", 2)]


def test_a_person_must_be_farther_from_a_camera_than_sixty_centimetres() -> None:
    """The camera stands at z = 4 m and looks along -z."""
    for z, far in ((3.39, True), (3.41, False)):
        joints_m = np.zeros((2, 15, 3))
        joints_m[1, 4] = (5.0, -7.0, z)
        assert module._is_before(camera(), joints_m) is far


def test_what_is_known_of_a_camera_is_wrong_in_its_length_and_its_pitch() -> None:
    """Its centre is known; of a guess the errors are 12 and 10 times as great."""
    true = camera()
    for guessed, times, pitch_deg in ((False, 0.01, 0.3), (True, 0.12, 3.0)):
        draws: Any = Draws(normal=[2.0, -1.5])
        found: Any = module._as_known(true, guessed, draws)
        focal_px = 300.0 * np.exp(2.0 * times)
        assert (
            (pytest.approx(focal_px), 0.0, 150.0),
            (0.0, pytest.approx(focal_px), 110.0),
            (0.0, 0.0, 1.0),
        ) == found.K
        assert centre(found) == pytest.approx(centre(true))
        c, s = np.cos(np.radians(-1.5 * pitch_deg)), np.sin(np.radians(-1.5 * pitch_deg))
        by_hand = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ np.array(LEVEL)
        assert np.array(found.R) == pytest.approx(by_hand)
        assert found.name == "cam1"


def seeing(monkeypatch: pytest.MonkeyPatch, middle_m: Any) -> list[Any]:
    """Joints as shown, looked at as noted: the middle is where it is said."""
    noted: list[Any] = []

    def look(views: Any, rig: Rig, stature_m: float, since_s: float) -> Any:
        noted.append((views, rig, stature_m, since_s))
        if middle_m is None:
            return None
        return SimpleNamespace(middle_m=middle_m, inputs=np.arange(5.0))

    def showing(joints_m: Any, own: Camera, size: Any, stature_m: float, _: Any) -> ShownJoints:
        noted.append((own.name, size, stature_m))
        return shown(len(joints_m), own.K[0][0])

    monkeypatch.setattr(module, "look", look)
    monkeypatch.setattr(module, "shown_joints", showing)
    monkeypatch.setattr(module, "aimed", lambda joints_m, _, stature_m: joints_m / stature_m)
    return noted


def seen(alone: bool, draws: Draws, z: float = 0.0) -> module.LiftingExample:
    joints_m = np.arange(90.0).reshape(2, 15, 3) / 200 + (0.0, 0.0, z)
    given: Any = draws
    return module._seen(joints_m, RIG, 1.6, alone, given)


def test_two_cameras_are_seen_by_two_and_known_as_calibrated_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Draws: stature measured, no gap, nothing missing."""
    noted = seeing(monkeypatch, np.zeros(3))
    found = seen(False, Draws(random=[0.3, 0.15, 0.03], normal=[2.0, 1.0, 0.0, -1.0, 0.0]))
    assert found.stature_m == pytest.approx(1.6 * (1 + 2 * 0.02))
    assert noted[:2] == [("cam1", (320, 240), 1.6), ("cam2", (320, 240), 1.6)]
    (_, rig, stature_m, since_s) = noted[2]
    assert (rig.width, rig.height, stature_m) == (320, 240, found.stature_m)
    assert [each.K[0][0] for each in rig.cameras] == pytest.approx(
        [300 * np.exp(0.01), 310 * np.exp(-0.01)]
    )
    assert since_s == INSTANT_S
    assert [views[1].facing_deg for views, *_ in noted[2:]] == [310.0, 311.0]
    assert found.inputs.tolist() == [[0, 1, 2, 3, 4]] * 2
    joints_m = np.arange(90.0).reshape(2, 15, 3) / 200
    assert found.due == pytest.approx(joints_m[:, AT] / found.stature_m)


def test_a_quarter_of_lone_cameras_is_guessed_and_an_unmeasured_stature_is_more_wrong(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for chance, times in ((0.249, 0.12), (0.25, 0.01)):
        noted = seeing(monkeypatch, np.zeros(3))
        found = seen(True, Draws(random=[0.299, chance, 0.03], normal=[-2.0, 1.0, 0.0]))
        assert found.stature_m == pytest.approx(1.6 * (1 - 2 * 0.05))
        assert noted[0] == ("cam1", (320, 240), 1.6)
        (views, rig, _, _) = noted[1]
        assert [each.name for each in rig.cameras] == ["cam1", "cam1"]
        assert rig.cameras[0].K[0][0] == pytest.approx(300 * np.exp(times))
        assert views[0].facing_deg == 300.0
        assert views[1] is None


@pytest.mark.parametrize(
    ("middle_m", "z", "kept"),
    [
        ((0.0, 0.9, 1.19), 0.0, 2),
        ((0.0, 0.91, 1.21), 0.0, 1),
        (None, 0.0, 0),
        ((0, 0, 3.0), 3.2, 0),
    ],
)
def test_nothing_is_learnt_of_who_is_not_found_lies_astray_or_comes_too_near(
    monkeypatch: pytest.MonkeyPatch, middle_m: Any, z: float, kept: int
) -> None:
    """The hips lie at (0, .005, .01) and at (.225, .23, .235): 1.48 and 1.20 m from the first
    middle, 1.503 and 1.21 m from the second."""
    seeing(monkeypatch, None if middle_m is None else np.array(middle_m))
    found = seen(False, Draws(random=[0.5], normal=[0.0]), z)
    assert len(found.due) == len(found.inputs) == kept


def moving(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    noted: list[Any] = []
    angles = np.arange(12.0).reshape(4, 3)

    def course(_: Any, manner: Any, __: Any) -> Any:
        noted.append(manner)
        return angles

    def posed(measures: Any, given: Any, start: Any, leash: Any) -> Any:
        noted.append((measures, given.tolist(), start.tolist(), leash.tolist()))
        return "posed"

    def lain(given: Any, rest: Any, time_s: Any) -> Any:
        noted.append((rest.tolist(), time_s.tolist()))
        return -given

    monkeypatch.setattr(module, "course", course)
    monkeypatch.setattr(module, "posed", posed)
    monkeypatch.setattr(module, "lain", lain)
    monkeypatch.setattr(module, "fall", lambda time_s, _: time_s[0])
    monkeypatch.setattr(module, "fallen", lambda body, how: ("fallen", body, how))
    return noted


SOMEONE: Any = SimpleNamespace(measures={"stature_m": 1.7})


def test_half_move_as_they_like_and_who_does_not_fall_keeps_a_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for chance, manner in ((0.49, AT_LARGE), (0.5, ORDINARY)):
        noted = moving(monkeypatch)
        draws: Any = Draws(random=[chance, 0.15], uniform=[np.array([0.3, -0.2])])
        found: Any = module._performed(SOMEONE, draws)
        assert found == "posed"
        place, angles = [0.3, -0.2], [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]
        assert noted == [manner, (SOMEONE.measures, angles, place, [place] * 4)]
        assert ("uniform", -0.6, 0.6, 2) in draws.asked


def test_who_falls_begins_at_any_time_and_lies_as_they_usually_stood(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    noted = moving(monkeypatch)
    draws: Any = Draws(random=[0.9, 0.149], uniform=[np.array([0.3, -0.2]), 5.0])
    found: Any = module._performed(SOMEONE, draws)
    assert found == ("fallen", "posed", 5.0)
    assert noted[1][0] == [[4.5, 5.5, 6.5]] * 4
    assert noted[1][1] == pytest.approx([5.0 + i / FPS for i in range(4)])
    assert noted[2][1][3] == [-9, -10, -11]
    assert draws.asked[-1] == ("uniform", 3.0, 12.0)


def test_a_performance_is_shown_to_one_camera_and_to_two_unless_nothing_is_learnt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    noted: list[Any] = []
    joints_m = np.random.default_rng(1).normal(0, 1, (3, 20, 3))

    def seeing_it(joints: Any, rig: Any, stature_m: float, alone: bool, _: Any) -> Any:
        noted.append((joints, rig, stature_m, alone))
        return SimpleNamespace(due=[1] * (not alone))

    def about(_: Any, middle_m: Any) -> Any:
        noted.append(middle_m)
        return RIG

    someone = SimpleNamespace(measures={"stature_m": 1.7})
    monkeypatch.setattr(module, "differing", lambda _, __: someone)
    monkeypatch.setattr(module, "_performed", lambda _, __: SimpleNamespace(joints_m=joints_m))
    monkeypatch.setattr(module, "rig_about", about)
    monkeypatch.setattr(module, "_seen", seeing_it)
    (found,) = module.lifting_examples(5)
    assert found.due == [1]
    assert noted[0] == pytest.approx(joints_m[:, module.PICK[0]].mean(axis=0))
    assert [given[1:] for given in noted[1:]] == [(RIG, 1.7, True), (RIG, 1.7, False)]
    assert (noted[1][0] == joints_m[:, module.PICK]).all()
