"""What the network of landmarks starts from: layers that photographs of people have taught.

`mediapipe_pose_lite.npz` holds those of MediaPipe Pose's lite network (Copyright The MediaPipe
Authors, Apache License 2.0, see NOTICE) that ours has too, in its order, as numbers of half the
length. `docs/models.md` says where they were taken from.
"""

from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from common.body.body import JOINT_NAMES
from lab.landmark_lessons.landmark_layers import LandmarkNetwork
from lab.landmark_lessons.landmark_planes import STEP, planes_of
from synth.picture.composites import Composite
from viewer.landmarks.landmark_window import GREY

START: Final = Path(__file__).with_name("mediapipe_pose_lite.npz")
LEVELS: Final = 255
"""Of a byte, that were 1 for that network; black was 0, and it took red first."""
HALF: Final = 0.5
"""Their maps become ours at that strength."""
SEEN_AS: Final[dict[str, tuple[int, ...]]] = {
    "pelvis": (23, 24),
    "neck": (11, 12),
    "head_top": (0,),
    "l_shoulder": (11,),
    "r_shoulder": (12,),
    "l_elbow": (13,),
    "r_elbow": (14,),
    "l_wrist": (15,),
    "r_wrist": (16,),
    "l_hip": (23,),
    "r_hip": (24,),
    "l_knee": (25,),
    "r_knee": (26,),
    "l_ankle": (27,),
    "r_ankle": (28,),
}
"""Which of that network's maps are nearest to ours."""
LEAST: Final = 1e-4
"""Variance of a unit, at least: some hardly ever answer."""


def photographed_start(shown: list[Composite], start: Path = START) -> LandmarkNetwork:
    """The network before it is taught: what it makes of colours is what the file's makes of them,
    its normalisations are those of the pictures that it will be shown.

    Args:
        shown: Some of those, by which ranges are found.
        start: The file, arrays `wNN` and `bNN` of layers, `maps_w` of the maps.
    """
    network = LandmarkNetwork()
    with np.load(start) as held, torch.no_grad():
        layers = network.photographed()
        for n, layer in enumerate(layers):
            weights, offsets = (_whole(held[f"{kind}{n:02d}"]) for kind in "wb")
            if n == 0:
                weights = weights.flip(1)
                offsets = offsets + weights.sum((1, 2, 3)) * (GREY / LEVELS)
                weights = weights * (STEP / LEVELS)
            _fill(layer, weights, offsets)
        for joint, name in enumerate(JOINT_NAMES):
            nearest = _whole(held["maps_w"])[list(SEEN_AS[name])]
            network.maps.weight[joint] = HALF * nearest.mean(0)
        network.maps.bias.zero_()
        _normalise(network, layers, planes_of(shown))
    return network


def _whole(values: NDArray[np.float16]) -> torch.Tensor:
    return torch.from_numpy(values.astype(np.float32))


def _fill(layer: nn.Sequential, weights: torch.Tensor, offsets: torch.Tensor) -> None:
    """Give a layer weights; its normalisation changes nothing yet."""
    convolution, normal = layer[0], layer[1]
    convolution.weight.copy_(weights)
    normal.weight.fill_(1.0)
    normal.bias.copy_(offsets)
    normal.running_mean.zero_()
    normal.running_var.fill_(1.0 - normal.eps)


def _normalise(network: LandmarkNetwork, layers: list[nn.Sequential], planes: torch.Tensor) -> None:
    """Part each layer into weights of length 1 and a normalisation by what these pictures show:
    it says what it said before, and learns evenly."""
    found = {}

    def note(layer: nn.Module, _: object, said: torch.Tensor) -> None:
        found[layer] = said.mean((0, 2, 3)), said.var((0, 2, 3)).clamp(min=LEAST)

    watched = [layer[0].register_forward_hook(note) for layer in layers]
    network.eval()(planes)
    for each in watched:
        each.remove()
    for convolution, normal in ((layer[0], layer[1]) for layer in layers):
        mean, variance = found[convolution]
        length = convolution.weight.flatten(1).norm(dim=1).clamp(min=1e-6)
        convolution.weight.div_(length[:, None, None, None])
        normal.running_mean.copy_(mean / length)
        normal.running_var.copy_(variance / length**2)
        normal.weight.copy_(length * torch.sqrt(variance / length**2 + normal.eps))
        normal.bias.add_(mean)
