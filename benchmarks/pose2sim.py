"""Four cameras of a gait laboratory, two at a time: what do they make of whom they film?

Run: python benchmarks/pose2sim.py $TRITRACK_DATA/real/pose2sim_balancing --out DIR
    [--landmarks $TRITRACK_DATA/real/landmarks_mediapipe.npz] [--without-plates] [--size 640x480]

Writes a calibration and settings for each pair, measures the body in the trial's T-pose, tracks the
pair, prints in how many of the frames its status is `tracking`, which proves nothing, and writes a
contact sheet. What no label is needed for tells how right that is: how much of the body that a pair
has found is on the outline in the cameras that it did not look through, and how far apart the
joints lie that two pairs have found of the same instants. With --landmarks joints and knees are
held against those of another tracker, of all four cameras at once. Without plates the body has no
T-pose either, and the room is never seen empty.
"""

import argparse
import json
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from four_views import KNEES, bent_deg, joints_of
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from common.body.body import JOINT_NAMES
from common.body.proportions import body_vector
from common.bus.messages import Body, View
from common.config import config_file
from common.raster.kernel import draw_body, view_of
from common.raster.silhouette_report import mask_of
from common.raster.similarity import Mask
from common.rig.camera import Rig
from common.video.clip_facts import whole_rig
from integrator.rig.undistortion import undistorted
from runtime.offline.lockstep import Decoders, track_clip
from runtime.offline.performance import Watch
from runtime.store.runs import write_run
from viewer.captured_frame import CapturedFrame

PAIRS: Final = tuple(combinations(("cam01", "cam02", "cam03", "cam04"), 2))
Y_UP: Final = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Their world has z up; rows: our axes in theirs."""
BOXED: Final = (1080, 1920)
"""Size of the videos that were shrunk by 1080 / 1088 and put between black bars ..."""
WHOLE: Final = (1088, 1920)
BAR_PX: Final = 7
"""... so high each. Of the trial they are cam01's and cam02's, of the T-pose the other two's."""
EXCHANGED: Final = 0.7
"""Joints nearer to the other side's than so many of the distance to their own are exchanged."""
SHOWN: Final = 12
"""Frames on a contact sheet."""

Picture = NDArray[np.uint8]
Row = tuple[dict[Any, CapturedFrame], dict[int, View], Body]
"""The frames of an instant, the reports on them and the body that they gave."""


def cameras_of(given: dict[str, Any], boxed: tuple[str, ...]) -> dict[str, Any]:
    """Their `cameras.json` as ours: y up; their pixels have their centres at whole numbers.

    A distortion of the picture that a bar moves is left as it is: it is below a pixel.
    """
    cameras = []
    for camera in given["cameras"]:
        K = np.array(camera["K_calib"])
        if camera["name"] in boxed:
            K[1] *= BOXED[0] / WHOLE[0]  # and K[0] follows when the picture is taken as it is
            K[1, 2] += BAR_PX
        K[:2, 2] += 0.5
        cameras.append(
            {
                "name": camera["name"],
                "K": K.tolist(),
                "R": (np.array(camera["R_world_to_cam"]) @ Y_UP.T).tolist(),
                "t": camera["t_world_to_cam_m"],
                "distortion": camera["dist_qca"],
            }
        )
    return {"width": WHOLE[0], "height": WHOLE[1], "fps": 60.0, "cameras": cameras}


def rebarred(plate: Picture) -> Picture:
    """A plate of the trial as the T-pose has the same camera: bars taken away, or put there."""
    if plate.shape[1] == BOXED[0]:
        return np.asarray(cv2.resize(plate[BAR_PX:-BAR_PX], WHOLE), np.uint8)
    inside = cv2.resize(plate, (BOXED[0], BOXED[1] - 2 * BAR_PX))
    return np.asarray(cv2.copyMakeBorder(inside, BAR_PX, BAR_PX, 0, 0, cv2.BORDER_CONSTANT))


SETTINGS: Final = """{opening}
calibration = "{calibration}"
size = "{size}"
every = {every}

[cameras.cam1]
source = "{videos}{one}.mp4"
background = "{plate_one}"
calibrated_as = "{one}"

[cameras.cam2]
source = "{videos}{two}.mp4"
background = "{plate_two}"
calibrated_as = "{two}"
"""


