"""The angle filter, held against what a filter must do: no jump, little lag, less noise."""

import numpy as np
import pytest
from filterpy.common import Q_discrete_white_noise
from filterpy.kalman import predict, update
from hypothesis import assume, given
from hypothesis import strategies as st

from common.body.body import ANGLE_NAMES, Vector, wrapped_deg
from integrator.pose.smoothing import START_SPEED_DEG_S, Smoothing, State, init, step

PERIOD_S = 1 / 15
SWING_DEG_S = 200.0


def followed(measured: list[Vector | None], n: int = 1) -> tuple[State, Vector, Vector]:
    """Smooth angles and speeds of a whole run, (frames, n) each."""
    state, angles, speeds = init(n, PERIOD_S), [], []
    for one in measured:
        state, angle, speed = step(state, one, PERIOD_S)
        angles.append(angle)
        speeds.append(speed)
    return state, np.array(angles), np.array(speeds)


def swing(frames: int, start_deg: float = 150.0) -> Vector:
    """A steady swing of 200 degrees a second, in (-180, 180]."""
    turned = [wrapped_deg(start_deg + SWING_DEG_S * PERIOD_S * n) for n in range(frames)]
    return np.array(turned)


def wrapped(angles_deg: Vector) -> Vector:
    return (angles_deg + 180.0) % 360.0 - 180.0


def test_a_swing_across_the_seam_is_followed_without_a_jump() -> None:
    """Two whole turns at 200 deg/s: no step differs from the swing's by half of it."""
    truth = swing(60)
    assert np.abs(np.diff(truth)).max() > 300  # the seam is there
    _, angles, _ = followed([np.array([angle]) for angle in truth])
    steps = wrapped(np.diff(angles[:, 0]))
    assert np.abs(steps - SWING_DEG_S * PERIOD_S).max() < SWING_DEG_S * PERIOD_S / 2


def test_a_smooth_angle_is_near_what_was_measured_and_not_a_turn_away() -> None:
    """Whichever range the joint counts in: the left arm's 180..360 as well."""
    truth = np.concatenate([swing(30, 150.0), swing(30, 150.0) % 360.0])
    _, angles, _ = followed([np.array([angle]) for angle in truth])
    assert np.abs(angles[:, 0] - truth).max() < 15.0


def test_a_steady_swing_is_followed_with_less_than_a_frame_of_lag() -> None:
    """Constant velocity has no lag once it is settled; from a standing start it catches up."""
    truth = np.concatenate([np.full(10, 0.0), np.arange(1, 16) * SWING_DEG_S * PERIOD_S])
    _, angles, speeds = followed([np.array([angle]) for angle in truth])
    lag_frames = (truth - angles[:, 0])[10:] / (SWING_DEG_S * PERIOD_S)
    assert lag_frames.max() < 1.0
    assert abs(lag_frames[-1]) < 0.1
    assert speeds[-1, 0] == pytest.approx(SWING_DEG_S, rel=0.05)


def test_a_limb_that_is_moving_when_first_seen_is_caught_up_with_at_once() -> None:
    """Entering the picture in mid-swing: less than a third of a frame behind from the third on."""
    truth = 20.0 + np.arange(10) * SWING_DEG_S * PERIOD_S
    _, angles, speeds = followed([np.array([angle]) for angle in truth])
    assert np.abs(truth - angles[:, 0])[2:].max() < SWING_DEG_S * PERIOD_S / 3
    assert speeds[2, 0] > 0.7 * SWING_DEG_S


def test_white_noise_at_rest_loses_a_third_of_its_variance() -> None:
    random = np.random.default_rng(7)
    noise = random.normal(0.0, 4.0, (1500, len(ANGLE_NAMES)))
    _, angles, _ = followed([90.0 + row for row in noise], len(ANGLE_NAMES))
    assert np.var(angles[50:]) < 0.67 * np.var(noise[50:])
    assert np.mean(angles[50:]) == pytest.approx(90.0, abs=0.2)


def test_a_gap_of_three_frames_is_predicted() -> None:
    """The arm goes on as it went: within 10 degrees after 40 degrees unseen."""
    truth = swing(25)
    measured: list[Vector | None] = [np.array([angle]) for angle in truth]
    measured[20:23] = [None, None, None]
    _, angles, _ = followed(measured)
    assert np.abs(wrapped(angles[20:23, 0] - truth[20:23])).max() < 10.0
    assert np.abs(wrapped(angles[23:, 0] - truth[23:])).max() < 5.0


