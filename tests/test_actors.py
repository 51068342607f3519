"""People and things as surfaces."""

import numpy as np

from synth.motion.motions import performance
from synth.person.people import person
from synth.picture.actors import BOX, SHUTTER, Part, Thing, actor_of, surfaces, thing_of


def test_a_box_is_closed_and_its_faces_look_outward() -> None:
    actor = thing_of(Thing((0.2, 0.4, 0.6), (1, 2, 3), np.array([[1.0, 2.0, 3.0], [np.nan] * 3])))
    a, b, c = (actor.places[0][BOX[:, n]] for n in range(3))
    normals = np.cross(b - a, c - a) / 2
    assert (((a + b + c) / 3 - [1.0, 2.0, 3.0]) * normals).sum(axis=1).min() > 0
    np.testing.assert_allclose(normals.sum(axis=0), 0.0, atol=1e-12)
    area = np.linalg.norm(normals, axis=1).sum()
    np.testing.assert_allclose(area, 2 * (0.2 * 0.4 + 0.4 * 0.6 + 0.2 * 0.6))
    np.testing.assert_allclose(np.ptp(actor.places[0], axis=0), [0.2, 0.4, 0.6])
    assert actor.present.tolist() == [True, False]


def test_a_surface_smears_over_the_time_in_which_the_shutter_is_open() -> None:
    """From 0.4 before to 0.4 after the frame's time, of the shutter's share of a frame."""
    actor = actor_of(Part(person(1), performance(person(1), "walk_toward", 1)))
    assert [places is actor.places[40] for places in surfaces(actor, 40, False)] == [False]
    np.testing.assert_array_equal(surfaces(actor, 40, False)[0], actor.places[40])
    moments = surfaces(actor, 40, True)
    np.testing.assert_array_equal(moments[0], actor.places[40])
    reach = 0.8 * SHUTTER * (actor.places[41] - actor.places[39]) / 2
    np.testing.assert_allclose(moments[4] - moments[1], reach, atol=1e-12)