def settings_of(one: str, two: str, plates: Path | None, **more: Any) -> str:
    """The settings of a pair, with the plates of a folder, if there are any."""
    names = ("", "") if plates is None else [f"{plates}/bg_{each}.png" for each in (one, two)]
    return SETTINGS.format(one=one, two=two, plate_one=names[0], plate_two=names[1], **more)


def write_settings(data: Path, out: Path, size: str, every: int, *, plates: bool) -> list[Path]:
    """The settings of each pair, and beside them what they name."""
    given = json.loads((data / "cameras.json").read_text())
    for name, boxed in (("trial", ("cam01", "cam02")), ("tpose", ("cam03", "cam04"))):
        (out / f"{name}.json").write_text(json.dumps(cameras_of(given, boxed)))
    for plate in data.glob("bg_*.png"):
        picture = np.asarray(cv2.imread(str(plate)), np.uint8)
        cv2.imwrite(str(out / plate.name), rebarred(picture))
    found = []
    for one, two in PAIRS:
        found.append(out / f"{one}_{two}.toml")
        opening = f"tpose_{one}_{two}.toml"
        of_trial = {"opening": f'opening = "{opening}"' if plates else ""}
        of_trial |= {"calibration": "trial.json", "videos": f"{data}/"}
        of_tpose = {"opening": "", "calibration": "tpose.json", "videos": f"{data}/tpose/T00_"}
        trial = settings_of(one, two, data if plates else None, size=size, every=every, **of_trial)
        found[-1].write_text(trial)
        tpose = settings_of(one, two, out.resolve(), size=size, every=1, **of_tpose)
        (out / opening).write_text(tpose)
    return found


