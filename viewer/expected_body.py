"""Where and how one view should show the body: what the integrator's guide says of it."""

from typing import Final, NamedTuple

from common.body.body import Bdp
from common.body.observation import Facing, Pixel
from common.bus.messages import Guide, ViewerNumber

EXPECTED: Final = ("measuring", "tracking", "predicted")
"""Guides with these states say where the body is; otherwise it is looked for afresh."""


class ExpectedBody(NamedTuple):
    """A body that is followed, as one view should show it."""

    bdp: Bdp
    measured: bool
    """Whether its lengths are those of the opening posture."""
    pose: tuple[float, ...]
    """POSE_NAMES order, metres and degrees."""
    facing: Facing
    scale_px_per_m: float
    root_px: Pixel
    """Where the navel is."""
    rest_row_px: float
    """Row where the navel would be, were the person upright."""


def expected_body(guide: Guide | None, viewer: ViewerNumber) -> ExpectedBody | None:
    """What a viewer should see; None where the integrator does not know."""
    n = viewer - 1
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
