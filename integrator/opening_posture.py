"""Universal BDPs from the opening posture: several frames of both views, their median (4.2)."""

from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import Bdp, Vector, body_of_lengths
from common.body.proportions import thesis_bdp
from common.bus.message_codec import unpack
from common.bus.messages import Pixel, Report
from common.rig.camera import Camera, Rig, project
from integrator.pairing import Seen
from integrator.proposal.silhouette_window import UPWARDS_M
from integrator.rig.body_position import place_of, roots_of, scales_at
from integrator.rig.perspective import px_per_m, triangulate, universal_bdp

STATURES_M: Final = (0.8, 2.3)
"""What a silhouette's height may say of a person; beyond, it is not the whole person."""

USUAL_M: Final = 1.75
"""Stature of somebody whose outline tells none."""

LEG_KEPT: Final = (0.85, 1.05)
"""Share of the measured leg that the height of the navel above the floor may leave; beyond, the
floor is not where the calibration says."""


class Sample(NamedTuple):
    """A pose as it was found, and what was seen then."""

    pose: Vector
    seen: tuple[Report, Report]


class Opening(NamedTuple):
    """What is known of the body, and what its opening posture has told so far."""

    bdp: Bdp | None = None
    """Universal BDPs, metres: a prior until measured; None until somebody is seen."""
    measured: bool = False
    measured_at_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where the navel was in the opening posture."""
    bodies: tuple[Bdp, ...] = ()
    """Universal BDPs of the frames accepted so far."""
    places_m: tuple[tuple[float, float, float], ...] = ()
    refused: int = 0
    """Frames since the last accepted one."""
    samples: tuple[Sample, ...] = ()
    """The instants whose outlines the prior was fitted to, where it was."""
    unsampled: int = 0
    """Frames since the last of them."""

    @property
    def under_way(self) -> bool:
        """Somebody takes the opening posture, and it has not told enough yet."""
        return bool(self.bodies) and not self.measured


def init(body: Bdp | None) -> Opening:
    """Nothing is known, or a body that was measured before: its navel is where its legs have it."""
    if body is None:
        return Opening()
    legs_m = body.r_upper_leg.height + body.r_lower_leg.height
    return Opening(body, True, (0.0, legs_m, 0.0))


def prior(rig: Rig, seen: Seen) -> Bdp:
    """The thesis's proportions at the height that the silhouettes show (T4).

    The smallest: what is no part of the person makes an outline larger. The crown of somebody who
    stands is as high above the floor, wherever their outline ends below or beside them.
    """
    place = place_of(rig, roots_of(seen), np.zeros(3), 0)
    heights = [
        height
        for report, camera in zip(seen, rig.cameras, strict=True)
        if report is not None
        and not report.cut
        and np.isfinite(height := _height_m(report, camera, place))
    ]
    low, high = STATURES_M
    if None not in seen and low <= (crown := _crown_m(rig, seen, place)) <= high:
        heights.append(crown)
    return thesis_bdp(min(high, max(low, min(heights))) if heights else USUAL_M)


def _height_m(report: Report, camera: Camera, place: Vector) -> float:
    """How far an outline reaches along what is upright in its picture, metres."""
    along, _ = _upwards(report, camera, place)
    return float((along.max() + 1.0 - along.min()) / px_per_m(camera, place))


def _crown_m(rig: Rig, seen: Seen, place: Vector) -> float:
    """Height above the floor of what is highest in both outlines; inf where that is nowhere.

    What touches the border of a picture may go on beyond it.
    """
    tops: list[Pixel] = []
    for report, camera in zip(seen, rig.cameras, strict=True):
        assert report is not None
        along, pixels = _upwards(report, camera, place)
        column, row = pixels[along.argmax()]
        if not (0 < column < report.width - 1 and 0 < row < report.height - 1):
            return np.inf
        tops.append((float(column) + 0.5, float(row) + 0.5))
    found = triangulate((rig.cameras[0], rig.cameras[1]), (tops[0], tops[1]))
    return float(found[1]) if np.isfinite(found).all() else np.inf


def _upwards(report: Report, camera: Camera, place: Vector) -> tuple[Vector, NDArray[np.intp]]:
    """How far up each pixel of an outline is in its picture, (n,), and the pixels, (n, 2)."""
    at, above = project(camera, np.stack([place, place + UPWARDS_M]))
    rows, columns = np.nonzero(unpack(report))
    pixels = np.stack([columns, rows], axis=1)
    return pixels @ (above - at) / np.linalg.norm(above - at), pixels


def step(opening: Opening, rig: Rig, seen: Seen, due: int) -> tuple[Opening, Vector | None]:
    """One pair of reports more; the navel's place where it is now settled, else None.

    A posture that is broken off for as many frames as it is due begins afresh.

    Args:
        opening: What is known so far.
        rig: Two cameras.
        seen: Reports with a body in them.
        due: How many accepted frames make the body (their median).
    """
    if opening.bdp is None:
        opening = opening._replace(bdp=prior(rig, seen))
    if opening.measured:
        return opening, None
    front, side = (None if report is None else report.measure for report in seen)
    if front is None or side is None or front.bdp_px is None:
        broken_off = opening.refused + 1 >= due
        return opening._replace(
            refused=opening.refused + 1,
            bodies=() if broken_off else opening.bodies,
            places_m=() if broken_off else opening.places_m,
        ), None
    place = place_of(rig, (front.centre_px, side.centre_px), np.zeros(3), 0)
    body = universal_bdp(front, side, scales_at(rig, place)[0])
    x, y, z = (float(value) for value in place)
    opening = opening._replace(
        bodies=(*opening.bodies, body), places_m=(*opening.places_m, (x, y, z)), refused=0
    )
    return _settled(opening, due)


def _settled(opening: Opening, due: int) -> tuple[Opening, Vector | None]:
    """The medians, once enough frames have told."""
    if len(opening.bodies) < due:
        return opening, None
    lengths = np.median([body.lengths() for body in opening.bodies], axis=0)
    place = np.median(opening.places_m, axis=0)
    x, y, z = (float(value) for value in place)
    body = _on_the_floor(body_of_lengths(lengths.tolist()), y)
    return Opening(body, True, (x, y, z)), place


def _on_the_floor(body: Bdp, navel_m: float) -> Bdp:
    """The body with legs that reach from its navel to the floor, y = 0.

    Toes are nearer to the camera than the body is, so the lowest row of a silhouette lies some
    50 mm below the soles. A navel that no legs could carry leaves the body as it is.
    """
    half = navel_m / 2
    if not LEG_KEPT[0] <= half / body.r_upper_leg.height <= LEG_KEPT[1]:
        return body
    legs = {
        name: msgspec.structs.replace(getattr(body, name), height=half)
        for name in ("r_upper_leg", "l_upper_leg", "r_lower_leg", "l_lower_leg")
    }
    return msgspec.structs.replace(body, **legs)
