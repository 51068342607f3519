"""What a run does beyond the print: every departure by name, and the values that have names."""

from typing import Final, Literal

import msgspec

Mode = Literal["default", "paper", "thesis"]


class Method(msgspec.Struct, frozen=True, kw_only=True):
    """How pictures become a body: False is as the paper prints it, True a departure.

    Steps read its fields; none asks for the name of a mode. The ablation switches each field by
    itself. What is not listed is printed, or one of the readings without which the print does not
    run (M1 to M25, and where P and T of docs/requirements.md are ambiguous), or what the print
    leaves out in every mode: the pose before the opening posture and after a loss, found without a
    pose before it, and whether a pose is believed.
    """

    steady_light: bool
    """Silhouettes are cut out under the light of each frame: exposure and flicker do not count."""
    pixel_evidence: bool
    """Pixels are told by the noise of each, forgiven soft shadows, and their neighbours; otherwise
    by a threshold around what the empty background showed, opened and closed (P3)."""
    body_colours: bool
    """What colours body and background have is learnt while one looks."""
    alpha_matte: bool
    """A small network draws the contour again, by how much of each pixel the body covers."""
    slow_light: bool
    """The background takes on the slow changes of the light."""

    follows_cameras: bool
    """A camera that is moved is noticed by its background, which is moved with it."""

    landmarks: bool
    """The viewer looks for joints in the picture itself; the body is made of those and outlines."""
    clutter_removal: bool
    """What both views do not show as one piece of space is no part of the person, where the network
    is surer of what is left."""

    armless_shift: bool
    """The body's place is searched by trunk, head and legs: arms still have old angles (P27)."""
    raised_arm_ranges: bool
    """The range of theta_Z turns over with an arm that is swung up past the horizontal (P30)."""
    hidden_arms: bool
    """An arm is moved in the flank only for a gain in S: one that is hidden there stays (P32)."""
    common_squat: bool
    """The flank also searches for both legs as one squat (P35)."""
    squat_first: bool
    """Who squats by the facade lifts no leg, whatever theta_Z of the hip (P53)."""
    steady_elbows: bool
    """Algorithm 4 asks for a bend of 15 degrees, away from a curve's ends, and takes the split with
    the least residual, not the largest difference (T16)."""

    legs_to_floor: bool
    """Measured legs reach from the navel to the floor: toes are nearer to a camera than soles."""
    scaled_arbiter: bool
    """The arbiter holds widths of both views against each other at one scale (P48)."""
    held_facing: bool
    """One view that is left alone does not change the facing of a body that both have measured."""
    shared_start: bool
    """Viewers start where and how both views have the body, not as each had it itself (L1)."""
    squat_votes: bool
    """Both silhouettes vote on squats with a bowed trunk."""
    place_votes: bool
    """They vote on where the body is."""
    arm_votes: bool
    """They vote on which arm it is that swings, and regain an arm that was lost (L2, L3)."""
    turn_votes: bool
    """They vote joint by joint on a body that was not measured in the opening posture."""

    proposals: bool
    """A network with memory proposes the joints from the silhouettes; nothing is searched for."""
    lifting: bool
    """A second network lifts the joints from landmarks alone: what one outline tells, and what both
    tell of who leans far, is joined with them."""
    free_joints: bool
    """Joints may lie beside the cylinders' ends: shoulders rise, and people differ."""
    shape_fit: bool
    """The body's widths and arms are fitted to silhouettes as the person moves."""
    reflection: bool
    """One view alone remembers front and back: a proposal that jumps between them is reflected."""
    joint_limits: bool
    """One view's limbs are held within the limits of their joints in space (P30, P35)."""
    smoothing: bool
    """Published angles are smoothed by a Kalman filter."""
    film_smoothing: bool
    """Joints of a film that is followed in passes are smoothed by what comes after as well, and its
    limbs keep their lengths."""

    density_recognizer: bool
    """Postures are named by densities of angles and of their course, not by 64 symbols (P57)."""

    stick_lifting: bool
    """The thesis's own way for one view: a stick body is fitted and lifted (T10 to T22)."""


def _all(departs: bool) -> Method:
    return Method(**dict.fromkeys(Method.__struct_fields__, departs))


PAPER: Final = _all(False)
"""Huang & Chung 2004, as printed, with the readings that make it run."""
DEFAULT: Final = msgspec.structs.replace(_all(True), stick_lifting=False)
"""The best that is known today."""
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
"""Demir 2006, as printed from the silhouette on: its own threshold has no value (T8), and it names
no postures."""

METHODS: Final[dict[Mode, Method]] = {"default": DEFAULT, "paper": PAPER, "thesis": THESIS}
"""By the names that settings and commands use."""
