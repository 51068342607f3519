"""Universal BDPs from the opening posture: the median of several frames of both views (4.2)."""

from typing import Final

import msgspec
import numpy as np

from common.body.body import Bdp, Vector, body_of_lengths
from common.body.observation import Measure
from common.body.proportions import thesis_bdp
from common.bus.instant import Seen
from common.method import Method
from common.rig.camera import Rig
from integrator.measuring.known_body import Known, Measured, Opening, Unknown, Unmeasured
from integrator.measuring.prior_body import prior
from integrator.rig.body_position import scales_at, sees_flank, upright_place_of

LEG_KEPT: Final = (0.85, 1.05)
"""Range of the legs' length from the navel to the floor, over the measured one, in which it is
believed; otherwise the calibration's floor is wrong."""


def init(body: Bdp | None) -> Unknown | Measured:
    """The initial state: unknown, or a body measured before, whose navel follows from its legs."""
    if body is None:
        return Unknown()
    legs_m = body.r_upper_leg.height + body.r_lower_leg.height
    return Measured(body, (0.0, legs_m, 0.0))


def step(
    opening: Opening, rig: Rig, seen: Seen, due: int, method: Method
) -> tuple[Known, Vector | None]:
    """Process one instant; the navel's place where it is settled now, else None.

    After `due` frames without the posture, measuring begins anew.

    Args:
        opening: The state so far.
        rig: Two cameras.
        seen: The person in each view.
        due: Number of accepted frames whose median makes the body.
        method: The departures from the print.
    """
    if isinstance(opening, Measured):
        return opening, None
    if isinstance(opening, Unknown):
        opening = Unmeasured(prior(rig, seen))
    front, side = (None if person is None else person.measure for person in seen)
    if front is None or side is None or not _shows_both(rig, front, side):
        broken_off = opening.refused + 1 >= due
        return opening._replace(
            refused=opening.refused + 1,
            bodies=() if broken_off else opening.bodies,
            places_m=() if broken_off else opening.places_m,
            measures=() if broken_off else opening.measures,
        ), None
    return _settled(_measured(opening, rig, front, side), due, method)


def elsewhere(opening: Opening, rig: Rig, due: int, method: Method, stature_m: float) -> Known:
    """The body, recomputed by a new rig.

    Args:
        opening: By the rig before. A body that was known before the run is kept.
        rig: Two cameras.
        due: As for `step`.
        method: As for `step`.
        stature_m: Stature for a body that was not measured.
    """
    if isinstance(opening, Measured) and not opening.measures:
        return opening
    told = Unmeasured(thesis_bdp(stature_m))
    for front, side in () if isinstance(opening, Unknown) else opening.measures:
        if _shows_both(rig, front, side):
            told = _measured(told, rig, front, side)
    return _settled(told, due, method)[0]


def _shows_both(rig: Rig, front: Measure, side: Measure) -> bool:
    """Whether view 1 sees the facade and view 2 the flank of a person before both."""
    if front.bdp_px is None:
        return False
    place = upright_place_of(rig, front.centre_px, side.centre_px)
    return bool(np.isfinite(scales_at(rig, place)).all()) and sees_flank(rig, place)


def _measured(opening: Unmeasured, rig: Rig, front: Measure, side: Measure) -> Unmeasured:
    """The state with one more accepted frame."""
    place = upright_place_of(rig, front.centre_px, side.centre_px)
    x, y, z = (float(value) for value in place)
    return opening._replace(
        bodies=(*opening.bodies, universal_bdp(front, side, scales_at(rig, place)[0])),
        places_m=(*opening.places_m, (x, y, z)),
        measures=(*opening.measures, (front, side)),
        refused=0,
    )


def _settled(opening: Unmeasured, due: int, method: Method) -> tuple[Known, Vector | None]:
    """The medians, once enough frames were accepted."""
    if len(opening.bodies) < due:
        return opening, None
    lengths = np.median([body.lengths() for body in opening.bodies], axis=0)
    place = np.median(opening.places_m, axis=0)
    x, y, z = (float(value) for value in place)
    body = body_of_lengths(lengths.tolist())
    if method.legs_to_floor:
        body = _on_the_floor(body, y)
    return Measured(body, (x, y, z), opening.measures), place


def universal_bdp(front: Measure, side: Measure, px_per_m_1: float) -> Bdp:
    """Both views' measures of the opening posture as one body, metres.

    Viewer 2's trunk depth comes into viewer 1's scale by r_t = t2 / t1, the ratio of the
    silhouettes' heights: SR_torso,u = SR_torso,2 / r_t. The rest is viewer 1's.

    Args:
        front: Viewer 1's measure, with BDPs.
        side: Viewer 2's measure.
        px_per_m_1: Pixels per metre at the body in picture 1.

    Raises:
        ValueError: When `front` saw no facade and so has no BDPs.

    Source: section 4.2 (P46).
    """
    if front.bdp_px is None:
        raise ValueError("viewer 1 measured no BDPs: it did not see the facade")
    r_t = side.height_px / front.height_px
    torso = msgspec.structs.replace(front.bdp_px.torso, short_radius=side.depth_px / r_t)
    return msgspec.structs.replace(front.bdp_px, torso=torso).scaled(1 / px_per_m_1)


def _on_the_floor(body: Bdp, navel_m: float) -> Bdp:
    """The body with legs that reach from its navel to the floor, y = 0.

    Toes are nearer to the camera than the body is, so the lowest row of a silhouette lies some 50
    mm below the soles. A navel at a height that no legs have leaves the body unchanged.
    """
    half = navel_m / 2
    if not LEG_KEPT[0] <= half / body.r_upper_leg.height <= LEG_KEPT[1]:
        return body
    legs = {
        name: msgspec.structs.replace(getattr(body, name), height=half)
        for name in ("r_upper_leg", "l_upper_leg", "r_lower_leg", "l_lower_leg")
    }
    return msgspec.structs.replace(body, **legs)
