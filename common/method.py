"""Departures from the printed papers, each by its name, and the combinations that have names."""

from typing import Final, Literal

import msgspec

Mode = Literal["default", "paper", "thesis"]


class Method(msgspec.Struct, frozen=True, kw_only=True):
    """How pictures become a body; each field: False is as the paper prints it, True a departure.

    Steps read the fields; none asks for the name of a mode. The ablation switches each field alone.
    Everything else is as printed, with two exceptions. Some readings are needed for the print to
    run (M1 to M25, and where P and T of docs/requirements.md are ambiguous). Some things the print
    leaves open in every mode: the pose before the opening posture and after a loss, and whether a
    pose is believed.
    """

    steady_light: bool
    """Silhouettes are segmented under the light of each frame: exposure and flicker do not
    matter."""
    pixel_evidence: bool
    """Pixels are classified by each one's noise, by soft shadows that are allowed, and by their
    neighbours; otherwise by a threshold around the empty background, opened and closed (P3)."""
    body_colours: bool
    """The colours of body and background are learnt during the run."""
    alpha_matte: bool
    """A small network redraws the contour, by the share of each pixel that the body covers."""
    slow_light: bool
    """The background follows slow changes of the light."""

    follows_cameras: bool
    """A moved camera is detected by its background, which is moved with it."""

    landmarks: bool
    """The viewer detects joints in the picture itself; the body is estimated from those and
    silhouettes."""
    clutter_removal: bool
    """Clutter is removed: parts of the silhouettes that both views do not show as one piece of
    space, where the network is surer without them."""

    armless_shift: bool
    """The body's place is searched with trunk, head and legs: arms still have old angles (P27)."""
    raised_arm_ranges: bool
    """The range of theta_Z is mirrored for an arm that is swung up past the horizontal (P30)."""
    hidden_arms: bool
    """An arm in the flank view moves only for a gain in S: a hidden one stays (P32)."""
    common_squat: bool
    """The flank view also searches for both legs as one squat (P35)."""
    squat_first: bool
    """A person who squats in the facade view lifts no leg, whatever theta_Z of the hip (P53)."""
    steady_elbows: bool
    """Algorithm 4 asks for a bend of 15 degrees, away from a curve's ends, and takes the split with
    the least residual, not the largest difference (T16)."""

    legs_to_floor: bool
    """Measured legs reach from the navel to the floor: toes are nearer to a camera than soles."""
    scaled_arbiter: bool
    """The arbiter compares the widths in both views at one scale (P48)."""
    held_facing: bool
    """A single remaining view does not change the facing of a body that two have measured."""
    shared_start: bool
    """Viewers start from both views' estimate of the body, not each from its own (L1)."""
    squat_votes: bool
    """Both silhouettes vote on squats with a bowed trunk."""
    place_votes: bool
    """Both silhouettes vote on the body's place."""
    arm_votes: bool
    """Both silhouettes vote on which arm swings, and recover an arm that was lost (L2, L3)."""
    turn_votes: bool
    """Both silhouettes vote joint by joint on a body that the opening posture did not measure."""

    proposals: bool
    """A recurrent network proposes the joints from the silhouettes; nothing is searched for."""
    lifting: bool
    """A second network lifts the joints from landmarks alone. It is joined to the first where
    one view is alone, and where the person leans far."""
    free_joints: bool
    """Joints may lie beside the cylinders' ends: shoulders rise, and people differ."""
    shape_fit: bool
    """The body's widths and arms are fitted to silhouettes as the person moves."""
    reflection: bool
    """A single view remembers front and back: a proposal that jumps between them is reflected."""
    joint_limits: bool
    """A single view's limbs are held within the limits of their joints in space (P30, P35)."""
    smoothing: bool
    """Published angles are smoothed by a Kalman filter."""
    film_smoothing: bool
    """Joints of a clip that is tracked in passes are smoothed with later frames too, and limbs
    keep their lengths."""

    density_recognizer: bool
    """Postures are modelled by densities of angles and their course, not by 64 symbols (P57)."""

    stick_lifting: bool
    """The thesis's method for one view: a stick body is fitted and lifted (T10 to T22)."""


def _all(departs: bool) -> Method:
    return Method(**dict.fromkeys(Method.__struct_fields__, departs))


PAPER: Final = _all(False)
"""Huang & Chung 2004, as printed, with the readings that make it run."""
DEFAULT: Final = msgspec.structs.replace(_all(True), stick_lifting=False)
"""The best method known today."""
THESIS: Final = msgspec.structs.replace(
    PAPER,
    steady_light=True,
    pixel_evidence=True,
    body_colours=True,
    alpha_matte=True,
    slow_light=True,
    density_recognizer=True,
    stick_lifting=True,
)
"""Demir 2006, as printed from the silhouette on: its own threshold has no value (T8), and it
names no postures."""

METHODS: Final[dict[Mode, Method]] = {"default": DEFAULT, "paper": PAPER, "thesis": THESIS}
"""The named methods of settings and commands."""
