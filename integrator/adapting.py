"""A prior body fitted to somebody who never took the opening posture: widths and arms."""

from typing import Final

import msgspec
import numpy as np

from common.body import LIMBS, Bdp, Vector, body_vector
from common.camera import Rig
from common.kernel import count, count_both, draw_limbs, score, view_of, words_of_rows
from common.kinematics import ALL_LIMBS
from common.messages import Report

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


def adapted(bdp: Bdp, pose: Vector, rig: Rig, seen: tuple[Report | None, Report | None]) -> Bdp:
    """The body whose outline in a pose fits both silhouettes best, group after group.

    An extra of `default` mode: the paper knows only people who take the opening posture.

    Args:
        bdp: A prior of the right stature.
        pose: As found with that prior, (25,).
        rig: Two cameras.
        seen: Reports of one instant.
    """
    best, body = _fit(bdp, pose, rig, seen), bdp
    for _ in range(ROUNDS):
        before = best
        for limbs, lengths in GROUPS:
            for trial in [_scaled(body, limbs, lengths, factor) for factor in FACTORS]:
                fit = _fit(trial, pose, rig, seen)
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


def _fit(bdp: Bdp, pose: Vector, rig: Rig, seen: tuple[Report | None, Report | None]) -> float:
    """Sum of S over the views that see somebody."""
    body, total = body_vector(bdp), 0.0
    for camera, report in zip(rig.cameras, seen, strict=True):
        if report is not None:
            words = words_of_rows(report.silhouette, report.width, report.height)
            drawn = np.zeros_like(words)
            draw_limbs(body, pose, view_of(camera), ALL_LIMBS, report.width, drawn)
            total += score(count_both(drawn, words), count(drawn), count(words))
    return total
