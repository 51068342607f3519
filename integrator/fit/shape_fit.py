"""A body fitted to the person's silhouettes as they move: widths and arms."""

from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import LIMBS, Bdp, Floats, Vector
from common.body.kinematics import ALL_LIMBS
from common.body.proportions import (
    ARMS,
    LENGTHS,
    PER_ELLIPTIC,
    PER_ROUND,
    body_vector,
    stature,
    thesis_bdp,
)
from common.bus.instant import Seen
from common.compiled import compiled
from common.raster.bits import Bits
from common.raster.kernel import match
from common.rig.camera import Rig
from integrator.fit.silhouette_pair import silhouettes_of
from integrator.measuring.known_body import Known, Sample

GROUPS: Final[tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]] = (
    (("torso",), ("long_radius",)),
    (("torso",), ("short_radius",)),
    (("head",), ("long_radius", "short_radius")),
    (("r_upper_leg", "l_upper_leg"), ("long_radius", "short_radius")),
    (("r_lower_leg", "l_lower_leg"), ("long_radius", "short_radius")),
    (("r_upper_arm", "l_upper_arm"), ("radius",)),
    (("r_lower_arm", "l_lower_arm"), ("radius",)),
    (tuple(limb for limb in LIMBS if limb.endswith("arm")), ("height",)),
)
"""Groups of lengths that are scaled together. The heights of head, trunk and legs stay: their
sum is the stature, which the silhouette determines."""

LEAST_FIT: Final = 1.2
"""Sum of S over both views below which a silhouette contains more than the body."""
WIDEST: Final = 1.2
"""Largest radius of a limb, over the thesis's at that stature: a wider limb would cover
something else."""
FACTORS: Final = (0.85, 0.93, 1.08, 1.18)
ROUNDS: Final = 3


RADII: Final = [
    *range(0, ARMS, PER_ELLIPTIC),
    *range(1, ARMS, PER_ELLIPTIC),
    *range(ARMS, LENGTHS, PER_ROUND),
]
"""Indices of the limbs' radii in a body vector."""
MOST_SAMPLES: Final = 6
APART: Final = 12
"""Frames between two samples: most of a second, in which a pose changes."""


def step(opening: Known, rig: Rig, seen: Seen, pose: Vector) -> Known:
    """Process one instant with a person in view.

    The body is fitted to the first instant that shows the whole person in both views, and once more
    to that and a few later ones together. It is a prior, or, after the opening posture, the
    measured body. A departure of `default` mode: the paper measures once.

    Args:
        opening: The body so far; returned unchanged while it is being measured.
        rig: Two cameras.
        seen: Both views' reports.
        pose: The pose of the body so far, (25,).
    """
    first, second = seen
    done = opening.under_way or len(opening.samples) == MOST_SAMPLES
    if done or first is None or second is None:
        return opening
    if first.cut or second.cut:
        return opening
    if opening.samples and opening.unsampled < APART:
        return opening._replace(unsampled=opening.unsampled + 1)
    samples, body = (*opening.samples, Sample(pose, (first, second))), opening.bdp
    if float(fit(body_vector(body), *_fit_inputs(rig, samples[-1:]))) < LEAST_FIT:
        return opening
    if len(samples) in (1, MOST_SAMPLES):
        body = fitted(body, rig, samples)
    return opening._replace(bdp=body, samples=samples, unsampled=0)


def fitted(bdp: Bdp, rig: Rig, samples: tuple[Sample, ...]) -> Bdp:
    """The body that fits the silhouettes of all samples best, group after group.

    Args:
        bdp: The body so far.
        rig: Two cameras.
        samples: Both views of each, in pictures of one size.
    """
    inputs = _fit_inputs(rig, samples)
    best, body = float(fit(body_vector(bdp), *inputs)), bdp
    for _ in range(ROUNDS):
        before = best
        for limbs, lengths in GROUPS:
            for trial in [_scaled(body, limbs, lengths, factor) for factor in FACTORS]:
                found = float(fit(body_vector(trial), *inputs))
                if found > best and _of_a_person(trial):
                    best, body = found, trial
        if best == before:
            break
    return body


@compiled
def fit(
    body: Vector, poses: Floats, views: Floats, seen: Bits, seen_px: NDArray[np.int64], width: int
) -> float:
    """Sum of S over all samples and views.

    Args:
        body: Body vector.
        poses: (n, 25).
        views: (2, VIEW).
        seen: Silhouettes, packed, (n, 2, H, words).
        seen_px: Their numbers of pixels, (n, 2).
        width: Width of the pictures.
    """
    total = 0.0
    for i in range(poses.shape[0]):
        for n in range(2):
            total += match(body, poses[i], views[n], ALL_LIMBS, width, seen[i, n], seen_px[i, n])
    return total


def _fit_inputs(
    rig: Rig, samples: tuple[Sample, ...]
) -> tuple[Floats, Floats, Bits, NDArray[np.int64], int]:
    """Poses, views, silhouettes, their areas and their width, in the form of `fit`."""
    each = [silhouettes_of(rig, sample.seen) for sample in samples]
    return (
        np.array([sample.pose for sample in samples]),
        each[0].views,
        np.array([both.seen for both in each]),
        np.array([both.seen_px for both in each]),
        each[0].width,
    )


def _of_a_person(bdp: Bdp) -> bool:
    usual = body_vector(thesis_bdp(stature(bdp)))
    return bool((body_vector(bdp)[RADII] <= WIDEST * usual[RADII]).all())


def _scaled(bdp: Bdp, limbs: tuple[str, ...], lengths: tuple[str, ...], factor: float) -> Bdp:
    parts = {}
    for limb in limbs:
        part = getattr(bdp, limb)
        longer = {name: getattr(part, name) * factor for name in lengths}
        parts[limb] = msgspec.structs.replace(part, **longer)
    return msgspec.structs.replace(bdp, **parts)