def test_stepping_the_same_state_twice_gives_the_same() -> None:
    """A state is a value."""
    state, _, _ = followed([np.array([angle]) for angle in swing(5)])
    kept = (state.x.copy(), state.P.copy() if state.P is not None else None)
    answers = [step(state, np.array([17.0]), PERIOD_S) for _ in range(2)]
    assert np.array_equal(answers[0][1], answers[1][1])
    assert np.array_equal(answers[0][2], answers[1][2])
    assert np.array_equal(state.x, kept[0])
    assert state.P is not None
    assert kept[1] is not None
    assert np.array_equal(state.P, kept[1])


def test_an_answer_can_be_changed_without_changing_the_state() -> None:
    for measured in (np.array([1.0]), None):
        state, _, _ = followed([np.array([angle]) for angle in swing(5)])
        state, angles, speeds = step(state, measured, PERIOD_S)
        angles[:], speeds[:] = 1e9, 1e9
        assert np.abs(state.x).max() < 1e4


@given(st.floats(-180.0, 180.0), st.integers(-3, 3))
def test_whole_turns_in_a_measurement_change_nothing(angle_deg: float, turns: int) -> None:
    """An angle and the same angle some turns on are one direction."""
    state, _, _ = followed([np.array([angle]) for angle in swing(5)])
    predicted = step(state, None, PERIOD_S)[1][0]
    assume(abs(wrapped_deg(angle_deg - predicted)) < 179.0)
    _, one, speed = step(state, np.array([angle_deg]), PERIOD_S)
    _, other, same_speed = step(state, np.array([angle_deg + 360.0 * turns]), PERIOD_S)
    assert other[0] - one[0] == pytest.approx(360.0 * turns, abs=1e-9)
    assert same_speed == pytest.approx(speed)


def test_each_angle_is_filtered_by_itself() -> None:
    both = np.column_stack([swing(30), np.full(30, -40.0)])
    _, angles, _ = followed(list(both), 2)
    for n in (0, 1):
        _, alone, _ = followed([row[[n]] for row in both])
        assert angles[:, n] == pytest.approx(alone[:, 0], abs=1e-9)


def test_a_longer_time_between_frames_is_a_longer_way() -> None:
    """Dropped frames: dt is what passed, not a count of frames."""
    state, _, _ = followed([np.array([10.0 * n]) for n in range(30)])
    assert step(state, None, 3 * PERIOD_S)[1][0] == pytest.approx(290.0 + 30.0, abs=0.5)


def test_nothing_is_known_before_the_first_measurement() -> None:
    state, angles, speeds = step(init(2, PERIOD_S), None, PERIOD_S)
    assert np.isnan(angles).all()
    assert np.isnan(speeds).all()
    state, angles, _ = step(state, np.array([10.0, 20.0]), PERIOD_S)
    assert angles.tolist() == [10.0, 20.0]


def test_a_long_watched_angle_is_corrected_by_kalatas_gains() -> None:
    """Kalata 1984: the steady gains that the tracking index alone determines."""
    settings = Smoothing()
    state, _, _ = followed([np.zeros(2)] * 200, 2)
    index = settings.acceleration_deg_s2 * PERIOD_S**2 / settings.noise_deg
    r = (4.0 + index - np.sqrt(8.0 * index + index**2)) / 4.0
    alpha = 1.0 - r**2
    beta = 2.0 * (2.0 - alpha) - 4.0 * np.sqrt(1.0 - alpha)
    _, angles, speeds = step(state, np.array([5.0, -2.0]), PERIOD_S)
    assert angles == pytest.approx([5.0 * alpha, -2.0 * alpha], rel=1e-6)
    assert speeds == pytest.approx([5.0 * beta / PERIOD_S, -2.0 * beta / PERIOD_S], rel=1e-6)


def test_all_angles_together_are_filtered_as_each_alone_would_be() -> None:
    rng, settings, dt_s = np.random.default_rng(3), Smoothing(), 1 / 15
    measured = np.cumsum(rng.normal(0.0, 8.0, (30, 3)), axis=0)
    state = init(3, dt_s)
    x = [np.array([angle, 0.0]) for angle in measured[0]]
    P = np.diag([settings.noise_deg**2, START_SPEED_DEG_S**2])
    F = np.array([[1.0, dt_s], [0.0, 1.0]])
    Q = Q_discrete_white_noise(2, dt_s, settings.acceleration_deg_s2**2)
    R, H = np.array([[settings.noise_deg**2]]), np.array([[1.0, 0.0]])
    state, _, _ = step(state, measured[0], dt_s)
    for angles in measured[1:]:
        state, smooth, _ = step(state, angles, dt_s)
        foreseen = [predict(each, P, F, Q) for each in x]
        told = [update(each, now, a, R, H) for (each, now), a in zip(foreseen, angles, strict=True)]
        x, P = [each for each, _ in told], told[0][1]
        np.testing.assert_allclose(smooth, [each[0] for each in x], rtol=1e-9)
