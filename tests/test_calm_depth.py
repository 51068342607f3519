"""How far away joints are: calm while the picture is, and quick when something comes nearer."""

import numpy as np
import pytest
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from integrator.single.calm_depth import step

EYE_M = np.array([0.3, 1.0, 4.5])
PERIOD_S = 1 / 15
Places = NDArray[np.float64]


def standing() -> Places:
    """(15, 3) joints of a person on the floor."""
    pose = rest_pose()
    pose[POSE_INDEX["y"]] = 0.9
    return np.asarray(joints(body_vector(thesis_bdp(1.75)), pose))


def calmed(seen_m: Places, period_s: float = PERIOD_S) -> Places:
    """(n, 15, 3) after the filter."""
    memory, found = None, []
    for joints_m in seen_m:
        memory, calm_m = step(memory, EYE_M, joints_m, period_s)
        found.append(calm_m)
    return np.array(found)


def deeper(joints_m: Places, by_m: NDArray[np.float64]) -> Places:
    """Joints (n, 15, 3) moved along their lines of sight, (n, 15) or (n, 1) metres."""
    off_m = joints_m - EYE_M
    rays = off_m / np.linalg.norm(off_m, axis=-1, keepdims=True)
    return np.asarray(joints_m + by_m[..., np.newaxis] * rays)


def trembling(frames: int) -> Places:
    """A person who stands still, as one view has them: 8 mm of the body, 4 mm of each joint."""
    rng = np.random.default_rng(4)
    by_m = rng.normal(0.0, 0.008, (frames, 1)) + rng.normal(0.0, 0.004, (frames, 15))
    return deeper(np.repeat(standing()[np.newaxis], frames, axis=0), by_m)


def steps_mm(joints_m: Places) -> NDArray[np.float64]:
    return np.asarray(1e3 * np.linalg.norm(np.diff(joints_m, axis=0), axis=-1))


@pytest.mark.parametrize("rate_hz", [10, 15, 30, 60])
def test_who_stands_still_is_still(rate_hz: int) -> None:
    seen_m = trembling(20 * rate_hz)
    calm_m = calmed(seen_m, 1 / rate_hz)
    later = slice(2 * rate_hz, None)
    assert steps_mm(seen_m[later]).mean() > 8.0
    assert steps_mm(calm_m[later]).mean() < 1.5
    assert np.linalg.norm(calm_m[later] - standing(), axis=-1).max() < 0.012


def test_a_joint_stays_on_its_line_of_sight() -> None:
    seen_m = trembling(30)
    for seen, calm in zip(seen_m, calmed(seen_m), strict=True):
        along = np.cross(seen - EYE_M, calm - EYE_M)
        assert np.abs(along).max() < 1e-9


def test_noise_of_the_whole_body_does_not_bend_it() -> None:
    """What all joints share is taken for the body's: limbs keep their depth beside each other."""
    by_m = np.random.default_rng(2).normal(0.0, 0.012, (60, 1))
    seen_m = deeper(np.repeat(standing()[np.newaxis], 60, axis=0), by_m)
    range_m = np.linalg.norm(calmed(seen_m) - EYE_M, axis=-1)
    beside_m = range_m - range_m.mean(axis=1, keepdims=True)
    assert np.ptp(beside_m, axis=0).max() < 1e-6


def test_who_walks_towards_the_camera_is_not_left_behind() -> None:
    """1 m/s for two seconds, the legs swinging: a frame is 67 mm."""
    time_s = np.arange(30) * PERIOD_S
    seen_m = standing() + np.outer(time_s, [0.0, 0.0, 1.0])[:, np.newaxis]
    swing_m = 0.15 * np.sin(2 * np.pi * 0.9 * time_s)
    seen_m[:, 7:9, 2] += swing_m[:, np.newaxis]
    seen_m[:, 13:15, 2] -= swing_m[:, np.newaxis]
    off_mm = 1e3 * np.linalg.norm(calmed(seen_m) - seen_m, axis=-1)
    assert off_mm[5:].mean() < 10.0
    assert off_mm[5:].max() < 45.0


