"""The network of all postures, standing and filler: its best path, frame by frame, compiled."""

import math
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.compiled import compiled
from recognizer.postures import Array, DensityModel

SCALE: Final = 0.3
"""Weight of a log density: neighbouring frames are nearly equal."""
CAP_LIMB, CAP_TRAVEL = 4.0, 36.0
"""Upper bounds of an entry's squared deviation in a frame: two deviations for a limb's
direction, in which people differ, six for travel, in which they do not."""
LOOSENESS: Final = 2.0
"""Factor by which variances are widened for people outside the training data."""
FILLER: Final = 10.0
"""Loss of log density of the filler for any pose: a posture's own poses may be as bad."""
REST_CAP: Final = 4.0
"""Mean squared deviation of an entry up to which a pose counts as standing."""
STILL, MOVING = 0.2, 0.6
"""Speed of limbs in standing and in motion: change of all directions within three frames."""
SLOWNESS: Final = 3.0
"""Weight of slowness as evidence for standing."""
STILL_LOSS = -8.0
"""Upper bound of the evidence against it in a frame."""
ENTER, EXIT, CHANGE = 8.0, 8.0, 3.0
"""Costs of a path for entering a posture, leaving one, and changing between standing and
something unknown."""

Records = NDArray[np.int64]
"""(p s + 2, LAST) or with one more column: the record of the best path into each state."""
ONSET, COUNT, PHASE, LAST = 0, 1, 2, 3
"""Columns of a record. Of the posture in progress: its first frame, the number of repetitions,
whether it is in its second half. Of an ended one also its last frame."""

REACH: Final = 0.75
"""Share of the distance between standing and the height of a posture that a motion must cover;
for a repetition, the share of the way there and of the way back."""
LONG_FRAMES: Final = 1000
"""Number of steps after which the start of a chain no longer matters."""
RARE: Final = 0.05
"""Smallest share of a posture's time in a state that can mark a repetition."""


class PathNetwork:
    """Inputs of a model's network at every frame, computed once."""

    def __init__(self, model: DensityModel) -> None:
        """Names of the postures in the order of the model."""
        self.model = model
        with np.errstate(divide="ignore"):
            self.log_transition = np.log(model.transition)

    @cached_property
    def share(self) -> Array:
        """Share of its time that each posture is in each state, (p, s)."""
        long = np.linalg.matrix_power(self.model.transition, LONG_FRAMES)
        return np.asarray(long[:, 0])

    @cached_property
    def away(self) -> Array:
        """Distance of each state from standing, (p, s); 0 where it is rare."""
        apart = np.linalg.norm(self.model.mean - self.model.rest_mean, axis=2)
        return np.asarray(np.where(self.share > RARE, apart, 0.0))

    @cached_property
    def far(self) -> NDArray[np.bool_]:
        """The states at the height of each posture, (p, s)."""
        return np.asarray(self.away >= REACH * self.away.max(axis=1, keepdims=True))

    @cached_property
    def side(self) -> NDArray[np.int64]:
        """End of a repetition's way on which each state lies, (p, s): 1 the far one, -1 the near
        one, 0 between.

        A repetition goes from the state farthest from this one to the state farthest from standing.
        """
        mean, every = self.model.mean, np.arange(len(self.model.mean))
        far = mean[every, self.away.argmax(axis=1)][:, np.newaxis]
        apart = np.where(self.share > RARE, np.linalg.norm(mean - far, axis=2), 0.0)
        near = mean[every, apart.argmax(axis=1)][:, np.newaxis]
        along = ((mean - near) * (far - near)).sum(axis=2) / np.square(far - near).sum(axis=2)
        ends = np.where(along >= REACH, 1, np.where(along <= 1.0 - REACH, -1, 0))
        return np.where(self.share > RARE, ends, 0)


