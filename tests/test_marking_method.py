"""Numbers as the files of points write them: read back by TOML as they were."""

import tomllib

from hypothesis import given
from hypothesis import strategies as st

from tritrack.marking.marking_method import toml_number, toml_pixels

numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(numbers, st.lists(st.tuples(numbers, numbers), max_size=4))
def test_numbers_and_points_come_back_as_they_were(
    value: float, points: list[tuple[float, float]]
) -> None:
    text = f"value = {toml_number(value)}\npoints = [{toml_pixels(points)}]"
    read = tomllib.loads(text)
    assert read["value"] == value
    assert [tuple(at) for at in read["points"]] == points
