"""Sets of made-up clips: whose they are, what is written of each, and what is refused."""

import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from common.rig.camera import paper_rig, project
from common.rig.rig_file import load_rig
from synth import write
from synth.motion.motions import POSTURES, Act, Motion, performance
from synth.person.people import MEASURE_NAMES, measure_vector, person
from synth.person.skeleton import ANGLES, JOINTS
from synth.picture.exposure import default_rig, exposures
from synth.picture.render import Shot
from synth.write import ClipSet, Filming, SynthError, clip_name, write_clip, write_rig, write_set

SIZE = (64, 48)
RIG = paper_rig(SIZE, (80.0, 90.0), (4.5, 4.0), (1.0, 1.25))


def brief() -> Motion:
    """Six frames of a walk, the first before anybody is there."""
    motion = performance(person(2), "walk_sideways", 3, 12.5)
    names = ("joints_m", "bones", "angles_deg", "root_m", "phase")
    some = [0, 25, 40, 41, 50, 51]
    short = motion._replace(**{name: getattr(motion, name)[some] for name in names})
    return short._replace(acts=(Act("walk_sideways", 2, 5),))


def shots(count: int) -> Iterator[Shot]:
    """Frames that brighten, the second camera's twice as bright; masks that grow from the left."""
    for n in range(count):
        mask = np.zeros((48, 64), np.bool_)
        mask[n:40, : 3 * n] = True
        frame = np.full((48, 64, 3), 20 * n, np.uint8)
        yield Shot((frame, 2 * frame), (mask, mask[::-1]))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One clip, of made-up pictures."""
    out = tmp_path_factory.mktemp("set") / "deep" / "clip"
    asked: list[Any] = []

    def rendered(*arguments: Any) -> Iterator[Shot]:
        asked.append(arguments)
        return shots(6)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(write, "render", rendered)
        write_clip(out, person(2), brief(), Filming(RIG, 17, 1003, True), 3)
    ((someone, motion, rig, room_seed, seed, moving),) = asked
    assert (someone, rig, room_seed, seed, moving) == (person(2), RIG, 17, 1003, True)
    assert motion.posture == "walk_sideways"
    return out


def test_the_films_have_each_cameras_pictures_in_order_at_the_rate(folder: Path) -> None:
    for number in (1, 2):
        film = cv2.VideoCapture(str(folder / f"cam{number}.avi"))
        assert film.get(cv2.CAP_PROP_FPS) == 12.5
        means = []
        while (got := film.read())[0]:
            assert got[1].shape == (48, 64, 3)
            means.append(got[1].mean())
        assert means == pytest.approx([20 * number * n for n in range(6)], abs=2)


def test_the_masks_are_each_cameras_packed_by_rows(folder: Path) -> None:
    truth = np.load(folder / "truth.npz")
    assert truth["mask_shape"].tolist() == [48, 64]
    for name, turned in (("mask_cam1", 1), ("mask_cam2", -1)):
        masks = np.unpackbits(truth[name], axis=2, count=64).astype(bool)
        due = [shot.masks[0][::turned] for shot in shots(6)]
        np.testing.assert_array_equal(masks, due)


def test_the_truth_is_of_this_motion_and_these_cameras(folder: Path) -> None:
    truth, motion = np.load(folder / "truth.npz"), brief()
    np.testing.assert_allclose(truth["joints3d"], motion.joints_m, atol=1e-6)
    for camera, name in zip(RIG.cameras, ("joints2d_cam1", "joints2d_cam2"), strict=True):
        for n in (1, 5):
            np.testing.assert_allclose(
                truth[name][n], project(camera, motion.joints_m[n]), atol=1e-3
            )
    assert truth["time"] == pytest.approx(np.arange(6) / 12.5)
    assert truth["frames_cam1"].tolist() == truth["frames_cam2"].tolist() == [*range(6)]
    for name, due in (
        ("phase", motion.phase),
        ("present", motion.present),
        ("angles", motion.angles_deg.astype(np.float32)),
        ("root", motion.root_m.astype(np.float32)),
        ("measures", measure_vector(person(2))),
        ("gain", exposures(2, 6, 1003, 12.5).astype(np.float32)),
    ):
        np.testing.assert_array_equal(truth[name], due)
    assert truth["joint_names"].tolist() == [*JOINTS]
    assert truth["angle_names"].tolist() == [*ANGLES]
    assert truth["measure_names"].tolist() == [*MEASURE_NAMES]
    assert (str(truth["posture"]), int(truth["take"])) == ("walk_sideways", 3)
    assert int(truth["posture_id"]) == POSTURES.index("walk_sideways")
    assert str(truth["performer"]) == person(2).name
    steps_m = np.linalg.norm(np.diff(motion.joints_m, axis=0), axis=2).max(axis=1)
    assert truth["blurred"].tolist() == [False, *(np.nan_to_num(steps_m) > 0.06).tolist()]
    assert 0 < truth["blurred"].sum() < 5


def test_the_notes_say_who_did_what_and_when(folder: Path) -> None:
    notes, someone, motion = json.loads((folder / "meta.json").read_text()), person(2), brief()
    phases = [int((motion.phase == n).sum()) for n in range(4)]
    assert notes["phases"] == dict(
        zip(("empty", "tpose", "transition", "motion"), phases, strict=True)
    )
    assert {name: notes[name] for name in ("performer", "posture", "posture_id", "take")} == {
        "performer": someone.name,
        "posture": "walk_sideways",
        "posture_id": POSTURES.index("walk_sideways"),
        "take": 3,
    }
    assert (notes["room"], notes["seed"], notes["fps"], notes["n_frames"]) == (17, 1003, 12.5, 6)
    assert (notes["sex"], notes["look"].keys()) == (someone.sex, someone.look._asdict().keys())
    assert notes["acts"] == [{"name": "walk_sideways", "first": 2, "last": 5}]
    assert notes["measures"] == {n: round(someone.measures[n], 4) for n in MEASURE_NAMES}
    assert notes["style"] == pytest.approx(motion.style._asdict(), abs=5.1e-5)
    assert all(value == round(value, 4) for value in notes["style"].values())


def test_a_film_that_cannot_be_written_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(write, "render", lambda *_: shots(6))
    (tmp_path / "cam2.avi").mkdir()
    with pytest.raises(
        SynthError, match=r"cannot write .*cam2\.avi: is the folder writable, the d"
    ):
        write_clip(tmp_path, person(2), brief(), Filming(RIG, 17, 3), 3)


def made(
    monkeypatch: pytest.MonkeyPatch, out: Path, wanted: ClipSet
) -> tuple[list[Path], list[Any], list[Any], list[Any]]:
    """Folders; what was moved, written and told, none of it really done."""
    moved: list[Any] = []
    written: list[Any] = []
    told: list[Any] = []

    def moves(kind: str, *arguments: object) -> int:
        moved.append((kind, *arguments))
        return len(moved)

    monkeypatch.setattr(write, "performance", partial(moves, "performance"))
    monkeypatch.setattr(write, "streamed", partial(moves, "streamed"))
    monkeypatch.setattr(write, "write_clip", lambda *arguments: written.append(arguments))
    folders = write_set(out, wanted, SIZE, lambda *done: told.append(done))
    return folders, moved, written, told


def test_a_set_has_each_persons_takes_of_each_posture_all_of_one_seed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seed 2 of three people begins with person 6, in room 2 * 7919."""
    out = tmp_path / "new" / "set"
    wanted = ClipSet("postures", 3, 2, 2, ("squat", "kick_left_side"))
    folders, moved, written, told = made(monkeypatch, out, wanted)
    rig, jobs = default_rig(*SIZE), []
    for number in range(3):
        for take in (1, 2):
            jobs += [(number, take, posture) for posture in ("squat", "kick_left_side")]
    assert [folder.name for folder in folders] == [
        f"{person(6 + number).name}_t{take}_{POSTURES.index(posture) + 1:02d}_{posture}"
        for number, take, posture in jobs
    ]
    assert moved == [
        ("performance", person(6 + number), posture, take + 2000, 15.0)
        for number, take, posture in jobs
    ]
    assert written == [
        (folder, person(6 + number), n, Filming(rig, 2 * 7919 + number, take + 2000), take, None)
        for n, (folder, (number, take, _)) in enumerate(zip(folders, jobs, strict=True), 1)
    ]
    assert told == [(n, 12) for n in range(1, 13)]
    assert load_rig(out / "calibration.json") == rig


