"""What each stage makes of one performance by our own made-up person, a picture a stage.

    .venv/bin/python benchmarks/stage_figures.py docs/pictures

Person and room are those of `tritrack synth`; everything else is what `tritrack track` does.
"""

import sys
import tempfile
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from house_figure import save
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from animator.skeleton.foot_contact import SIDES, stances
from animator.skeleton.planted_feet import planted
from common.body.body import ANGLE_INDEX, JOINT_NAMES, LIMB_ENDS
from common.bus.messages import Body, View
from common.config.settings import Settings
from common.raster.silhouette_report import mask_of
from common.video.pictures import Image
from recognizer.__main__ import SHIPPED, step
from recognizer.__main__ import init as recognizer_init
from recognizer.model_file import load
from runtime.offline.lockstep import Decoders, track_clip
from runtime.offline.performance import Watch
from runtime.store.joint_arrays import all_joints_m
from runtime.store.pose_arrays import poses
from synth.write import ClipSet, write_set

POSTURE: Final = "kick_right_forward"
SIZE: Final = (320, 240)
SEED: Final = 4242
RIGHT_ANKLE: Final = JOINT_NAMES.index("r_ankle")
GREY, RIGHT, LEFT, TRUNK = "#c9c9cf", "#c0392b", "#1f6fb2", "#3b3b44"


class Seen(NamedTuple):
    """One instant as the stages hand it on."""

    pictures: dict[int, Image]
    reports: dict[int, View]
    body: Body


def performance() -> list[Seen]:
    """Every instant of a clip."""
    seen: list[Seen] = []
    with tempfile.TemporaryDirectory() as folder, Decoders() as decoders:
        (clip,) = write_set(Path(folder), ClipSet("postures", seed=SEED, postures=(POSTURE,)), SIZE)

        def watch(frames: Any, reports: Any, bodies: tuple[Body, ...]) -> None:
            pictures = {n: frame.picture for n, frame in frames.items()}
            seen.append(Seen(pictures, dict(reports), bodies[0]))

        track_clip(Settings(clip=str(clip), size="320x240"), decoders, watch=Watch(watch))
    return seen


def viewer_figure(instant: Seen, out: Path) -> None:
    """Both cameras: the picture, the outline, the landmarks."""
    rows = [_viewer_row(instant.pictures[n], instant.reports[n]) for n in (1, 2)]
    _write(out, np.concatenate(rows, axis=0))


def _viewer_row(picture: Image, report: View) -> Image:
    mask = mask_of(report)
    outline = np.where(mask[..., None], 255, 30).astype(np.uint8).repeat(3, axis=2)
    landmarks = np.clip(picture * 0.6, 0, 255).astype(np.uint8)
    shown = None if report.person is None else report.person.landmarks
    assert shown is not None
    for (x, y), sure in zip(shown.joints_px, shown.confidence, strict=True):
        colour = (0, round(255 * sure), round(255 * (1 - sure)))
        cv2.circle(landmarks, (round(x), round(y)), 3, colour, -1, cv2.LINE_AA)
    return np.concatenate([picture, outline, landmarks], axis=1)


