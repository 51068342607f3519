"""Feet that stand still while they carry: the nearest frame of which something is known."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from animator.skeleton.planted_feet import nearest

FRAMES = st.integers(0, 60)


@given(rows=st.lists(FRAMES, max_size=20), known=st.sets(FRAMES, min_size=1))
def test_no_other_is_nearer_and_none_as_near_is_earlier(rows: list[int], known: set[int]) -> None:
    found = nearest(np.array(rows, np.int64), np.array(sorted(known)))
    due = [min(known, key=lambda one: (abs(one - row), one)) for row in rows]
    assert found.tolist() == due
