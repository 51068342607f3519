"""The networks that propose joints as they are trained, held against how they are run."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy_torch import GRU, Linear, Tensor, numpy_torch, tensor
from rich.console import Console
from rich.progress import Progress

from integrator.proposal.landmark_look import INPUTS
from integrator.proposal.network_weights import JOINTS, LiftingNetwork
from integrator.proposal.pose_network import recurrent_step
from lab.training import torch_network
from lab.training.torch_network import Round, layers_of, learn, loss, parts_of

UNITS = (20, 6, 9)
DUE = 39


def parts() -> list[Any]:
    mean = np.linspace(-1, 1, DUE).astype(np.float32)
    return parts_of(numpy_torch(), INPUTS, UNITS, mean)


def test_untrained_layers_have_their_sizes_and_say_nearly_what_is_usually_due() -> None:
    fc1, fc2, gru, fc3, out = parts()
    hidden, memory, joined = UNITS
    assert fc1.weight.shape == (hidden, INPUTS)
    assert fc2.weight.shape == (hidden, hidden)
    assert (gru.weight_ih_l0.shape, gru.hidden_size) == ((3 * memory, hidden), memory)
    assert fc3.weight.shape == (joined, hidden + memory)
    assert out.weight.shape == (DUE + len(JOINTS), joined)
    untouched = Linear(joined, DUE + len(JOINTS))
    assert out.bias[:DUE] == pytest.approx(np.linspace(-1, 1, DUE))
    assert out.bias[DUE:] == pytest.approx(untouched.bias[DUE:])
    assert out.weight == pytest.approx(0.3 * untouched.weight)


def test_what_is_trained_says_what_is_run() -> None:
    """Instant by instant, also the memory, but for the rounding of weights to bfloat16."""
    trained = parts()
    network = LiftingNetwork(*layers_of(trained))
    seen = np.random.default_rng(4).normal(0, 0.3, (2, 5, INPUTS)).astype(np.float32)
    found = torch_network._outputs(numpy_torch(), trained, tensor(seen))
    for performance, outputs in zip(seen, found, strict=True):
        memory = np.zeros(UNITS[1], np.float32)
        for inputs, trained_says in zip(performance, outputs, strict=True):
            memory, run_says = recurrent_step(network, memory, inputs)
            assert run_says == pytest.approx(np.asarray(trained_says), abs=0.05)


@pytest.mark.parametrize("able", [True, False])
def test_numbers_are_halved_where_the_processor_reckons_with_halves(able: bool) -> None:
    """Elsewhere a lesson takes nine times as long."""
    asked: list[tuple[str, object, bool]] = []

    def autocast(kind: str, dtype: object, enabled: bool) -> None:
        asked.append((kind, dtype, enabled))

    cpu = SimpleNamespace(_is_avx512_bf16_supported=lambda: able)
    torch_network.halved(SimpleNamespace(autocast=autocast, bfloat16="half", cpu=cpu))  # type: ignore[arg-type]
    assert asked == [("cpu", "half", able)]


def test_layers_are_copied_not_shared() -> None:
    trained = parts()
    biases = list(layers_of(trained))[1::2]
    trained[0].bias[:] = 7.0
    assert (biases[0] != 7.0).all()


def said(monkeypatch: pytest.MonkeyPatch, outputs: Any) -> None:
    monkeypatch.setattr(torch_network, "_outputs", lambda _, __, seen: tensor(outputs))


def example(instants: int, due: Any, stature_m: float) -> tuple[Any, ...]:
    ones = np.ones(instants, np.float32)
    return (
        tensor(np.zeros((instants, 2))),
        tensor(np.tile(due, (instants, 1))),
        tensor(ones),
        tensor(stature_m * ones),
    )


def test_the_loss_is_the_mean_distance_of_joints_and_how_wrong_the_sureness_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Twelve joints, the first 3, 4 and 12 parts off, one 0.02 off, all others right; what is
    padded counts for nothing. A joint 0.02 statures off is near (40 mm of 2 m)."""
    due = np.zeros(36)
    outputs = np.zeros((2, 3, 48))
    outputs[0, :, :3], outputs[0, :, 3] = (0.3, 0.4, 1.2), 0.02
    outputs[0, :, 36:] = 2.0
    outputs[1] = 9.0
    outputs[1, 0] = outputs[0, 0]
    said(monkeypatch, outputs)
    found = loss(numpy_torch(), [], [example(3, due, 2.0), example(1, due, 2.0)])
    right = np.sqrt(1e-5)
    off = (np.sqrt(1.69 + 1e-5) + np.sqrt(0.0004 + 1e-5) + 10 * right) / 12
    sureness = (np.log1p(np.exp(2.0)) + 11 * np.log1p(np.exp(-2.0))) / 12
    assert float(found) == pytest.approx(off + 0.01 * sureness, rel=1e-4)


