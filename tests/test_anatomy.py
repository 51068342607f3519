"""The surface that all bodies of the Anny model share."""

import sys
from collections import Counter

import numpy as np
import pytest

from synth.anny_people import anatomy as module
from synth.anny_people.anatomy import NoAnny, anatomy, upright


def test_without_the_package_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anny", None)
    with pytest.raises(NoAnny, match=r"tritrack\[train\]"):
        module.anatomy.__wrapped__()


def test_what_is_up_there_is_up_here_and_left_stays_left() -> None:
    """A model that faces -y, z up: its left hand is at x > 0 in both."""
    left_ahead_above = np.array([[1.0, -2.0, 3.0]], np.float32)
    assert upright(left_ahead_above).tolist() == [[1.0, 3.0, 2.0]]


@pytest.mark.slow
def test_every_vertex_hangs_on_bones_wholly() -> None:
    pytest.importorskip("anny", reason="Anny's people need the extra `train`")
    known = anatomy()
    assert np.allclose(known.weights.sum(axis=1), 1.0, atol=1e-5)
    assert known.weights.shape == (len(known.kept), len(known.bones))
    assert all(above < i for i, above in enumerate(known.parents))


@pytest.mark.slow
def test_the_coarser_surface_still_closes() -> None:
    """Nearly: where cells merge, few edges have another number of faces than two."""
    pytest.importorskip("anny", reason="Anny's people need the extra `train`")
    faces = anatomy().faces
    corners = zip(faces, np.roll(faces, -1, axis=1), strict=True)
    edges = Counter(
        tuple(sorted(edge)) for a, b in corners for edge in zip(a.tolist(), b.tolist(), strict=True)
    )
    assert np.mean([n == 2 for n in edges.values()]) > 0.95
