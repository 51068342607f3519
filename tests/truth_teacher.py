"""A teacher for tests: keypoint files that tell exactly where the joints of a made-up clip are."""

import json
from pathlib import Path

import numpy as np

from viewer.landmarks.fifteen_joints import NECK_SHARES, TOP_SHARES
from viewer.landmarks.keypoint_layouts import BODY_POINTS


def keypoints_of(clip: Path, camera: int, folder: Path) -> Path:
    """Files of one camera's frames; nose and ears lie where our neck and head follow from them."""
    folder.mkdir(parents=True, exist_ok=True)
    with np.load(clip / "truth.npz", allow_pickle=False) as truth:
        names = [str(name) for name in truth["joint_names"]]
        shown = zip(
            truth[f"frames_cam{camera}"],
            truth[f"joints2d_cam{camera}"],
            truth["present"],
            strict=True,
        )
        for frame, places, present in shown:
            if present:
                told = {
                    "people": [
                        {
                            "pose_keypoints_2d": _points(
                                dict(zip(names, places.astype(float), strict=True))
                            )
                        }
                    ]
                }
                (folder / f"{frame:06d}_keypoints.json").write_text(json.dumps(told))
    return folder


def _points(at: dict[str, np.ndarray]) -> list[float]:
    """COCO's 17 points, as files tell them."""
    shoulders, hips = ((at[f"l_{part}"] + at[f"r_{part}"]) / 2 for part in ("shoulder", "hip"))
    up = shoulders - hips
    ears = shoulders + (at["neck"] - shoulders - NECK_SHARES[0] * up) / NECK_SHARES[1]
    beside = ears + TOP_SHARES[0] * up + TOP_SHARES[1] * (ears - shoulders)
    head = {"nose": ears + (at["head_top"] - beside) / TOP_SHARES[2]}
    points = {**at, **dict.fromkeys(("l_eye", "r_eye", "l_ear", "r_ear"), ears), **head}
    return [number for name in BODY_POINTS for number in (*(points[name] - 0.5), 0.9)]