@pytest.mark.parametrize("cameras", [1, 3])
def test_every_camera_of_a_rig_has_its_video_and_its_truth(tmp_path: Path, cameras: int) -> None:
    """Joints, projected by the calibration that is written, lie in each camera's silhouette."""
    wanted = ClipSet("postures", seed=5, postures=("squat",), cameras=cameras)
    (clip,) = write_set(tmp_path, wanted, (80, 60))
    rig, names = load_rig(tmp_path / "calibration.json"), [f"cam{n + 1}" for n in range(cameras)]
    assert [camera.name for camera in rig.cameras] == names
    assert sorted(path.stem for path in clip.glob("*.avi")) == names
    truth = np.load(clip / "truth.npz")
    at = int(np.flatnonzero(truth["present"])[20])
    assert truth["gain"].shape == (cameras, len(truth["present"]))
    for prefix in ("joints2d", "frames", "mask"):
        assert sum(name.startswith(f"{prefix}_cam") for name in truth.files) == cameras
    for camera in rig.cameras:
        pixels = project(camera, truth["joints3d"][at].astype(np.float64))
        np.testing.assert_allclose(truth[f"joints2d_{camera.name}"][at], pixels, atol=1e-3)
        mask = np.unpackbits(truth[f"mask_{camera.name}"][at], axis=1, count=80)
        near = cv2.dilate(mask, np.ones((3, 3), np.uint8))
        columns, rows = np.floor(pixels).astype(int).T
        assert near[rows, columns].mean() > 0.9
        assert near.mean() < 0.2


