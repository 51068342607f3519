"""One person as one camera sees them in one frame: silhouette, landmarks, and what methods add."""

from typing import Literal

import msgspec

from common.body.body import Bdp

Facing = Literal["facade", "flank"]
Pixel = tuple[float, float]


class Box(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The boundary of a silhouette, pixels: first and last column, first and last row (P11)."""

    left: int
    right: int
    top: int
    bottom: int

    def meets(self, other: "Box", near_px: int = 0) -> bool:
        """Whether two boxes share a pixel, or have some no farther from each other than this."""
        across = max(self.left, other.left) - min(self.right, other.right)
        down = max(self.top, other.top) - min(self.bottom, other.bottom)
        return max(across, down) <= near_px


class Measure(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What one viewer reads off the opening posture, in its own pixels (section 2.4)."""

    height_px: float
    """t_n: height of the silhouette."""
    centre_px: Pixel
    """Where the centre of the body (x_c, y_c) lies in the picture."""
    depth_px: float
    """Half width of the trunk as this view shows it: SR_torso where it sees the flank (P21)."""
    bdp_px: Bdp | None = None
    """All BDPs but the trunk's depth, where this view sees the facade."""
    arms_z_deg: tuple[float, float] | None = None
    """theta_Z of the right and the left shoulder in the opening posture (P19)."""


class Fit(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The stick body that one viewer fitted to its silhouette (Demir 2006, 3.1.4)."""

    joints_px: tuple[Pixel, ...]
    """JOINT_NAMES order; r is on the left of the picture (T10)."""
    ratios: tuple[float, ...]
    """LIMBS order: how much of its length each segment shows, in [0, 1]."""
    breadth: float
    """How much of its breadth the trunk shows, in [0, 1]."""
    stature_px: float
    """Height that the body would have standing upright."""
    hidden: tuple[bool, ...]
    """LIMBS order: what the silhouette does not show."""
    score: float
    """Similarity of silhouette and stick body, in [0, 1]."""
    matches: int


class Landmarks(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The joints that one view's picture shows, from any landmark source."""

    joints_px: tuple[Pixel, ...]
    """JOINT_NAMES order, pixels of the reported silhouette: the centre of its first pixel is
    (0.5, 0.5). A joint that is not seen has any place and confidence 0."""
    confidence: tuple[float, ...]
    """JOINT_NAMES order, in [0, 1]: probability that the joint is less than 0.03 statures off
    (50 mm), left-right exchange apart; the facing helps to decide that."""
    facing_deg: float = 0.0
    """Which way the person faces: 0 towards this camera, 90 to the right of its picture, in
    (-180, 180]. The axis is the vertical; where the trunk leans by more than 30 degrees in the
    picture it is the trunk, as if the picture were turned upright."""
    facing_confidence: float = 0.0
    """Probability that the facing is less than 45 degrees off, in [0, 1]; 0: the source gives
    none."""
    extremities_px: tuple[Pixel, ...] = ()
    """EXTREMITY_NAMES order, as joints_px; empty: the source does not look for them."""
    extremities_confidence: tuple[float, ...] = ()
    """EXTREMITY_NAMES order, as confidence."""
    second_px: tuple[Pixel, ...] = ()
    """Second candidate for each joint, as joints_px; empty: the source gives one place alone."""
    second_confidence: tuple[float, ...] = ()
    """Probability of the second candidate, as confidence."""


class Search(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a viewer's search for the pose found in one silhouette (sections 3.4 and 3.5)."""

    root_px: Pixel
    """Where the search has the navel in the picture, pixels."""
    angles_deg: dict[str, float]
    """The angles that this view estimates; names as in ANGLE_NAMES."""
    squatting: bool
    """The navel is lower than in the opening posture (P33)."""
    score: float
    """Similarity of silhouette and model in that pose, in [0, 1]."""
    matches: int
    """How many times a model was matched for this frame."""


class Observation(
    msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True
):
    """One person as one camera sees them in one frame."""

    track: int = 0
    """The viewer's own number of the person, the same from frame to frame."""
    width: int
    height: int
    """Size of the picture that the silhouette belongs to, pixels."""
    silhouette: bytes
    """`pack(mask)`: the silhouette's box and nothing else of the picture."""
    box: Box
    area_px: int
    cut: bool = False
    """The silhouette touches the picture's border: the person is partly outside."""
    landmarks: Landmarks | None = None
    """None where the source of landmarks sees no person here, or there is none."""
    carried: bool = False
    """The landmarks are those of an earlier frame, moved on: where a run of several people is late,
    they are looked at in turn."""
    colours: tuple[float, ...] = ()
    """Mean L*a*b* of the clothes of the upper body, then of the legs; empty where there are no
    landmarks."""
    vote: Facing = "facade"
    """What this view alone takes itself for: facade or flank (P26)."""
    upper_body_px: float = 0.0
    """W_u-body: width of the upper body, the evidence behind `vote` (P25)."""
    thresholds_px: tuple[float, float] = (0.0, 0.0)
    """th_low and th_high that W_u-body was compared with."""
    measure: Measure | None = None
    refusal: str = ""
    """Why this posture is not the opening posture; "" where it is."""
    search: Search | None = None
    """The pose, where this view searched for it."""
    stick: Fit | None = None
    """The stick body, where the guide asked for one."""
