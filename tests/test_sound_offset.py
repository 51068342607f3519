"""How late a sound is: claps, steps and speech before two microphones, and what is ambiguous."""

import numpy as np
import pytest

from common.sound.sound_offset import delay_of

HZ = 8_000


def heard(
    rng: np.random.Generator, times_s: np.ndarray, loud: np.ndarray, lasts_s: float, noise: float
) -> np.ndarray:
    """Bursts of noise at times, by a microphone with an echo and a hiss of its own."""
    sound = np.zeros(round(lasts_s * HZ))
    tone = np.random.default_rng(9)
    for at_s, size in zip(times_s, loud, strict=True):
        burst = tone.normal(0, 1, HZ // 8) * np.exp(-np.arange(HZ // 8) / (0.02 * HZ)) * size
        for echo_s, share in ((0.0, 1.0), (rng.uniform(0.02, 0.06), rng.uniform(0.1, 0.4))):
            a = round((at_s + echo_s) * HZ)
            part = burst[max(0, -a) : max(0, len(sound) - a)]
            if len(part):
                sound[max(a, 0) : max(a, 0) + len(part)] += share * part
    return sound * rng.uniform(0.1, 3.0) + noise * rng.normal(0, 1, len(sound))


@pytest.mark.parametrize("seed", range(20))
def test_a_delay_is_found_within_10_ms(seed: int) -> None:
    """A dozen sounds at no rhythm; two microphones of their own gain, echo and hiss."""
    rng = np.random.default_rng(seed)
    late_s, times_s = rng.uniform(-6, 6), np.sort(rng.uniform(-8, 20, 24))
    loud = rng.uniform(0.3, 1.0, 24)
    first = heard(rng, times_s, loud, 12.0, 0.01)
    second = heard(rng, times_s + late_s, loud, 12.0, 0.02)
    found = delay_of(first, second, HZ, 10.0)
    assert found.is_clear
    assert found.late_s == pytest.approx(late_s, abs=0.010)


def test_steps_of_a_gait_alone_are_ambiguous() -> None:
    rng = np.random.default_rng(4)
    times_s, loud = np.arange(-10.0, 25.0, 0.5), np.ones(70)
    first = heard(rng, times_s, loud, 12.0, 0.01)
    second = heard(rng, times_s + 1.3, loud, 12.0, 0.01)
    assert not delay_of(first, second, HZ, 10.0).is_clear


@pytest.mark.parametrize("what", ["others", "hiss", "silence", "short"])
def test_what_tells_nothing_is_not_clear(what: str) -> None:
    rng = np.random.default_rng(8)
    loud = np.ones(12)
    first = heard(rng, np.sort(rng.uniform(0, 12, 12)), loud, 12.0, 0.01)
    second = {
        "others": heard(rng, np.sort(rng.uniform(0, 12, 12)), loud, 12.0, 0.01),
        "hiss": rng.normal(0, 0.1, 12 * HZ),
        "silence": np.zeros(12 * HZ),
        "short": first[: HZ // 2],
    }[what]
    assert not delay_of(first, second, HZ, 10.0).is_clear


def test_more_is_later_in_the_second() -> None:
    """By hand: one clap, at 2 s in the first and at 2.75 s in the second."""
    rng = np.random.default_rng(0)
    first = heard(rng, np.array([2.0]), np.ones(1), 5.0, 0.001)
    second = heard(rng, np.array([2.75]), np.ones(1), 5.0, 0.001)
    assert delay_of(first, second, HZ, 10.0).late_s == pytest.approx(0.75, abs=0.01)
