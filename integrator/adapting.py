"""A prior body fitted to somebody who never took the opening posture: widths and arms."""

from typing import Final

import msgspec
import numpy as np

from common.body import LIMBS, Bdp, Vector, body_vector
from common.camera import Rig
from common.kernel import count, count_both, draw_limbs, score, view_of, words_of_rows
from common.kinematics import ALL_LIMBS
from common.messages import Report
from integrator.opening import Opening, Sample

Seen = tuple[Report | None, Report | None]

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
"""What is scaled together: limbs and their lengths. The heights of head, trunk and legs stay: they
make up the stature, which the silhouette tells."""

FACTORS: Final = (0.85, 0.93, 1.08, 1.18)
ROUNDS: Final = 3


MOST_SAMPLES: Final = 6
APART: Final = 12
"""Frames between two samples: most of a second, in which a pose changes."""


def step(opening: Opening, rig: Rig, seen: Seen, pose: Vector) -> Opening:
    """One instant more of somebody who does not take the opening posture.

    The body is fitted to the first instant that shows the whole person in both views, and again
    to that and a few later ones together. An extra of `default` mode: the paper knows only people
    who take the opening posture.

    Args:
        opening: What is known of the body; returned as it is once it was measured.
        rig: Two cameras.
        seen: Both views' reports.
        pose: As found with the body so far, (25,).
    """
    first, second = seen
    whole = first is not None and second is not None and not (first.cut or second.cut)
    done = opening.measured or opening.under_way or len(opening.samples) == MOST_SAMPLES
    if done or not whole or opening.bdp is None:
        return opening
    if opening.samples and opening.unsampled < APART:
        return opening._replace(unsampled=opening.unsampled + 1)
    samples = (*opening.samples, Sample(pose, seen))
    body = adapted(opening.bdp, rig, samples)
    return opening._replace(bdp=body, samples=samples, unsampled=0)


def adapted(bdp: Bdp, rig: Rig, samples: tuple[Sample, ...]) -> Bdp:
    """The body whose outline fits the silhouettes of all samples best, group after group."""
    best, body = _fit(bdp, rig, samples), bdp
    for _ in range(ROUNDS):
        before = best
        for limbs, lengths in GROUPS:
            for trial in [_scaled(body, limbs, lengths, factor) for factor in FACTORS]:
                fit = _fit(trial, rig, samples)
                if fit > best:
                    best, body = fit, trial
        if best == before:
            break
    return body


def _scaled(bdp: Bdp, limbs: tuple[str, ...], lengths: tuple[str, ...], factor: float) -> Bdp:
    parts = {}
    for limb in limbs:
        part = getattr(bdp, limb)
        longer = {name: getattr(part, name) * factor for name in lengths}
        parts[limb] = msgspec.structs.replace(part, **longer)
    return msgspec.structs.replace(bdp, **parts)


def _fit(bdp: Bdp, rig: Rig, samples: tuple[Sample, ...]) -> float:
    """Sum of S over all samples and views."""
    body, total = body_vector(bdp), 0.0
    for sample in samples:
        for camera, report in zip(rig.cameras, sample.seen, strict=True):
            if report is not None:
                words = words_of_rows(report.silhouette, report.width, report.height)
                drawn = np.zeros_like(words)
                draw_limbs(body, sample.pose, view_of(camera), ALL_LIMBS, report.width, drawn)
                total += score(count_both(drawn, words), count(drawn), count(words))
    return total
