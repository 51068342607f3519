"""Rendered clips, held against their own truth, the clip format and the yardstick of accuracy."""

import importlib.util
import json
from collections.abc import Iterator
from itertools import islice, pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from common.rig.camera import Rig, project
from common.rig.rig_file import load_rig
from synth.motion.motions import EMPTY, MOTION, POSTURES, Motion, performance
from synth.person.mesh import body_mesh
from synth.person.people import person
from synth.person.skeleton import JOINTS
from synth.picture.exposure import default_rig, exposures
from synth.picture.raster import skin
from synth.picture.render import Shot, render
from synth.write import ClipSet, SynthError, write_set

RIG = default_rig(160, 120)


def shots(motion: Motion, rig: Rig = RIG, someone: int = 1, seed: int = 9) -> Iterator[Shot]:
    return render(person(someone), motion, rig, 4, seed)


def shortened(motion: Motion, first: int, last: int) -> Motion:
    """Some frames of a motion alone."""
    arrays = ("joints_m", "bones", "angles_deg", "root_m", "phase")
    return motion._replace(**{name: getattr(motion, name)[first:last] for name in arrays})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two people, one posture, one take."""
    out = tmp_path_factory.mktemp("set")
    told: list[tuple[int, int]] = []
    write_set(
        out,
        ClipSet("postures", performers=2, postures=("kick_left_side",)),
        (160, 120),
        lambda *done: told.append(done),
    )
    assert told == [(1, 2), (2, 2)]
    return out


def test_the_default_rig_is_that_of_the_development_clips(data_dir: Path) -> None:
    theirs = load_rig(data_dir / "dev" / "calibration.json")
    points = np.random.default_rng(0).uniform(-1, 2, (50, 3))
    for ours, camera in zip(default_rig(320, 240).cameras, theirs.cameras, strict=True):
        np.testing.assert_allclose(project(ours, points), project(camera, points), atol=0.01)


def test_the_same_seeds_give_the_same_frames_and_others_others() -> None:
    motion = shortened(performance(person(1), "squat", 1), 40, 43)
    first, again = list(shots(motion)), list(shots(motion))
    for a, b in zip(first, again, strict=True):
        for x, y in zip(a, b, strict=True):
            np.testing.assert_array_equal(x, y)
    noise = next(shots(motion, seed=10))
    assert (noise.frames[0] != first[0].frames[0]).any()
    np.testing.assert_array_equal(noise.masks[0], first[0].masks[0])
    other = next(render(person(1), motion, RIG, 5, 9))
    assert np.abs(other.frames[0].astype(int) - first[0].frames[0]).mean() > 5


def joints_and_masks(posture: str, rig: Rig) -> tuple[int, int]:
    """How many joints lie in the picture, and how many of them within 2 px of the mask."""
    motion = performance(person(1), posture, 1)
    inside = seen = 0
    for i, shot in islice(enumerate(shots(motion, rig)), 10, None, 7):
        for camera, mask in zip(rig.cameras, shot.masks, strict=True):
            near = cv2.dilate(mask.astype(np.uint8), np.ones((5, 5), np.uint8))
            pixels = np.floor(project(camera, motion.joints_m[i])).astype(int)
            within = ((pixels >= 0) & (pixels < (rig.width, rig.height))).all(axis=1)
            seen += int(within.sum())
            inside += int(near[pixels[within, 1], pixels[within, 0]].sum())
    return seen, inside


@pytest.mark.slow
@pytest.mark.parametrize("posture", ["walk_toward", "squat_arms_forward", "free"])
def test_joints_lie_inside_the_silhouette(posture: str) -> None:
    seen, inside = joints_and_masks(posture, RIG)
    assert seen > 300
    assert inside >= 0.95 * seen


@pytest.mark.slow
def test_the_silhouette_is_the_body_and_no_limb_of_the_tracker() -> None:
    """Clothes are wider than the limbs; hands and feet reach beyond wrist and ankle."""
    rig = default_rig(320, 240)
    motion = shortened(performance(person(0), "walk_in_place", 1), 12, 13)
    mask = next(shots(motion, rig, someone=0)).masks[0]
    measures = person(0).measures
    rows, columns = np.nonzero(mask)
    px_per_m = 401.14 / (4.5 - motion.root_m[0, 2])
    assert abs(np.ptp(rows) / px_per_m - measures["stature_m"]) < 0.06
    span = measures["shoulder_width_m"] + 2 * (
        measures["upper_arm_m"] + measures["forearm_m"] + measures["hand_m"]
    )
    assert abs(np.ptp(columns) / px_per_m - span) < 0.1
    waist = project(rig.cameras[0], motion.joints_m[0, [JOINTS.index("navel")]])[0]
    width = mask[int(waist[1])].sum() / px_per_m
    assert width > 2 * measures["waist_halfwidth_m"]


def test_half_the_size_shows_the_same_silhouette() -> None:
    """Masks are exact: at 320x240, averaged down, they differ from 160x120 on the edge only."""
    motion = shortened(performance(person(1), "walk_toward", 1), 45, 46)
    small = next(shots(motion)).masks[0]
    large = next(shots(motion, default_rig(320, 240))).masks[0]
    share = cv2.resize(large.astype(np.float32), (160, 120), interpolation=cv2.INTER_AREA)
    assert (small[share > 0.9]).all()
    assert not (small[share < 0.1]).any()


@pytest.mark.parametrize("posture", ["squat", "walk_slow_bigswing", "free"])
def test_no_part_of_the_surface_is_below_the_floor(posture: str) -> None:
    someone = person(4)
    mesh, motion = body_mesh(someone), performance(someone, posture, 1)
    places = np.empty_like(mesh.vertices_m)
    for frames in motion.bones[9::4]:
        skin(mesh.vertices_m, mesh.origins_m, mesh.bones, mesh.shares, frames, places)
        assert places[:, 1].min() > -0.03


def test_the_surface_is_closed_and_faces_outwards() -> None:
    """Every edge belongs to two faces that pass it in opposite senses; the enclosed volume is a
    person's: about a litre a kilogram."""
    mesh = body_mesh(person(0))
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    there = {tuple(edge) for edge in edges.tolist()}
    assert len(there) == len(edges)
    assert all((b, a) in there for a, b in there)
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] for k in range(3))
    litres = 1000 * np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert 50 < litres < 160


