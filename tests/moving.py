"""A rigid body that moves smoothly: what every file of motion must give back."""

import numpy as np

from common.body.body import DOF_NAMES, LIMITS_DEG, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp


def rigid_body() -> np.ndarray:
    """A body that bends where its cylinders meet, so that its landmarks keep their distances.

    The published landmarks lie at mean adult heights beside the bends, and their distances change
    by centimetres with them (common/body/body.py, HIP_SHARE and its like).
    """
    bdp = thesis_bdp(1.75)
    body = body_vector(bdp)
    body[29:31], body[33:35] = bdp.r_upper_arm.height, bdp.r_upper_leg.height
    body[37] = 0.0
    return body


BODY = rigid_body()


def random_joints(seed: int, n: int = 40) -> np.ndarray:
    """Smooth poses within the limits of the joints."""
    rng = np.random.default_rng(seed)
    ends = []
    for _ in range(2):
        pose = rest_pose()
        pose[:3] = rng.uniform(-1, 1, 3)
        for name in DOF_NAMES:
            low, high = LIMITS_DEG.get(name, (-40.0, 40.0))
            pose[POSE_INDEX[name]] = rng.uniform(low, high)
        ends.append(pose)
    shares = np.linspace(0.0, 1.0, n)
    return np.array([joints(BODY, (1 - s) * ends[0] + s * ends[1]) for s in shares])
