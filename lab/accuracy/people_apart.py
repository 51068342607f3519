"""A run and a truth of several people as runs and truths of one."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from common.npz_file import Arrays
from lab.accuracy.identity import Gaps, own_numbers, people_of


class Apart(NamedTuple):
    """One person of a clip."""

    poses: Arrays
    """Rows of the person's number for the whole clip; none where no number is theirs."""
    truth: Arrays
    """As of a clip of one person; without masks, as a silhouette may be of several people."""


def apart(poses: Arrays, truth: Arrays, gaps: Gaps) -> Iterator[Apart]:
    """Each person of a clip, with the number that is theirs in most frames.

    Args:
        poses: Content of `poses.npz`.
        truth: Content of `truth.npz`.
        gaps: Their distances.
    """
    number_of = {}
    for who, at in zip(*own_numbers(gaps), strict=True):
        if gaps.gap_m.shape[1:] == (1, 1) or np.isfinite(gaps.gap_m[:, who, at]).any():
            number_of[int(who)] = int(gaps.numbers[at])
    for who in range(people_of(truth)):
        yield Apart(_of_number(poses, number_of.get(who)), _of_person(truth, who))


def _of_number(poses: Arrays, number: int | None) -> Arrays:
    """The rows of a number; without numbers all are of number 0."""
    count = len(poses["frame"])
    theirs = np.asarray(poses.get("person", np.zeros(count))) == number
    return _rows(poses, theirs)


def _of_person(truth: Arrays, who: int) -> Arrays:
    """The rows of a person, and their own entry of the arrays with one for each person."""
    if "person" not in truth:
        return truth
    rows = _rows(truth, np.asarray(truth["person"]) == who)
    rows |= {name: truth[name][who] for name in ("measures", "performer") if name in truth}
    left_out = ("frame", "person", "mask_")
    return {name: array for name, array in rows.items() if not name.startswith(left_out)}


def _rows(arrays: Arrays, kept: np.ndarray) -> Arrays:
    return {
        name: array[kept] if np.ndim(array) and len(array) == len(kept) else array
        for name, array in arrays.items()
    }
