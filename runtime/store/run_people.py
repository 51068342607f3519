"""The people of a run: their numbers, and one person's rows."""

from typing import TYPE_CHECKING

import numpy as np

from common.npz_file import Arrays

if TYPE_CHECKING:
    from runtime.store.past_run import PastRun


def people_of(poses: Arrays) -> tuple[int, ...]:
    """The numbers of a run's people, ascending: (0,) where it follows one person.

    Where several are followed, rows of number 0 are instants without a person.
    """
    numbers = tuple(int(number) for number in np.unique(poses["person"]))
    return tuple(number for number in numbers if number > 0) or (0,)


def of_person(run: "PastRun", person: int) -> "PastRun":
    """The run with one person's rows alone; its summary stays that of all.

    Raises:
        PastRunError: When the run has no such person.
    """
    from runtime.store.past_run import PastRunError

    there = people_of(run.poses)
    if person not in there:
        known = ", ".join(map(str, there))
        raise PastRunError(f"{run.folder} has no person {person}: its people are {known}")
    own = run.poses["person"] == person
    poses = {
        name: array if name.endswith("_names") else array[own] for name, array in run.poses.items()
    }
    return run._replace(poses=poses)