def test_the_empty_room_is_still_but_for_noise_and_flicker() -> None:
    motion = shortened(performance(person(1), "squat", 1), 0, 9)
    frames = np.stack([shot.frames[0] for shot in shots(motion)]).astype(float)
    assert not np.stack([shot.masks[0] for shot in shots(motion)]).any()
    grain = (frames[:-1] - frames[1:]).std() / np.sqrt(2)
    assert 0.7 < grain < 4.0
    means = frames.mean(axis=(1, 2, 3))
    assert 0.1 < np.ptp(means) < 0.05 * means.mean()
    assert frames.mean(axis=0).std() > 8


def test_a_person_throws_a_shadow_outside_of_the_silhouette() -> None:
    motion = performance(person(1), "squat", 1)
    empty = shortened(motion, 0, 1)
    there = shortened(motion, 14, 15)
    before, after = next(shots(empty)), next(shots(there))
    away = ~cv2.dilate(after.masks[0].astype(np.uint8), np.ones((7, 7), np.uint8)).astype(bool)
    gain = exposures(2, 1, 9, motion.fps)
    np.testing.assert_array_equal(gain, exposures(2, 1, 9, motion.fps))
    darker = before.frames[0].astype(int).mean(axis=2) - after.frames[0].astype(int).mean(axis=2)
    assert (darker[away] > 8).sum() > 60


def decoded(path: Path) -> NDArray[np.uint8]:
    film = cv2.VideoCapture(str(path))
    frames: list[np.ndarray] = []
    while True:
        got, frame = film.read()
        if not got:
            return np.stack(frames)
        frames.append(frame)


@pytest.mark.slow
def test_a_clip_reads_back(folder: Path) -> None:
    clip = folder / "s00_t1_15_kick_left_side"
    assert sorted(path.name for path in folder.iterdir()) == [
        "calibration.json",
        "s00_t1_15_kick_left_side",
        "s01_t1_15_kick_left_side",
    ]
    meta = json.loads((clip / "meta.json").read_text())
    assert (meta["performer"], meta["posture"], meta["take"]) == ("s00", "kick_left_side", 1)
    with np.load(clip / "truth.npz") as truth:
        phase, present = truth["phase"], truth["present"]
        for n in (1, 2):
            frames = decoded(clip / f"cam{n}.avi")
            assert frames.shape == (len(phase), 120, 160, 3)
            mask = np.unpackbits(truth[f"mask_cam{n}"], axis=2).astype(bool)
            assert mask.shape == (len(phase), *truth["mask_shape"])
            assert (mask.any(axis=(1, 2)) == present).all()
            empty = np.median(frames[phase == EMPTY], axis=0)
            changed = np.abs(frames[20] - empty).max(axis=2) > 25
            assert (changed & mask[20]).sum() > 0.6 * mask[20].sum()
        assert np.isnan(truth["joints3d"][~present]).all()
        assert np.isfinite(truth["joints3d"][present]).all()


