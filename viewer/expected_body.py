"""The integrator's guide, as a prediction for one view."""

from typing import Final, NamedTuple

from common.body.body import Bdp
from common.body.observation import Facing, Pixel
from common.bus.messages import MOTION_S, Guide, ViewerNumber, place_in_rig

EXPECTED: Final = ("measuring", "tracking", "predicted")
"""States of a guide that predicts the body's place; otherwise the body is searched anew."""


class ExpectedBody(NamedTuple):
    """A followed body, as predicted for one view."""

    bdp: Bdp
    measured: bool
    """Whether its lengths are those of the opening posture."""
    pose: tuple[float, ...]
    """POSE_NAMES order, metres and degrees."""
    facing: Facing
    scale_px_per_m: float
    root_px: Pixel
    """Predicted place of the navel."""
    rest_row_px: float
    """Row where the navel would be if the person stood upright."""


def expected_body(guide: Guide | None, viewer: ViewerNumber) -> ExpectedBody | None:
    """The prediction for a viewer; None where the integrator has none."""
    n = place_in_rig(viewer)
    if guide is None or guide.status not in EXPECTED or guide.bdp is None:
        return None
    if not guide.scale_px_per_m[n] > 0.0:
        return None
    return ExpectedBody(
        guide.bdp,
        guide.measured,
        guide.pose,
        guide.facing[n],
        guide.scale_px_per_m[n],
        guide.root_px[n],
        guide.rest_row_px[n],
    )


def followed_px(guide: Guide | None, viewer: ViewerNumber) -> Pixel | None:
    """Where the body that the integrator surely follows is in a view; None where it is not."""
    if guide is None or guide.status != "tracking":
        return None
    known = expected_body(guide, viewer)
    return None if known is None else known.root_px


def moving_since_s(guide: Guide | None, viewer: ViewerNumber) -> float | None:
    """Time since when the person has moved in another view than a viewer's own, seconds; None where
    that is unknown."""
    if guide is None:
        return None
    moves = any(moves for number, moves in enumerate(guide.moves, start=1) if number != viewer)
    return guide.captured_s - MOTION_S if moves else None


def due_in(guide: Guide | None, viewer: ViewerNumber) -> int | None:
    """The number of the person whose turn it is in a view; None: everyone is looked at."""
    return guide.due[place_in_rig(viewer)] if guide is not None and guide.due else None