def body_figure(instant: Seen, out: Path) -> None:
    """The body over both pictures, and in the room."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 3.0))
    for n in (1, 2):
        axes = figure.add_axes(((n - 1) * 0.33, 0.0, 0.33, 0.9))
        grey = cv2.cvtColor(instant.pictures[n], cv2.COLOR_BGR2GRAY)
        axes.imshow(grey // 20 * 10 + 115, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
        at = np.array(instant.body.joints_px[n - 1])
        _stick(axes, at)
        axes.set_title(f"camera {n}: S {instant.body.score[n - 1]:.2f}", size=9)
        axes.axis("off")
    room: Any = figure.add_axes((0.665, 0.0, 0.3, 1.0), projection="3d")
    places = np.array(instant.body.joints_m)[:, [0, 2, 1]] * (1, -1, 1)
    _stick(room, places)
    room.set(zlim=(0.0, 1.8), xlim=(-0.9, 0.9), ylim=(-0.9, 0.9))
    room.set_title("in the room, metres", size=9)
    room.set(xticks=(-0.8, 0, 0.8), yticks=(-0.8, 0, 0.8), zticks=(0, 0.6, 1.2, 1.8))
    room.tick_params(labelsize=7)
    room.view_init(12, -60)
    save(figure, out)


def _stick(axes: Any, at: NDArray[np.float64]) -> None:
    for near, far in LIMB_ENDS.tolist():
        name = JOINT_NAMES[far]
        colour = {"l": LEFT, "r": RIGHT}[name[0]] if name[1] == "_" else TRUNK
        axes.plot(*at[[near, far]].T, color=colour, lw=2.5)


def recognizer_figure(bodies: list[Body], out: Path) -> None:
    """Angles over time, and the postures' log likelihoods."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 4.2))
    upper, lower = figure.subplots(2, 1, sharex=True)
    arrays = poses(bodies)
    for name, colour in (("r_hip_x", RIGHT), ("l_hip_x", LEFT), ("r_knee_x", TRUNK)):
        angles = arrays["angles_deg"][:, ANGLE_INDEX[name]]
        upper.plot(arrays["time_s"], angles, color=colour, label=name)
    upper.set_ylabel("degrees")
    state, scores = recognizer_init(load(SHIPPED), Settings().recognizer.window_frames), []
    for body in bodies:
        state, posture = step(state, body)
        scores.append(posture.log_likelihoods)
    for name in sorted({name for each in scores for name in each}):
        values = [each.get(name, np.nan) for each in scores]
        told = {"color": RIGHT, "lw": 2.5, "label": name} if name == POSTURE else {"color": GREY}
        lower.plot(arrays["time_s"], values, **told)
    lower.set(xlabel="seconds", ylabel="log likelihood")
    for axes in (upper, lower):
        axes.legend(fontsize=8, loc="upper left")
    figure.tight_layout()
    save(figure, out)


def feet_figure(bodies: list[Body], out: Path) -> None:
    """When feet stand, and where the ankles are in the files."""
    from matplotlib.figure import Figure

    arrays = poses(bodies)
    joints_m, time_s = all_joints_m(arrays), arrays["time_s"]
    held = planted(joints_m, time_s).joints_m
    figure = Figure(figsize=(9.6, 3.4))
    for axes, side in zip(figure.subplots(1, 2, sharey=True), SIDES[::-1], strict=True):
        at = JOINT_NAMES.index(f"{side}_ankle")
        for axis, name, dash in ((0, "aside", "-"), (1, "high", "--"), (2, "ahead", ":")):
            axes.plot(time_s, joints_m[:, at, axis], dash, color=GREY)
            axes.plot(time_s, held[:, at, axis], dash, color="black", lw=1, label=name)
        for stance in stances(joints_m, time_s):
            if stance.side == side:
                span = (time_s[stance.first], time_s[stance.end - 1])
                axes.axvspan(*span, color="#def0df", lw=0)
        axes.set(title=f"{side}_ankle: green, it stands; grey, as tracked", xlabel="seconds")
        axes.title.set_fontsize(9)
        axes.legend(fontsize=8)
    figure.axes[0].set_ylabel("metres")
    figure.tight_layout()
    save(figure, out)


def _write(out: Path, picture: Image) -> None:
    """As a PNG of few colours."""
    from PIL import Image as Picture

    Picture.fromarray(picture[..., ::-1].copy()).quantize(96).save(out, "PNG", optimize=True)


def main() -> None:
    """Draw all."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    seen = performance()
    bodies = [instant.body for instant in seen]
    posed = [instant for instant in seen if instant.body.pose]
    highest = max(posed, key=lambda instant: instant.body.joints_m[RIGHT_ANKLE][1])
    viewer_figure(highest, folder / "viewer.png")
    body_figure(highest, folder / "body.png")
    recognizer_figure(bodies, folder / "recognizer.png")
    feet_figure(bodies, folder / "feet.png")


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
