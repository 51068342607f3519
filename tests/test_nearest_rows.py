"""The nearest row of some."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from common.nearest_rows import nearest

ROWS = st.sets(st.integers(0, 60), min_size=1)


@given(rows=st.lists(st.integers(0, 60), max_size=20), known=ROWS)
def test_no_other_is_nearer_and_none_as_near_is_earlier(rows: list[int], known: set[int]) -> None:
    found = nearest(np.array(rows, np.int64), np.array(sorted(known)))
    due = [min(known, key=lambda one: (abs(one - row), one)) for row in rows]
    assert found.tolist() == due
