"""A body that moves by formula, for the page: `python tests/show_page.py [PORT]` shows it."""

import itertools
import math
import sys
import time

import cv2
import msgspec
import numpy as np

from animator.page.inset import limb_contours, limb_ends
from animator.page.live import LivePage
from animator.scene import Figure, Known, Snapshot
from common.body.body import POSE_INDEX, Vector, rest_pose
from common.body.extremities import extremities
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.bus.control_messages import Pulse
from common.bus.messages import Body, Posture, ViewerNumber
from common.raster.silhouette_report import mask_of, silhouette_view
from common.rig.camera import Camera, paper_rig, project

RATE_HZ = 15
STATURE_M = 1.72
BDP = thesis_bdp(STATURE_M)
LEG_M = BDP.r_upper_leg.height + BDP.r_lower_leg.height
ANKLE_M = 0.039 * STATURE_M
VIEWERS: tuple[ViewerNumber, ...] = (1, 2)
RIG = paper_rig((160, 120), (200.0, 200.0), (4.5, 4.5))


def snapshot_at(frame: int, x_m: float = 0.0) -> Snapshot:
    """What a run without fault would say of a body that walks in place, `x_m` aside."""
    seconds = frame / RATE_HZ
    pose = pose_at(seconds)
    pose[POSE_INDEX["x"]] += x_m
    masks = [silhouette(camera, pose) for camera in RIG.cameras]
    joints_m = joints(body_vector(BDP), pose)
    ends_m = extremities(joints_m, STATURE_M)
    in_pictures = [project(camera, joints_m) for camera in RIG.cameras]
    ends_in_pictures = [project(camera, ends_m) for camera in RIG.cameras]
    return Snapshot(
        body=Body(
            frame=frame,
            captured_s=seconds,
            clock_s=seconds,
            status="tracking",
            views="both",
            joints_m=tuple(tuple(place) for place in joints_m.tolist()),
            joints_px=tuple(tuple(map(tuple, seen.tolist())) for seen in in_pictures),
            extremities_m=tuple(tuple(place) for place in ends_m.tolist()),
            extremities_px=tuple(tuple(map(tuple, seen.tolist())) for seen in ends_in_pictures),
            extremities_confidence=(0.8, 0.8, 0.8, 0.0, 0.8, 0.8, 0.0),
            confidence=(0.9,) * 9 + (0.9, 0.5, 0.2, 0.9, 0.9, 0.9),
            pose=tuple(pose.tolist()),
            score=(0.86, 0.79),
            bdp=BDP,
        ),
        reports={
            n: silhouette_view(n, mask, frame, seconds)
            for n, mask in zip(VIEWERS, masks, strict=True)
        },
        posture=Posture(
            frame=frame,
            captured_s=seconds,
            clock_s=seconds,
            name="walk_in_place",
            doing="walk_in_place",
            log_likelihoods={"walk_in_place": -61.0, "squat": -142.5, "kick_left_side": -171.2},
            segment=(max(0, frame - 39), frame),
        ),
    )


def two_at(frame: int, aside_m: float = 0.7) -> Snapshot:
    """The same of two people on either side of the room's middle, the second half a second
    behind and with a posture of their own."""
    first, second = beside(frame, 1, -aside_m), beside(frame + RATE_HZ // 2, 2, aside_m)
    body, posture = second.body, second.posture
    assert body is not None
    assert posture is not None
    now = {"frame": frame, "captured_s": frame / RATE_HZ, "clock_s": frame / RATE_HZ}
    other = Known(
        msgspec.structs.replace(body, **now),
        msgspec.structs.replace(
            posture, **now, name="squat", doing="squat", log_likelihoods={"squat": -60.0}
        ),
    )
    masks = [mask_of(first.reports[n]) | mask_of(second.reports[n]) for n in VIEWERS]
    reports = {
        n: silhouette_view(n, mask, frame, frame / RATE_HZ)
        for n, mask in zip(VIEWERS, masks, strict=True)
    }
    return msgspec.structs.replace(first, reports=reports, others=(other,))


def beside(frame: int, person: int, x_m: float) -> Snapshot:
    """As `snapshot_at`, but at another place, and with a number."""
    seen = snapshot_at(frame, x_m)
    assert seen.body is not None
    assert seen.posture is not None
    return msgspec.structs.replace(
        seen,
        body=msgspec.structs.replace(seen.body, person=person),
        posture=msgspec.structs.replace(seen.posture, person=person),
    )


def pulses() -> list[Pulse]:
    return [
        Pulse(process=name, state="running", fps=15.0, latency_p50_ms=ms)
        for name, ms in (("viewer 1", 4.0), ("viewer 2", 4.5), ("integrator", 11.0))
    ]


def pose_at(seconds: float) -> Vector:
    """Arms and legs swing against each other, once a second."""
    pose = rest_pose()
    swing = math.sin(2.0 * math.pi * seconds)
    pose[POSE_INDEX["y"]] = LEG_M + ANKLE_M
    for side, sign in (("r", 1.0), ("l", -1.0)):
        pose[POSE_INDEX[f"{side}_shoulder_x"]] = sign * 40.0 * swing
        pose[POSE_INDEX[f"{side}_hip_x"]] = 60.0 * max(0.0, -sign * swing)
        pose[POSE_INDEX[f"{side}_knee_x"]] = -120.0 * max(0.0, -sign * swing)
    return pose


def silhouette(camera: Camera, pose: Vector) -> np.ndarray:
    """The body as a camera would see it, (120, 160)."""
    mask = np.zeros((120, 160), np.uint8)
    for outline in limb_contours(camera, limb_ends(Figure(BDP, pose))):
        cv2.fillConvexPoly(mask, np.rint(outline - 0.5).astype(np.int32), 1)
    return mask.astype(bool)


def main(port: int) -> None:
    page = LivePage("a body that moves by formula", port, commands=False)
    page.set_rig(RIG)
    print(f"open {page.address} in a browser; Ctrl-C ends")
    try:
        for frame in itertools.count():
            page.show(snapshot_at(frame))
            page.show_health(pulses())
            time.sleep(1.0 / RATE_HZ)
    except KeyboardInterrupt:
        page.close()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 8080)