def test_near_is_five_centimetres_of_the_person_not_of_a_stature(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    outputs = np.zeros((1, 1, 48))
    outputs[..., 0:36:3], outputs[..., 36:] = 0.03, 1.0
    said(monkeypatch, outputs)
    apart = np.sqrt(0.0009 + 1e-5)
    for stature_m, sureness in (
        (1.6, np.log1p(np.exp(-1.0))),
        (1.7, np.log1p(np.exp(1.0))),
    ):
        found = loss(numpy_torch(), [], [example(1, np.zeros(36), stature_m)])
        assert float(found) == pytest.approx(apart + 0.01 * sureness, rel=1e-4)


def test_where_the_hips_are_counts_three_tenths_of_a_joint_each(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    outputs = np.zeros((1, 1, 51))
    outputs[..., 36:39] = (0.0, 0.6, 0.8)
    said(monkeypatch, outputs)
    found = loss(numpy_torch(), [], [example(1, np.zeros(39), 1.0)])
    due = np.sqrt(1e-5) + 0.01 * np.log(2) + 0.3 * np.sqrt(1 + 1e-5)
    assert float(found) == pytest.approx(due, rel=1e-4)


class Optimiser:
    """Writes down what it is asked for; each step adds 1 to all weights."""

    def __init__(self) -> None:
        self.notes: list[Any] = []
        self.weights: list[Any] = []

    def AdamW(self, weights: list[Any], lr: float, weight_decay: float) -> Any:
        self.weights = weights
        self.notes.append(("adam", lr, weight_decay))
        return SimpleNamespace(zero_grad=lambda: self.notes.append("zero"), step=self._step)

    def OneCycleLR(self, _: Any, rate: float, total_steps: int, pct_start: float) -> Any:
        self.notes.append(("pace", rate, total_steps, round(pct_start, 6)))
        return SimpleNamespace(step=lambda: self.notes.append("pace"))

    def _step(self) -> None:
        self.notes.append("step")
        for weight in self.weights:
            weight[...] = weight + 1.0

    def torch(self) -> Any:
        scheduler = SimpleNamespace(OneCycleLR=self.OneCycleLR)
        found = numpy_torch(optim=SimpleNamespace(AdamW=self.AdamW, lr_scheduler=scheduler))
        found.nn.utils.clip_grad_norm_ = lambda _, size: self.notes.append(("cut", size))
        return found


def watched(monkeypatch: pytest.MonkeyPatch, optimiser: Optimiser) -> list[list[int]]:
    """Which examples each step is shown."""
    shown: list[list[int]] = []

    def noted(library: Any, parts: list[Any], examples: list[Any]) -> Any:
        assert library.optim
        assert all(isinstance(part, Linear) for part in parts)
        shown.append(examples)
        return SimpleNamespace(backward=lambda: optimiser.notes.append("slope"))

    monkeypatch.setattr(torch_network, "loss", noted)
    return shown


def test_a_round_shows_all_examples_once_an_epoch_and_cuts_slopes_before_it_steps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    optimiser = Optimiser()
    shown = watched(monkeypatch, optimiser)
    rng = np.random.default_rng(1)
    given: Any = list(range(7))
    part: Any = [Linear(2, 3)]
    torch_network._round(optimiser.torch(), part, given, rng, Round(400, 0.02, 3), Progress())
    assert [sorted(shown[2 * n] + shown[2 * n + 1]) for n in range(400)] == [given] * 400
    assert [len(each) for each in shown[:2]] == [4, 3]
    assert shown[0] != shown[2]
    assert optimiser.notes[:2] == [("adam", 0.02, 1e-4), ("pace", 0.02, 801, 0.1875)]
    assert optimiser.notes[2:7] == ["zero", "slope", ("cut", 1.0), "step", "pace"]
    assert len(optimiser.notes) == 2 + 5 * 800


def test_a_short_round_warms_up_for_three_tenths_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    optimiser = Optimiser()
    watched(monkeypatch, optimiser)
    given: Any = list(range(4))
    rng = np.random.default_rng(1)
    torch_network._round(optimiser.torch(), [], given, rng, Round(5, 0.02, 2), Progress())
    assert optimiser.notes[1] == ("pace", 0.02, 11, 0.3)


def test_the_network_that_is_kept_is_the_mean_of_what_its_rounds_ended_with(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Rounds of 2 and of 6 steps, each of which adds 1: ends at 2 and 8, mean 5."""
    optimiser = Optimiser()
    watched(monkeypatch, optimiser)
    part: Any = Linear(2, 3)
    start = part.bias.copy()
    given: Any = list(range(4))
    rounds = [Round(1, 0.1, 2), Round(3, 0.1, 2)]
    learn(optimiser.torch(), [part], given, rounds, 3, Console(quiet=True))
    assert part.bias == pytest.approx(start + 5.0, abs=1e-5)
    assert isinstance(part.bias, Tensor)


def test_a_seed_is_one_order(monkeypatch: pytest.MonkeyPatch) -> None:
    optimiser = Optimiser()
    shown = watched(monkeypatch, optimiser)
    given: Any = list(range(9))
    for seed in (3, 3, 4):
        learn(optimiser.torch(), [], given, [Round(1, 0.1, 3)], seed, Console(quiet=True))
    assert shown[:3] == shown[3:6] != shown[6:]


def test_the_recurrent_unit_begins_with_no_memory() -> None:
    unit = GRU(3, 2, batch_first=True)
    one = tensor(np.random.default_rng(2).normal(0, 1, (1, 1, 3)))
    gates = (one[0, 0] @ unit.weight_ih_l0.T + unit.bias_ih_l0).astype(float)
    reset, update = (1 / (1 + np.exp(-(gates[at] + unit.bias_hh_l0[at]))) for at in np.s_[:2, 2:4])
    new = np.tanh(gates[4:] + reset * unit.bias_hh_l0[4:])
    found = torch_network._hidden_states(numpy_torch(), unit, one)
    assert found[0, 0] == pytest.approx((1 - update) * new, abs=1e-6)
