"""The network of landmarks before it is taught: what photographs taught, and nothing else."""

from typing import Any

import numpy as np
import pytest

from synth.picture.composites import Composite, composite
from synth.picture.picture_examples import picture_examples
from viewer.landmarks.landmark_window import GREY

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")


@pytest.fixture(scope="module")
def shown() -> list[Composite]:
    """People before plain backdrops."""
    rng, people = np.random.default_rng(3), [*picture_examples(61_002)]
    plain = np.full((256, 256, 3), 120, np.uint8)
    return [composite(one, lambda: people[0], lambda: plain, rng) for one in people]


@pytest.fixture(scope="module")
def started(shown: list[Composite]) -> Any:
    from lab.landmark_lessons.photographed_start import photographed_start

    return photographed_start(shown)


def test_the_file_holds_numbers_alone_and_each_layer_once(started: Any) -> None:
    from lab.landmark_lessons.photographed_start import START

    with np.load(START, allow_pickle=False) as held:
        shapes = {name: held[name].shape for name in held.files}
    layers = started.photographed()
    assert len(shapes) == 2 * len(layers) + 1
    for n, layer in enumerate(layers):
        assert shapes[f"w{n:02d}"] == tuple(layer[0].weight.shape)


def test_it_says_of_colours_what_that_network_says(started: Any, shown: list[Composite]) -> None:
    """The first layer by hand: red first, black nought, white one."""
    from lab.landmark_lessons.landmark_planes import STEP, planes_of
    from lab.landmark_lessons.photographed_start import START

    with np.load(START) as held:
        weights, offsets = (
            torch.from_numpy(held[name].astype(np.float32)) for name in ["w00", "b00"]
        )
    planes = planes_of(shown)
    red_first = (planes[:, [2, 1, 0]] * STEP + GREY) / 255
    due = torch.nn.functional.conv2d(red_first[:, :, 1:, 1:], weights, offsets, stride=2)
    with torch.no_grad():
        found = started.eval().fine[0](planes[:, :3])
    assert torch.allclose(found[:, :, 1:, 1:], due.clamp(0, 6), atol=1e-3)


def test_its_normalisations_are_of_what_it_is_shown(started: Any, shown: list[Composite]) -> None:
    """Each unit's answers have mean 0 and variance 1 before they are given back their own."""
    from lab.landmark_lessons.landmark_planes import planes_of

    layer = started.eighth[0].wide
    found: dict[str, Any] = {}
    watched = layer[0].register_forward_hook(lambda _, __, said: found.update(said=said))
    with torch.no_grad():
        started.eval()(planes_of(shown))
    watched.remove()
    normal = (found["said"] - layer[1].running_mean[:, None, None]) / torch.sqrt(
        layer[1].running_var[:, None, None]
    )
    assert torch.allclose(normal.mean((0, 2, 3)), torch.zeros(96), atol=1e-2)
    assert (normal.var((0, 2, 3)) < 1.01).all()
    assert torch.allclose(layer[0].weight.flatten(1).norm(dim=1), torch.ones(96), atol=1e-4)


def test_what_is_finest_never_learns(started: Any) -> None:
    learning = {id(weights) for paced in started.paces() for weights in paced.weights}
    assert not learning & {id(weights) for weights in started.fine.parameters()}
    assert not started.train().fine.training
    assert started.coarse.training
