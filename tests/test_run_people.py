"""One person's rows of a run: theirs alone, in every array."""

from pathlib import Path

import numpy as np
import pytest
from test_exporting import write

import tritrack
from common.bus.messages import Body
from runtime.store.past_run import PastRunError
from runtime.store.pose_arrays import poses
from runtime.store.run_people import people_of

WHO = (0, 1, 1, 3, 1, 3)
"""The person of each row; the first row is of an instant without a person."""


@pytest.fixture
def run(tmp_path: Path) -> Path:
    frames = (0, 1, 2, 2, 3, 3)
    bodies = [
        Body(
            frame=frame,
            captured_s=frame / 15,
            clock_s=0.0,
            status="empty" if person == 0 else "lost",
            views="none",
            person=person,
            score=(row / 10, 0.0),
        )
        for row, (frame, person) in enumerate(zip(frames, WHO, strict=True))
    ]
    write(tmp_path / "run", poses(bodies), '{"clip": "walk"}')
    return tmp_path / "run"


def test_the_people_of_a_run_are_its_numbers_without_the_empty_instants() -> None:
    assert people_of({"person": np.array(WHO)}) == (1, 3)
    assert people_of({"person": np.array([0, 0])}) == (0,)


def test_one_persons_rows_are_given_in_every_array_by_row(run: Path) -> None:
    whole, third = tritrack.load_run(run), tritrack.load_run(run, person=3)
    assert whole.poses["person"].tolist() == list(WHO)
    assert third.poses["frame"].tolist() == [2, 3]
    assert third.poses["score"][:, 0].tolist() == [0.3, 0.5]
    assert third.poses.keys() == whole.poses.keys()
    assert {len(a) for name, a in third.poses.items() if not name.endswith("_names")} == {2}
    assert third.poses["camera_names"].tolist() == ["cam1", "cam2"]
    assert third.summary == whole.summary == {"clip": "walk"}


@pytest.mark.parametrize("number", [0, 2])
def test_a_person_that_the_run_does_not_have_is_refused_by_those_it_has(
    run: Path, number: int
) -> None:
    with pytest.raises(PastRunError, match=rf"run has no person {number}: its people are 1, 3$"):
        tritrack.load_run(run, person=number)
