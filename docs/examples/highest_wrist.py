"""How high the left wrist of a recorded clip comes. Argument: the clip's folder."""

import sys

from tritrack import JOINT_NAMES, track

wrist = JOINT_NAMES.index("l_wrist")
heights_m = [body.joints_m[wrist][1] for body in track(sys.argv[1]) if body.joints_m]
print(f"{max(heights_m):.3f} m in {len(heights_m)} frames")
