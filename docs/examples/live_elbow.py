"""The bend of the left elbow of a live run, as it comes. Argument: the run's endpoint."""

import sys

from tritrack import POSE_INDEX, subscribe

for body in subscribe(*sys.argv[1:2]):
    if body.pose:
        print(f"{body.captured_s:.2f} s  {body.pose[POSE_INDEX['l_elbow_x']]:.0f} degrees")
print("the run is over")
