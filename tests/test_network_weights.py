"""The network's weights, held against numbers and against their file."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from small_network import lifting_network, network

from integrator.proposal.network_weights import (
    LiftingNetwork,
    PoseNetwork,
    from_bfloat16,
    load,
    save,
    to_bfloat16,
)
from integrator.proposal.silhouette_window import CELLS


@given(arrays(np.float32, 40, elements=st.floats(-(2.0**99), 2.0**99, width=32)))
def test_a_half_is_off_by_a_256th_at_most(values: np.ndarray) -> None:
    """Seven digits behind the leading one, the last of them rounded (IEEE 754 single, cut)."""
    off = np.abs(from_bfloat16(to_bfloat16(values)) - values)
    assert (off <= np.abs(values) / 256 + 1e-38).all()


@pytest.mark.parametrize("made", [network(0.25), lifting_network()])
def test_a_network_survives_its_file(tmp_path: Path, made: Any) -> None:
    save(made, tmp_path / "n.npz")
    kept = load(tmp_path / "n.npz", type(made))
    assert all(np.array_equal(getattr(kept, n), getattr(made, n)) for n in made._fields)


@pytest.mark.parametrize("spoilt", ["cut", "empty", "misfit", "endless", "absent", "old"])
def test_a_damaged_file_is_refused(tmp_path: Path, spoilt: str) -> None:
    path, made = tmp_path / "n.npz", network()
    if spoilt == "misfit":
        made = made._replace(fc3=np.zeros((7, 4), np.uint16))
    if spoilt == "endless":
        made.out[0, 0] = to_bfloat16(np.array([np.inf], np.float32))[0]
    save(made, path)
    if spoilt == "cut":
        path.write_bytes(path.read_bytes()[:-300])
    if spoilt == "empty":
        path.write_bytes(b"")
    if spoilt == "absent":
        path.unlink()
    if spoilt == "old":
        np.savez(path, version=np.array(1), mean=np.zeros(CELLS))
    with pytest.raises(ValueError, match=r"n\.npz"):
        load(path, PoseNetwork)


@pytest.mark.parametrize("wanted", [PoseNetwork, LiftingNetwork])
def test_one_network_is_not_taken_for_the_other(tmp_path: Path, wanted: Any) -> None:
    save(lifting_network() if wanted is PoseNetwork else network(), tmp_path / "n.npz")
    with pytest.raises(ValueError, match=r"n\.npz"):
        load(tmp_path / "n.npz", wanted)