@pytest.mark.slow
def test_truth_has_the_arrays_of_the_development_clips(folder: Path, data_dir: Path) -> None:
    theirs = np.load(next((data_dir / "dev").glob("*_15_*/truth.npz")))
    ours = np.load(folder / "s00_t1_15_kick_left_side" / "truth.npz")
    assert sorted(ours.files) == sorted(theirs.files)
    for name in theirs.files:
        assert ours[name].dtype.kind == theirs[name].dtype.kind, name
        if not name.startswith("mask_cam"):
            assert ours[name].shape == theirs[name].shape, name
    for name in ("joint_names", "angle_names", "posture", "posture_id", "class5"):
        assert (ours[name] == theirs[name]).all(), name
    assert sorted(ours["measure_names"]) == sorted(theirs["measure_names"])


def test_a_set_is_written_the_same_byte_for_byte(folder: Path, tmp_path: Path) -> None:
    again = write_set(tmp_path, ClipSet("postures", postures=("kick_left_side",)), (160, 120))
    for name in ("cam1.avi", "cam2.avi", "meta.json"):
        assert (again[0] / name).read_bytes() == (folder / again[0].name / name).read_bytes()
    first, second = (np.load(f / again[0].name / "truth.npz") for f in (folder, tmp_path))
    for name in first.files:
        np.testing.assert_array_equal(first[name], second[name])


def test_people_of_other_sets_are_others(tmp_path: Path) -> None:
    (clip,) = write_set(tmp_path, ClipSet("postures", seed=3, postures=("squat",)), (160, 120))
    assert clip.name == "s03_t1_12_squat"


def test_the_yardstick_takes_the_truth_for_perfect(folder: Path, tmp_path: Path) -> None:
    """tools/score_tracking.py, where it lies beside the checkout: truth against itself is 0 mm."""
    script = Path(__file__).parents[2] / "shared" / "tools" / "score_tracking.py"
    if not script.exists():
        pytest.skip("no tools/score_tracking.py beside the checkout")
    spec = importlib.util.spec_from_file_location("score_tracking", script)
    assert spec is not None
    assert spec.loader is not None
    scoring = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scoring)
    clip = folder / "s01_t1_15_kick_left_side"
    with np.load(clip / "truth.npz") as truth:
        frames = np.flatnonzero(truth["present"])
        poses = {
            "frame": frames,
            "joints_m": truth["joints3d"][frames],
            "joint_names": truth["joint_names"],
        }
        found = scoring.summary([scoring.compare(poses, truth)])
    assert (found["coverage"], found["ghost"], found["lost"]) == (1.0, 0.0, 0.0)
    assert found["abs_mm"]["mean"] == 0.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"performers": 0}, "performers must be at least 1, got 0"),
        ({"takes": -1}, "takes must be at least 1, got -1"),
        ({"seed": -1}, "seed must not be negative, got -1"),
        ({"size": (8, 8)}, "8x8"),
        ({"postures": ("jump",)}, "jump.*walk_in_place"),
        ({"motion": "dance"}, "postures, free, fall, stream, spot, cross, got 'dance'"),
    ],
)
def test_what_cannot_be_made_is_refused(
    tmp_path: Path, change: dict[str, object], says: str
) -> None:
    asked: dict[str, object] = {
        "motion": "postures",
        "performers": 1,
        "takes": 1,
        "seed": 0,
        "size": (160, 120),
        "postures": POSTURES,
    } | change
    size = asked.pop("size")
    with pytest.raises(SynthError, match=says):
        write_set(tmp_path / "new", ClipSet(**asked), size)  # type: ignore[arg-type]
    assert not (tmp_path / "new").exists()


def test_takes_begin_alike_and_then_differ() -> None:
    """Empty, T-pose, motion: two takes of one person share the protocol, not the movement."""
    takes = [performance(person(1), "swing_both_backforth", n) for n in (1, 2)]
    np.testing.assert_array_equal(takes[0].phase, takes[1].phase)
    moving = takes[0].phase == MOTION
    apart = np.linalg.norm(takes[0].joints_m[moving] - takes[1].joints_m[moving], axis=-1)
    assert 0.02 < apart.max() < 0.6
    assert all((b >= a) for a, b in pairwise(takes[0].phase.tolist()))
