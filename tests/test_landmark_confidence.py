"""How sure a network is, is how often it is right: of people from whom it did not learn."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy_torch import importable


@pytest.fixture(scope="module")
def confidence() -> Any:
    """The module, also where the extra `train` is not installed."""
    with importable():
        from lab.landmark_lessons import landmark_confidence

        return landmark_confidence


def test_the_slope_and_offset_that_made_outcomes_are_found_from_them(confidence: Any) -> None:
    rng = np.random.default_rng(3)
    logits, given = rng.normal(1.0, 2.0, 40_000), rng.normal(0.0, 1.0, 40_000)
    probable = 1.0 / (1.0 + np.exp(-(0.6 * logits - 1.2 + given)))
    found = confidence.fitted(logits, given, (rng.random(40_000) < probable).astype(float))
    assert found == pytest.approx((0.6, -1.2), abs=0.06)


def test_outcomes_that_are_all_alike_have_a_fit(confidence: Any) -> None:
    slope, offset = confidence.fitted(np.zeros(50), np.zeros(50), np.ones(50))
    assert slope == 0.0
    assert offset > 2.0


def test_the_viewers_confidence_is_then_how_often_joints_are_near(
    confidence: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Logits are thrice too steep and one too high for a viewer who adds the share about a peak."""
    torch = pytest.importorskip("torch", reason="the extra `train` is not installed")
    rng, people = np.random.default_rng(7), 1000
    told = torch.from_numpy(rng.normal(0.0, 3.0, (people, 32))).float()
    share = rng.uniform(0.05, 0.95, (people, 15, 1, 1))
    slope, weight, offset = platt = (0.75, 0.5, 0.57)
    monkeypatch.setattr(confidence, "PLATT", platt)
    added = weight * np.log(share / (1 - share))[..., 0, 0]
    true = 1.0 / (1.0 + np.exp(-(0.2 * told[:, 17:].numpy() - 0.5 + added)))
    near = torch.from_numpy((rng.random((people, 15)) < true).astype(np.float32))
    shown: Any = [
        SimpleNamespace(nobody=n >= people, joints_px=np.zeros((15, 2))) for n in range(people + 9)
    ]

    def answers(_: Any, asked: Any) -> Any:
        assert len(asked) == people, "what shows nobody tells nothing of joints"
        return torch.zeros(people, 15, 4, 4), told, None

    monkeypatch.setattr(confidence, "answers", answers)
    monkeypatch.setattr(confidence, "peaks", lambda flat: torch.zeros(people, 15, 2))
    monkeypatch.setattr(confidence, "near_enough", lambda off, asked: near)
    about = torch.from_numpy(share).float()
    monkeypatch.setattr(confidence, "shares_about", lambda flat: (None, about))
    network = SimpleNamespace(told=[torch.nn.Linear(4, 32)])
    before = [each.detach().clone() for each in network.told[-1].parameters()]
    confidence.set_confidence(network, shown)
    (weights, biases), (own, bias) = network.told[-1].parameters(), before
    weights, biases = weights.detach(), biases.detach()
    times = float((weights[17:] / own[17:]).mean())
    plus = float((biases[17:] - times * bias[17:]).mean())
    seen = slope * (times * told[:, 17:].numpy() + plus) + offset
    assert seen == pytest.approx(0.2 * told[:, 17:].numpy() - 0.5, abs=0.2)
    assert torch.equal(weights[:17], own[:17]), "facing and presence stay"
    assert torch.equal(biases[:17], bias[:17])