def overlay(frame: CapturedFrame, report: View, body: Body, rig: Rig) -> Picture:
    """A view: blue the model alone, red the silhouette alone, green both."""
    n = report.viewer - 1
    picture = frame.picture // 2
    height, width = picture.shape[:2]
    seen = mask_of(report)
    if body.bdp is not None and body.pose:
        pose, view = np.array(body.pose), view_of(rig.cameras[n])
        model = draw_body(body_vector(body.bdp), pose, view, (width, height))
        for where, colour in ((model & ~seen, 0), (model & seen, 1), (seen & ~model, 2)):
            picture[where, colour] += 110
    text = f"{body.frame}: S {body.score[n]:.2f}"
    cv2.putText(picture, text, (4, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (255, 255, 255), 1)
    return picture


class Pair(NamedTuple):
    """What a pair has found, instant by instant."""

    rig: Rig
    outlines: dict[str, list[Mask]]
    """Of each of its cameras, straightened."""
    bodies: list[Body]


def pair_of(rig: Rig, rows: list[Row]) -> Pair:
    """What a pair has found, of the instants that its rig was shown."""
    outlines = {
        camera.name: [undistorted(mask_of(reports[n]), camera) for _, reports, _ in rows]
        for n, camera in enumerate(rig.cameras, 1)
    }
    return Pair(rig, outlines, [body for _, _, body in rows])


def elsewhere(own: Pair, other: Pair) -> list[float]:
    """IoU of the bodies with the outlines of the other pair's cameras that are not theirs."""
    found = []
    for camera in other.rig.cameras:
        if camera.name in own.outlines:
            continue
        for body, seen in zip(own.bodies, other.outlines[camera.name], strict=True):
            if body.bdp is not None and body.pose:
                size = (seen.shape[1], seen.shape[0])
                pose = np.array(body.pose)
                drawn = draw_body(body_vector(body.bdp), pose, view_of(camera), size)
                found.append(float((drawn & seen).sum() / (drawn | seen).sum()))
    return found


def compare(found: dict[str, Pair]) -> None:
    """Print how the pairs agree, with each other and with the cameras that they did not use."""
    for name, own in found.items():
        ious = [iou for other in found.values() for iou in elsewhere(own, other)]
        print(f"{name}: IoU {np.mean(ious):.2f} with the outlines of the other cameras")
    for (one, own), (two, other) in combinations(found.items(), 2):
        places = [
            np.array([body.joints_m or np.full((15, 3), np.nan) for body in each.bodies])
            for each in (own, other)
        ]
        off_mm = 1e3 * np.linalg.norm(places[0] - places[1], axis=2)
        print(f"{one} and {two} have joints {np.nanmedian(off_mm):.0f} mm apart (median)")


def compare_joints(found: dict[str, Pair], rig: Path, path: Path) -> None:
    """Print how far each pair's joints are from those of a file of landmarks, and in how many
    frames most of them are nearer to the other side's."""
    with np.load(path, allow_pickle=False) as given:
        names = given["joint_names"].tolist()
    due_m = joints_of(json.loads(rig.read_text()), path)
    own_places = [JOINT_NAMES.index(name) for name in names]
    others = [names.index({"l": "r", "r": "l"}[name[0]] + name[1:]) for name in names]
    for _, knee, ankle in KNEES:
        shank_m = np.linalg.norm(due_m[:, names.index(knee)] - due_m[:, names.index(ankle)], axis=1)
        print(f"landmarks: {knee} to {ankle} {shank_m.mean():.3f} m, +- {shank_m.std():.3f}")
    for name, own in found.items():
        posed = [body for body in own.bodies if body.joints_m]
        places_m = np.array([body.joints_m for body in posed])[:, own_places]
        due = due_m[[body.frame for body in posed]]
        off_m = np.linalg.norm(places_m - due, axis=2)
        crossed = np.linalg.norm(places_m - due[:, others], axis=2) < EXCHANGED * off_m
        print(
            f"{name}: {1e3 * off_m.mean():.0f} mm (median {1e3 * np.median(off_m):.0f}) from the "
            f"landmarks of all cameras, sides exchanged in {(crossed.mean(axis=1) > 0.5).sum()} "
            f"of {len(posed)} frames"
        )


def compare_knees(found: dict[str, Pair], rig: Path, path: Path) -> None:
    """Print by how much each pair has the knees straighter than a file of landmarks has them."""
    with np.load(path, allow_pickle=False) as given:
        names = given["joint_names"].tolist()
    due_deg = bent_deg(joints_of(json.loads(rig.read_text()), path), names)
    for name, own in found.items():
        posed = [body for body in own.bodies if body.joints_m]
        places_m = np.array([body.joints_m for body in posed])
        off_deg = bent_deg(places_m, list(JOINT_NAMES)) - due_deg[[body.frame for body in posed]]
        by, spread = np.median(off_deg, axis=0), np.median(np.abs(off_deg))
        print(
            f"{name}: knees straighter by {by[0]:.0f} (left) and {by[1]:.0f} degrees (right), off "
            f"by {spread:.0f} (medians)"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--size", default="240x427")
    parser.add_argument("--every", type=int, default=4, help="of 60 frames a second")
    parser.add_argument("--without-plates", action="store_true", help="nor the T-pose")
    parser.add_argument("--landmarks", type=Path, help="of the same videos, by another tracker")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    found: dict[str, Pair] = {}
    wanted = asked.data.resolve(), asked.out, asked.size, asked.every
    paths = write_settings(*wanted, plates=not asked.without_plates)
    with Decoders() as decoders:
        for path in paths:
            settings = config_file.load(path)
            rows: list[Row] = []
            tracked = track_clip(settings, decoders, watch=Watch(partial(_noted, rows), rows.clear))
            write_run(asked.out / path.stem, tracked.bodies, settings, tracked.facts)
            rig = whole_rig(tracked.clip)
            assert rig is not None
            sheet(rows, rig, asked.out / f"{path.stem}.png")
            found[path.stem] = pair_of(rig, rows)
            share = np.mean([body.status == "tracking" for body in tracked.bodies])
            print(f"{path.stem}: tracking in {share:.1%} of {len(tracked.bodies)} frames")
            print(*tracked.facts["warnings"], sep="\n")
    compare(found)
    if asked.landmarks is not None:
        compare_joints(found, asked.out / "trial.json", asked.landmarks)
        compare_knees(found, asked.out / "trial.json", asked.landmarks)


def _noted(rows: list[Row], frames: Any, reports: Any, bodies: tuple[Body, ...]) -> None:
    rows.append((frames, reports, bodies[0]))


def sheet(rows: list[Row], rig: Rig, path: Path) -> None:
    """Write some instants, both views of each, as one picture."""
    shown = rows[:: max(1, len(rows) // SHOWN)]
    high = max(frame.picture.shape[0] for frame in shown[0][0].values())
    views = []
    for frames, reports, body in shown:
        for number in (1, 2):
            one = overlay(frames[number], reports[number], body, rig)
            below = high - one.shape[0]
            views.append(cv2.copyMakeBorder(one, 0, below, 0, 0, cv2.BORDER_CONSTANT))
    views = views[: len(views) // 8 * 8]
    lines = [np.hstack(views[i : i + 8]) for i in range(0, len(views), 8)]
    cv2.imwrite(str(path), np.vstack(lines))


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
