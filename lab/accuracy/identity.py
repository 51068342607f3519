"""Who is who: measures of how well several people are kept apart, in metres.

A tracked body and a true person match where the mean distance of their twelve joints is within
GATE_M. All measures are of that one gate:

* MOTA, misses, false bodies and switches, and the mean distance of matches. Matches of the frame
  before are kept while they are within the gate; the others are assigned so that the sum of their
  distances is smallest. A switch is a person whose number differs from the last one they matched.
  Source: Bernardin and Stiefelhagen 2008, "Evaluating multiple object tracking performance".
* IDF1: each person has one number for the whole clip, so that most frames match.
  Source: Ristani et al. 2016, "Performance measures and a data set for multi-target tracking".
* AssA, the association part of HOTA: for each match, the share of all frames of that person or of
  that number in which the two match each other; the mean of all matches.
  Source: Luiten et al. 2021, "HOTA: a higher order metric", eqs. (7) and (10).
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from common.body.body import Vector
from common.npz_file import Arrays, Facts
from lab.accuracy.accuracy import picked, refuse_other_shapes

GATE_M: Final = 0.3
"""Largest mean distance of the joints of a body that matches a person."""
FAR_M: Final = 1e6
"""Cost of a pair that must not match."""


class Gaps(NamedTuple):
    """A clip's true people and tracked bodies."""

    gap_m: NDArray[np.float64]
    """(frames, people, numbers) mean distance of their joints; infinite beyond the gate and where
    one of them is absent."""
    due: NDArray[np.bool_]
    """(frames, people) whether the person is to be tracked."""
    there: NDArray[np.bool_]
    """(frames, numbers) whether there is a body of that number."""
    numbers: NDArray[np.int64]
    """The numbers of the bodies."""


class Presence(NamedTuple):
    """A person in the scene, from when they come until they leave."""

    who: int
    """The person in the truth."""
    first: int
    """First frame; `last` is the last one."""
    last: int
    number: int | None
    """The number that matches them most often meanwhile; None: no body does."""
    share: float
    """Share of their frames in which that number matches."""


class Counts(NamedTuple):
    """What the measures are computed from; counts of clips add up."""

    frames: int
    due: int
    """Number of true people in all frames."""
    bodies: int
    """Number of tracked bodies in all frames."""
    matches: int
    switches: int
    distance_m: float
    """Sum over the matches."""
    invented: int
    """Number of frames with a body that matches no person."""
    identified: int
    """Number of matches where each person has one number for the whole clip."""
    associated: float
    """Sum over HOTA's matches of their association."""
    aligned: int
    """Number of HOTA's matches."""


def gaps_of(poses: Arrays, truth: Arrays) -> Gaps:
    """The distances of a run's bodies from the true people.

    A body that matches best a person who is out of all pictures, or leaving, is left out.

    Args:
        poses: Content of `poses.npz`; without `person` it has one number.
        truth: Content of `truth.npz`; without `person` it has one person.

    Raises:
        Mismatch: When a joint is missing, or an array has an unexpected shape.
    """
    refuse_other_shapes(poses, "frame", "joints_m")
    refuse_other_shapes(truth, "present", "joints3d")
    true_m, due = _true_people(truth)
    frames = len(due)
    row_of = np.asarray(truth.get("frames_cam1", np.arange(frames)), int)
    frame = np.asarray(poses["frame"], int)
    number = np.asarray(poses.get("person", np.zeros(len(frame))), np.int64)
    tracked_m = picked(poses["joints_m"], poses["joint_names"])
    kept = np.isfinite(tracked_m).all(axis=(1, 2)) & (frame >= 0) & (frame < len(row_of))
    kept[kept] &= (row_of[frame[kept]] >= 0) & (row_of[frame[kept]] < frames)
    numbers = np.unique(number[kept])
    bodies_m = np.full((frames, len(numbers), *tracked_m.shape[1:]), np.nan)
    at = row_of[frame[kept]], np.searchsorted(numbers, number[kept])
    bodies_m[at] = tracked_m[kept]
    gap_m = np.linalg.norm(true_m[:, :, None] - bodies_m[:, None], axis=-1).mean(axis=-1)
    gap_m = np.where(gap_m <= GATE_M, gap_m, np.inf)
    there: NDArray[np.bool_] = np.asarray(np.isfinite(bodies_m).all(axis=(2, 3)))
    for i in np.flatnonzero((~due & np.isfinite(gap_m).any(axis=2)).any(axis=1)):
        who, body = assigned(gap_m[i])
        there[i, body[~due[i, who]]] = False
    gap_m[~due] = np.inf
    gap_m[np.broadcast_to(~there[:, None], gap_m.shape)] = np.inf
    return Gaps(gap_m, due, there, numbers)


