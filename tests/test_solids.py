"""The unit solids, held against the volumes that geometry gives them."""

import numpy as np
import pytest

from animator.solids import Mesh, unit_ball, unit_cylinder


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def test_the_unit_cylinder_runs_from_the_origin_one_up_with_radius_one() -> None:
    vertices = unit_cylinder().vertices
    assert vertices[:, 1].min() == 0.0
    assert vertices[:, 1].max() == 1.0
    assert np.hypot(vertices[:, 0], vertices[:, 2]).max() == pytest.approx(1.0)


def test_unit_shapes_are_closed_and_show_their_outer_side() -> None:
    """Their volume, summed over outward faces, is a cylinder's and a ball's, little less."""
    assert 0.94 * np.pi < volume(unit_cylinder()) < np.pi
    assert 0.96 * 4 / 3 * np.pi < volume(unit_ball()) < 4 / 3 * np.pi