def test_what_is_moved_across_the_picture_may_come_nearer_at_once() -> None:
    """An arm that swings from the side to the front: its wrist is where it is seen."""
    seen_m = np.repeat(standing()[np.newaxis], 45, axis=0)
    angle = np.linspace(0.0, np.pi / 2, 15)
    wrist, shoulder = 5, 3
    seen_m[20:35, wrist] = seen_m[0, shoulder] + 0.55 * np.stack(
        [np.cos(angle), np.zeros(15), np.sin(angle)], axis=1
    )
    seen_m[35:, wrist] = seen_m[34, wrist]
    off_mm = 1e3 * np.linalg.norm(calmed(seen_m) - seen_m, axis=-1)
    assert off_mm[:, wrist].max() < 10.0
    assert np.delete(off_mm, wrist, axis=1).max() < 10.0


def test_a_limb_that_is_stretched_straight_towards_the_camera_is_followed() -> None:
    """Nothing moves in the picture: 0.4 m in half a second, along the line of sight."""
    by_m = np.zeros((40, 15))
    by_m[15:, 5] = -np.minimum(0.4, 0.4 * np.arange(1, 26) / 7)
    seen_m = deeper(np.repeat(standing()[np.newaxis], 40, axis=0), by_m)
    off_mm = 1e3 * np.linalg.norm(calmed(seen_m) - seen_m, axis=-1)
    assert off_mm[15:, 5].max() < 60.0
    assert off_mm[25:, 5].max() < 20.0
    assert np.delete(off_mm, 5, axis=1).max() < 20.0


def test_a_state_is_a_value() -> None:
    memory, _ = step(None, EYE_M, standing(), PERIOD_S)
    memory, _ = step(memory, EYE_M, standing() + 0.01, PERIOD_S)
    kept = [np.array(each) for each in memory]
    one, other = (step(memory, EYE_M, standing() + 0.05, PERIOD_S)[1] for _ in range(2))
    assert np.array_equal(one, other)
    assert all(np.array_equal(a, b) for a, b in zip(memory, kept, strict=True))


def test_one_instant_is_kalmans_filter_with_what_moves_across_the_sight() -> None:
    """Equation by equation: what may change, what is foreseen, what is far off, and the gain."""
    first_m = standing()
    memory, kept_m = step(None, EYE_M, first_m, 0.1)
    assert np.array_equal(kept_m, first_m)
    P = memory.P.copy()
    assert np.allclose(P, 0.015**2 + 0.006**2 * np.eye(15), atol=0.0)
    P[4, 4] *= 2.0
    memory = memory._replace(P=P)
    moved_m = first_m + np.linspace(-0.03, 0.05, 15)[:, None] * [1.0, 0.2, 0.0]
    moved_m[7] += 0.5 * (EYE_M - moved_m[7])
    dt_s = 0.1
    found, found_m = step(memory, EYE_M, moved_m, dt_s)

    ranges_m = np.linalg.norm(moved_m - EYE_M, axis=1)
    rays = (moved_m - EYE_M) / ranges_m[:, None]
    turn = (1.0 - np.exp(-dt_s / 0.13)) * (rays - memory.rays)
    across_m = ranges_m * np.sqrt((turn**2).sum(axis=1))
    along_m = 24.0 * np.clip(across_m - 0.04 * dt_s, 0.0, None)
    assert (along_m == 0.0).any()
    drift_m2 = 0.004**2 * dt_s
    Q = np.full((15, 15), along_m.mean() ** 2 + drift_m2)
    Q[np.diag_indices(15)] += along_m**2 + drift_m2
    R = 0.015**2 + 0.006**2 * np.eye(15)
    P = P + Q
    off_m = ranges_m - memory.range_m
    beyond_m = np.maximum(np.abs(off_m) - 3.0 * np.sqrt(np.diag(P) + np.diag(R)), 0.0)
    assert beyond_m[7] > 0.0
    jump_m = np.sign(off_m) * beyond_m
    P = P + jump_m[:, None] * jump_m
    gain = P @ np.linalg.inv(P + R)
    expected_m = memory.range_m + gain @ off_m
    assert found.range_m == pytest.approx(expected_m)
    assert np.allclose(found.P, (np.eye(15) - gain) @ P, atol=1e-9)
    assert found.rays == pytest.approx(memory.rays + turn)
    assert found_m == pytest.approx(EYE_M + rays * expected_m[:, None])
