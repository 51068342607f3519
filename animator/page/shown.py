"""Bus messages of an instant as numbers for a browser to draw."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import cv2
import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from animator.hands_and_feet import hands_and_feet
from animator.page.inset import limb_contours, limb_ends
from animator.page.page_messages import (
    CYLINDERS,
    Numbers,
    ShownEvent,
    ShownFit,
    ShownFrame,
    ShownPerson,
    ShownPosture,
    ShownRoom,
    ShownView,
)
from animator.scene import (
    Figure,
    Known,
    Shapes,
    Snapshot,
    figure,
    frustum,
    limb_shapes,
    round_shapes,
    rows_of,
    viewpoint,
)
from common.body.body import ANGLES_IN_POSE
from common.body.observation import Facing, Observation
from common.bus.messages import (
    Body,
    Picture,
    Posture,
    ScaleSource,
    Status,
    View,
    place_in_rig,
)
from common.raster.silhouette_report import unpack
from common.rig.camera import Camera, Rig
from common.rig.upright_camera import as_worked_on

MOST_RIVALS: Final = 6
"""Largest number of postures shown with their probability."""
SMOOTH_PX: Final = 0.7
"""Largest distance of a contour's corners from the silhouette's pixels, pixels."""
FACING_WORDS: Final[dict[Facing, str]] = {"facade": "front or back", "flank": "side"}
SOURCE_WORDS: Final[dict[ScaleSource, str]] = {
    "calibrated": "",
    "person": "calibrated by the person",
    "assumed": "the rig is assumed",
}
STATUS_WORDS: Final[dict[Status, str]] = {
    "empty": "no person in view",
    "measuring": "measuring the body",
    "tracking": "tracking",
    "predicted": "predicted, not believed",
    "lost": "lost, searching",
}


def shown_frame(
    snapshot: Snapshot, ended: Sequence[Posture], rig: Rig, number: int
) -> ShownFrame | None:
    """The bodies and their context; None where there is no body yet.

    Args:
        snapshot: The newest of everything.
        ended: The postures since the frame before with which a performance ended.
        rig: The run's cameras.
        number: Number of frames shown before.
    """
    body = snapshot.body
    if body is None:
        return None
    first = shown_person(Known(body, snapshot.posture, snapshot.performed), snapshot.reports, rig)
    return ShownFrame(
        **{**msgspec.structs.asdict(first), "views": _views(snapshot, body, first.views)},
        number=number,
        frame=body.frame,
        time_s=round(body.captured_s, 4),
        trust=trust_of(body),
        others=[shown_person(known, snapshot.reports, rig) for known in snapshot.others],
        events=tuple(
            ShownEvent(**msgspec.structs.asdict(posture.event), person=posture.person)
            for posture in ended
            if posture.event
        ),
    )


def shown_person(known: Known, reports: Mapping[int, View], rig: Rig) -> ShownPerson:
    """A person in the room and in each camera's picture.

    Args:
        known: The person.
        reports: By viewer: what each camera told.
        rig: The run's cameras.
    """
    body = known.body
    standing = figure(body)
    return ShownPerson(
        person=body.person,
        status=body.status,
        words=STATUS_WORDS[body.status],
        from_views=body.views,
        confidence=_rounded((*body.confidence, *body.extremities_confidence), 2),
        solids=[] if standing is None else _solids(standing, body),
        angles=_rounded([body.pose[i] for i in ANGLES_IN_POSE], 1) if body.pose else [],
        views=_fits(reports, body, standing, rig),
        posture=shown_posture(known.posture, known.performed),
    )


def trust_of(body: Body) -> str:
    """The cameras' believability, by both views in the last seconds."""
    told = body.agreement
    if told is None:
        return ""
    doubted = ", the calibration is doubtful" if told.believed < 1.0 else ""
    agree = f"cameras agree within {told.apart_mm:.0f} mm{doubted}"
    return "; ".join(filter(None, (SOURCE_WORDS[body.scale_source], agree)))


def shown_room(rig: Rig) -> ShownRoom:
    """The cameras' places, for drawing the room."""
    seen = viewpoint(rig)
    cameras = [_pyramid(camera, (rig.width, rig.height)) for camera in rig.cameras]
    return ShownRoom(_rounded(seen.look_at), _rounded(seen.position), cameras)