def _true_people(truth: Arrays) -> tuple[Vector, NDArray[np.bool_]]:
    """Joints (frames, people, 12, 3), and who is to be tracked (frames, people)."""
    people = people_of(truth)
    joints_m = picked(truth["joints3d"], truth["joint_names"])
    joints_m = joints_m.reshape(-1, people, *joints_m.shape[1:])
    present = np.asarray(truth["present"], np.bool_).reshape(-1, people)
    return joints_m, present & np.isfinite(joints_m).all(axis=(2, 3))


def assigned(gap_m: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of the finite pairs: as many as possible, then with the smallest sum."""
    rows, columns = linear_sum_assignment(np.where(np.isfinite(gap_m), gap_m, FAR_M))
    real = np.isfinite(gap_m[rows, columns])
    return rows[real], columns[real]


def people_of(truth: Arrays) -> int:
    """Number of people in a truth."""
    return int(np.max(truth["person"])) + 1 if "person" in truth else 1


def counts(gaps: Gaps) -> Counts:
    """The counts of one clip."""
    gap_m, due, there, _ = gaps
    matches, switches, distance_m, invented = _followed(gaps)
    who, number = own_numbers(gaps)
    associated, aligned = _associated(gaps)
    return Counts(
        frames=len(due),
        due=int(due.sum()),
        bodies=int(there.sum()),
        matches=matches,
        switches=switches,
        distance_m=distance_m,
        invented=invented,
        identified=int(np.isfinite(gap_m[:, who, number]).sum()),
        associated=associated,
        aligned=aligned,
    )


def own_numbers(gaps: Gaps) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Person and index of their number, one for the whole clip: most frames match."""
    who, number = linear_sum_assignment(-np.isfinite(gaps.gap_m).sum(axis=0))
    return who, number


def presences(gaps: Gaps, least: int) -> list[Presence]:
    """When each person was there, and by which number they were followed then, by person and time.

    Args:
        gaps: Of a clip.
        least: Shortest absence that counts, frames; a shorter one is part of the presence.
    """
    found = []
    for who, due in enumerate(gaps.due.T):
        rows = np.flatnonzero(due)
        for own in np.split(rows, np.flatnonzero(np.diff(rows) > least) + 1) if len(rows) else []:
            matched = np.isfinite(gaps.gap_m[own, who]).sum(axis=0)
            best = int(matched.argmax()) if matched.any() else None
            number = None if best is None else int(gaps.numbers[best])
            share = 0.0 if best is None else float(matched[best] / len(own))
            found.append(Presence(who, int(own[0]), int(own[-1]), number, share))
    return found


def figures(clips: Sequence[Counts]) -> Facts:
    """The measures of all clips together; NaN where there is nothing."""
    total = Counts(*(sum(values) for values in zip(*clips, strict=True)))
    misses, false = total.due - total.matches, total.bodies - total.matches
    return {
        "clips": len(clips),
        "idf1": _share(2 * total.identified, total.due + total.bodies),
        "assa": _share(total.associated, total.aligned),
        "mota": 1.0 - _share(misses + false + total.switches, total.due),
        "switches": total.switches,
        "kept": _share(sum(clip.switches == 0 for clip in clips), len(clips)),
        "misses": misses,
        "false": false,
        "invented": _share(total.invented, total.frames),
        "matched_mm": 1e3 * _share(total.distance_m, total.matches),
    }


def _followed(gaps: Gaps) -> tuple[int, int, float, int]:
    """Matches, switches, sum of the distances, and frames with a false body, frame after frame."""
    last: dict[int, int] = {}
    before: dict[int, int] = {}
    matches, switches, distance_m, invented = 0, 0, 0.0, 0
    for gap_m, there in zip(gaps.gap_m, gaps.there, strict=True):
        kept = {who: body for who, body in before.items() if np.isfinite(gap_m[who, body])}
        rest = gap_m.copy()
        rest[list(kept)] = np.inf
        rest[:, list(kept.values())] = np.inf
        now = {**kept, **dict(zip(*map(np.ndarray.tolist, assigned(rest)), strict=True))}
        matches += len(now)
        switches += sum(last.get(who, body) != body for who, body in now.items())
        distance_m += sum(float(gap_m[pair]) for pair in now.items())
        invented += bool(there.sum() > len(now))
        last, before = {**last, **now}, now
    return matches, switches, distance_m, invented


def _associated(gaps: Gaps) -> tuple[float, int]:
    """Sum of the association of HOTA's matches, and their number.

    As many pairs as possible match in a frame, among those the ones that match often in the clip.
    """
    near = np.isfinite(gaps.gap_m)
    people, bodies = gaps.due.sum(axis=0)[:, None], gaps.there.sum(axis=0)[None]
    often = near.sum(axis=0)
    alignment = often / np.maximum(people + bodies - often, 1)
    pairs = np.zeros(alignment.shape, np.int64)
    for frame in near:
        who, body = assigned(np.where(frame, 1.0 - alignment, np.inf))
        pairs[who, body] += 1
    shares = pairs / np.maximum(people + bodies - pairs, 1)
    return float((pairs * shares).sum()), int(pairs.sum())


def _share(part: float, of: float) -> float:
    return part / of if of else np.nan
