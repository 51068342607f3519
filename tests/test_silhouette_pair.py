"""Both views' silhouettes of one instant, held against outlines of a known pose."""

import numpy as np
import pytest
from rolling import BODY, ROLLED, on_one_leg, outlines, person_in

from common.body.kinematics import ALL_LIMBS
from common.body.proportions import body_vector
from integrator.fit.silhouette_pair import poorest, products, silhouettes_of

VECTOR = body_vector(BODY)


def test_pictures_of_two_sizes_are_matched_as_those_of_one() -> None:
    """A narrower picture is taken to be empty beside its border."""
    first, second = outlines(on_one_leg())
    rows, columns = np.flatnonzero(second.any(axis=1)), np.flatnonzero(second.any(axis=0))
    narrow = second[: rows[-1] + 2, : columns[-1] + 2]
    assert narrow.shape[1] < second.shape[1]
    whole = silhouettes_of(ROLLED, (person_in(first), person_in(second)))
    other = silhouettes_of(ROLLED, (person_in(first), person_in(narrow)))
    assert np.array_equal(whole.seen, other.seen)
    assert whole.seen_px.tolist() == other.seen_px.tolist()
    assert whole.width == other.width


def test_the_poorest_view_is_the_one_whose_outline_is_cut() -> None:
    """The other has the pose's own outline, of which S is 1."""
    pose = on_one_leg()
    first, second = outlines(pose)
    cut = second.copy()
    cut[:120] = False
    seen = (person_in(first), person_in(cut))
    least = poorest(pose, VECTOR, ROLLED, seen)
    assert least < 0.8
    both = products(VECTOR, pose[None], ALL_LIMBS, *silhouettes_of(ROLLED, seen))
    assert both[0] == pytest.approx(least, abs=0.02)
    assert poorest(pose, VECTOR, ROLLED, (person_in(first), None)) == 1.0