def shown_posture(posture: Posture | None, performed: str = "") -> ShownPosture | None:
    """The posture in progress or performed last, and its rivals' probabilities with equal priors.

    The sliding window gives rivals only where it has the same posture: it knows no standing, and
    reaches back to earlier motion.
    """
    if posture is None:
        return None
    name = posture.doing or performed
    rivals = probabilities(posture.log_likelihoods if posture.name == name else {})
    best = sorted(rivals.items(), key=lambda each: -each[1])[:MOST_RIVALS]
    told = [(rival, round(share, 4)) for rival, share in best]
    return ShownPosture(name, posture.doing, posture.times, told)


def probabilities(log_likelihoods: Mapping[str, float]) -> dict[str, float]:
    """Bayes' rule on log P(window | posture), with equal priors."""
    if not log_likelihoods:
        return {}
    best = max(log_likelihoods.values())
    weights = {name: math.exp(value - best) for name, value in log_likelihoods.items()}
    total = sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}


def outline_of(people: Sequence[Observation]) -> list[Numbers]:
    """The contours of what people cover together, holes too, in pixels: a pixel's centre is
    (0.5, 0.5)."""
    if not people:
        return []
    mask = np.logical_or.reduce([unpack(seen) for seen in people]).astype(np.uint8)
    found, _ = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    smooth = [cv2.approxPolyDP(contour, SMOOTH_PX, True) for contour in found]
    return [_rounded(contour + 0.5, 1) for contour in smooth if len(contour) > 2]


def _fits(
    reports: Mapping[int, View], body: Body, standing: Figure | None, rig: Rig
) -> list[ShownFit | None]:
    """By camera; None for one that told nothing."""
    ends = None if standing is None else limb_ends(standing)
    fits: list[ShownFit | None] = []
    for n, camera in enumerate(rig.cameras):
        report = reports.get(n + 1)
        limbs = [] if ends is None or report is None else limb_contours(camera, ends)
        fits.append(None if report is None else _fit(report, body, limbs))
    return fits


def _fit(report: View, body: Body, limbs: Sequence[NDArray[np.float64]]) -> ShownFit:
    own = place_in_rig(report.viewer)
    joints = [
        as_worked_on(np.array(place), report.upright)
        for places in (body.joints_px, body.extremities_px)
        for place in places[own : own + 1]
    ]
    return ShownFit(
        limbs=[_rounded(contour, 1) for contour in limbs],
        joints=_rounded(np.concatenate(joints) if joints else (), 1),
        score=round(body.score[own], 3),
        sees=FACING_WORDS[body.facing[own]] if body.pose else "",
        advice=body.advice[own] if body.advice else "",
    )


def _views(
    snapshot: Snapshot, body: Body, fits: Sequence[ShownFit | None]
) -> list[ShownView | None]:
    """The cameras' pictures below the fits of the frame's own person."""
    views: list[ShownView | None] = []
    for n, fit in enumerate(fits, 1):
        picture = snapshot.pictures.get(n)
        views.append(None if fit is None else _view(snapshot.reports[n], body, fit, picture))
    return views


def _view(report: View, body: Body, fit: ShownFit, picture: Picture | None) -> ShownView:
    return ShownView(
        **msgspec.structs.asdict(fit),
        size=(report.width, report.height),
        outline=outline_of(report.people if body.person else report.people[:1]),
        fault=f"the picture is {report.fault}" if report.fault else "",
        jpeg=b"" if picture is None else picture.jpeg,
    )


def _solids(standing: Figure, body: Body) -> list[Numbers]:
    limbs = limb_shapes(standing)
    ends = _rows(hands_and_feet(body, limbs)) if body.extremities_m else []
    return [*_rows(rows_of(limbs, CYLINDERS)), *_rows(round_shapes(limbs)), *ends]


def _rows(shapes: Shapes) -> list[Numbers]:
    table = np.hstack([shapes.positions, shapes.wxyzs, shapes.scales, shapes.colours])
    rows: list[Numbers] = table.round(4).tolist()
    return rows


def _pyramid(camera: Camera, size: tuple[int, int]) -> list[Numbers]:
    seen = frustum(camera, size)
    high = math.tan(seen.fov_rad / 2)
    wide = high * seen.aspect
    corners = np.array([[x, y, 1.0] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    world = corners * (wide, high, 1.0) @ np.array(camera.R) + seen.position
    return [_rounded(seen.position), *(_rounded(corner) for corner in world)]


def _rounded(values: ArrayLike, digits: int = 4) -> Numbers:
    """Flattened numbers, each as short as possible."""
    rounded: Numbers = np.asarray(values, np.float64).ravel().round(digits).tolist()
    return rounded
