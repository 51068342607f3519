"""What the integrator remembers from one pair of reports to the next."""

from typing import Literal, NamedTuple

from common.body.body import Vector
from common.bus.messages import Facing
from common.config import Settings
from common.rig.camera import Rig
from integrator.opening_posture import Opening
from integrator.pose import smoothing
from integrator.proposal.pose_proposal import Insight


class State(NamedTuple):
    """Everything, as one value."""

    settings: Settings
    rig: Rig | None
    """None until somebody is seen, where no calibration is given."""
    scale_source: Literal["calibrated", "assumed"]
    smooth: smoothing.State
    opening: Opening = Opening()
    pose: Vector | None = None
    """Last fused pose; None while nobody is there."""
    facing: tuple[Facing, Facing] = ("facade", "flank")
    frames: tuple[int, int] = (-1, -1)
    """The last frame that was heard of each viewer."""
    last_s: float | None = None
    beside_m: Vector | None = None
    """How far the joints lie beside the cylinders' landmarks, (15, 3) in the trunk's axes; None:
    where they are."""
    insight: Insight | None = None
    """What the silhouettes last proposed, and the memory behind it."""
    badly: int = 0
    """For how many frames the model has fitted badly."""
    matched: bool = False
    """The pose was matched to the outlines, as the proposed one fitted badly."""
    doubted: bool = True
    """The outlines of the instant before fitted badly or had strays, or there were none."""
