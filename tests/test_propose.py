"""Proposed joints, held against made-up people whom the network was never taught on."""

from itertools import pairwise
from pathlib import Path

import msgspec
import numpy as np
import pytest

from common.body import Vector
from common.camera import as_matrix, as_row, centre, paper_rig
from integrator import propose
from integrator.propose import JOINTS, Network
from synth.outlines import Outline, outlines
from synth.skeleton import JOINTS as ALL_JOINTS

PICK = [ALL_JOINTS.index(name) for name in JOINTS]
UNTAUGHT = (900_001, 900_002, 900_003)
"""Seeds beyond all that are taught."""


def found(shown: Outline, facade: int = 0) -> Vector:
    window = propose.look(shown.masks, shown.rig, shown.stature_m, facade)
    assert window is not None
    return propose.proposed(propose.shipped(), window, shown.stature_m)


def test_untaught_people_are_found_to_a_few_centimetres() -> None:
    missed = [
        np.linalg.norm(found(shown) - shown.joints_m[PICK], axis=1)
        for seed in UNTAUGHT
        for shown in outlines(seed)
    ]
    assert np.median(missed) < 0.05
    assert np.mean(missed) < 0.08


def test_mirrored_cameras_propose_the_mirrored_pose() -> None:
    """The person that faces camera 2: both pictures mirrored and exchanged, x for -z."""
    shown = next(iter(outlines(UNTAUGHT[0])))
    first, second = shown.rig.cameras
    depths = (float(centre(first)[2]), float(-centre(second)[0]))
    heights = (float(centre(first)[1]), float(centre(second)[1]))
    size = (shown.rig.width, shown.rig.height)
    other = paper_rig(size, (second.K[0][0], first.K[0][0]), depths[::-1], heights[::-1])
    flipped = (shown.masks[1][:, ::-1], shown.masks[0][:, ::-1])
    told = found(shown._replace(masks=flipped, rig=other), facade=1)
    assert told == pytest.approx(propose.swapped(found(shown)), abs=0.003)


def test_what_is_aimed_at_is_placed_where_it_was() -> None:
    shown = next(iter(outlines(UNTAUGHT[1])))
    for facade in (0, 1):
        window = propose.look(shown.masks, shown.rig, shown.stature_m, facade)
        assert window is not None
        aim = propose.aimed(shown.joints_m[PICK], window, shown.stature_m)
        back = propose.placed(aim, window, shown.stature_m)
        assert back == pytest.approx(shown.joints_m[PICK])


def test_cameras_that_do_not_look_at_right_angles_get_no_proposal() -> None:
    shown = next(iter(outlines(UNTAUGHT[2])))
    first, second = shown.rig.cameras
    turn = np.array([[0.5, 0.0, 0.75**0.5], [0.0, 1.0, 0.0], [-(0.75**0.5), 0.0, 0.5]])
    slanted = msgspec.structs.replace(
        second,
        R=as_matrix(np.array(second.R) @ turn),
        t=as_row(-np.array(second.R) @ turn @ (turn.T @ centre(second))),
    )
    rig = msgspec.structs.replace(shown.rig, cameras=(first, slanted))
    assert propose.look(shown.masks, rig, shown.stature_m, 0) is None


def test_a_network_survives_its_file(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    sizes = (propose.INPUTS, 8, 6, 36)
    made = [rng.normal(0.0, 0.1, pair).astype(np.float32) for pair in pairwise(sizes)]
    network = Network(
        np.zeros(propose.INPUTS, np.float32),
        made[0],
        tuple(made[1:]),
        tuple(np.ones(n, np.float32) for n in sizes[2:]),
    )
    propose.save(network, tmp_path / "n.npz")
    cells = rng.random((3, propose.INPUTS)).astype(np.float32)
    kept = propose.run(propose.load(tmp_path / "n.npz"), cells)
    assert kept == pytest.approx(propose.run(network, cells), abs=0.02)