@pytest.mark.parametrize("motion", ["free", "fall", "stream"])
def test_what_is_one_take_each_is_no_take_of_each_posture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, motion: Any
) -> None:
    someone = person(1)
    folders, moved, _, _ = made(monkeypatch, tmp_path, ClipSet(motion, 1, 1, 1, ("squat",)))
    assert [folder.name for folder in folders] == [f"{someone.name}_t1_00_{motion}"]
    if motion == "stream":
        assert moved == [("streamed", someone, 1001, 15.0, ("squat",))]
    else:
        assert moved == [("performance", someone, motion, 1001, 15.0)]
    assert clip_name(someone, POSTURES[-1], 4).endswith(f"_t4_{len(POSTURES):02d}_{POSTURES[-1]}")


def test_a_calibration_of_other_cameras_is_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made(monkeypatch, tmp_path, ClipSet("free"))
    made(monkeypatch, tmp_path, ClipSet("free"))
    write_rig(tmp_path / "calibration.json", RIG)
    before = (tmp_path / "calibration.json").read_bytes()
    with pytest.raises(
        SynthError, match=r"calibration\.json is of other cameras, whose clips it s"
    ):
        write_set(tmp_path, ClipSet("free"), SIZE)
    assert (tmp_path / "calibration.json").read_bytes() == before


@pytest.mark.parametrize(
    ("wanted", "size", "said"),
    [
        (
            ClipSet("dance"),  # type: ignore[arg-type]
            SIZE,
            "motion must be postures, free, fall, stream, spot, cross, got 'dance'",
        ),
        (ClipSet("free", performers=0), SIZE, "performers must be at least 1, got 0"),
        (ClipSet("free", takes=0), SIZE, "takes must be at least 1, got 0"),
        (ClipSet("free", cameras=0), SIZE, "cameras must be 1 to 8, got 0"),
        (ClipSet("free", cameras=9), SIZE, "cameras must be 1 to 8, got 9"),
        (ClipSet("free", seed=-1), SIZE, "seed must not be negative, got -1"),
        (ClipSet("free"), (31, 48), "a picture has 32 to 4096 pixels each way, got 31x48"),
        (ClipSet("free"), (48, 4097), "a picture has 32 to 4096 pixels each way, got 48x4097"),
        (ClipSet("postures", postures=("squat", "hop")), SIZE, r"unknown posture \['hop'\]; known"),
        (ClipSet("postures", postures=()), SIZE, r"unknown posture \(\); known are "),
    ],
)
def test_a_set_that_cannot_be_is_refused_before_anything_is_written(
    tmp_path: Path, wanted: ClipSet, size: tuple[int, int], said: str
) -> None:
    with pytest.raises(SynthError, match=said):
        write_set(tmp_path / "out", wanted, size)
    assert not (tmp_path / "out").exists()


def test_the_smallest_and_the_largest_picture_are_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(write, "write_clip", lambda *_: None)
    assert len(write_set(tmp_path / "a", ClipSet("free"), (32, 4096))) == 1