@compiled
def emissions(
    seen: Vector, speed: float, mean: Floats, variance: Floats, rest: Vector, rest_variance: Vector
) -> Floats:
    """Weighted log density of one frame in each state of the network, (p s + 2,): all states of all
    postures, standing, the filler.

    Args:
        seen: (27,) feature vector.
        speed: Speed of the limbs and of the body.
        mean: (p, s, 27) of the postures' states; `variance` alike.
        rest: (27,) mean of standing people; `rest_variance` alike.
    """
    postures, states, entries = mean.shape
    count = postures * states
    found = np.empty(count + 2)
    best = -math.inf
    for k in range(count):
        own, wide, level = mean[k // states, k % states], 0.0, 0.0
        near = variance[k // states, k % states]
        for i in range(entries):
            squared = (seen[i] - own[i]) ** 2 / near[i]
            cap = CAP_LIMB if i < entries - 3 else CAP_TRAVEL
            wide += min(squared / LOOSENESS, cap)
            level += math.log(2 * math.pi * near[i])
        found[k] = -0.5 * SCALE * (wide + level + entries * math.log(LOOSENESS))
        best = max(best, found[k])
    away = 0.0
    for i in range(entries - 3):
        away += (seen[i] - rest[i]) ** 2 / rest_variance[i]
    excess = max(0.0, away - REST_CAP * (entries - 3))
    slow = math.log(MOVING / STILL) - 0.5 * ((speed / STILL) ** 2 - (speed / MOVING) ** 2)
    found[count] = best - 0.5 * SCALE * excess + max(SLOWNESS * slow, STILL_LOSS)
    found[count + 1] = SCALE * FILLER
    return found


@compiled
def _way_into(k: int, score: Vector, log_transition: Floats, enter: float) -> tuple[float, int]:
    """The best transition into a state of a posture: its score, and the source state in that
    posture; -1 from outside, at the score of `enter`."""
    states = log_transition.shape[1]
    p, s = k // states, k % states
    best, origin = enter, -1
    for i in range(states):
        value = score[p * states + i] + log_transition[p, i, s]
        if value > best:
            best, origin = value, p * states + i
    return best, origin


@compiled
def _turned(side: int, own: NDArray[np.int64]) -> None:
    """Count a repetition where a path reaches the far end after the near one."""
    if side > 0 and own[PHASE] == 0:
        own[COUNT] += 1
        own[PHASE] = 1
    elif side < 0:
        own[PHASE] = 0


@compiled
def advance(
    score: Vector,
    record: Records,
    over: Records,
    emission: Vector,
    log_transition: Floats,
    side: NDArray[np.int64],
    frame: int,
    open_: bool,
) -> tuple[Vector, Records, Records]:
    """One frame further: the best path into every state of the network.

    Args:
        score: (p s + 2,) of the best path that ends in each state.
        record: (p s + 2, LAST) that path's record since it entered its posture.
        over: (p s + 2, LAST + 1) the record of the last ended performance on that path, with its
            last frame; -1 where there is none.
        emission: `emissions` of this frame.
        log_transition: (p, s, s).
        side: (p, s) end of a repetition on which each state lies: 1 far, -1 near, 0 between.
        frame: Number of this frame.
        open_: Whether a posture may begin: once a person was seen standing.

    Returns:
        score, record and over of this frame.
    """
    postures, states = log_transition.shape[:2]
    count = postures * states
    still, filler = count, count + 1
    new_score = np.empty_like(score)
    new_record, new_over = np.zeros_like(record), np.empty_like(over)
    source = still if score[still] >= score[filler] else filler
    enter = score[source] - ENTER if open_ else -math.inf
    leaver = int(np.argmax(score[:count]))
    for k in range(count):
        best, origin = _way_into(k, score, log_transition, enter)
        new_score[k] = best + emission[k]
        own = new_record[k]
        if origin < 0:
            new_over[k] = over[source]
            own[ONSET] = frame
        else:
            new_over[k] = over[origin]
            own[:] = record[origin]
        _turned(side[k // states, k % states], own)
    for k, other in ((still, filler), (filler, still)):
        values = (score[k], score[other] - CHANGE, score[leaver] - EXIT)
        best = max(values)
        new_score[k] = best + emission[k]
        if values[0] == best:
            new_over[k] = over[k]
        elif values[1] == best:
            new_over[k] = over[other]
        else:
            new_over[k, :LAST] = record[leaver]
            new_over[k, LAST] = frame - 1
    return new_score - new_score.max(), new_record, new_over
