"""Scenes on disk: depth order, a truth of each person, and the same bytes from a seed."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from common.rig.camera import centre, project
from common.rig.rig_file import load_rig
from synth.motion.motions import Motion, performance
from synth.person.people import person
from synth.person.skeleton import JOINTS
from synth.picture.actors import Part, Thing
from synth.picture.exposure import default_rig
from synth.picture.render import render, render_scene
from synth.scene.scene_clips import SceneSet, in_pictures, rig_of, together, write_scenes
from synth.write import Filming, SynthError, truth_of, write_clip

SIZE = (96, 72)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two people, three cameras, three seconds."""
    told: list[tuple[int, int]] = []
    out = tmp_path_factory.mktemp("scenes")
    wanted = SceneSet(2, 3.0, 1, 5, 3)
    (made,) = write_scenes(out, wanted, SIZE, lambda *done: told.append(done))
    assert (made.name, told) == ("people2_s05_t1", [(1, 1)])
    return made


def placed(number: int, at_m: tuple[float, float]) -> Part:
    """A person in two frames of a walk in place, at x and z."""
    motion = performance(person(number), "walk_in_place", 1)
    names = ("joints_m", "bones", "angles_deg", "root_m", "phase")
    motion = motion._replace(**{name: getattr(motion, name)[40:42] for name in names})
    by = np.array([at_m[0] - motion.root_m[0, 0], 0.0, at_m[1] - motion.root_m[0, 2]])
    bones = motion.bones.copy()
    bones[..., 3] += by
    moved = motion._replace(joints_m=motion.joints_m + by, bones=bones, root_m=motion.root_m + by)
    return Part(person(number), moved)


def alone(part: Part, rig: Any) -> tuple[np.ndarray, ...]:
    return next(render(part.someone, part.motion, rig, 4, 9)).masks


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize(
    ("camera", "near_m", "far_m"), [(0, (0.1, 0.5), (0.0, -0.3)), (1, (-0.5, 0.1), (0.3, 0.0))]
)
def test_who_is_nearer_hides_who_is_farther_in_each_camera(
    order: tuple[int, int], camera: int, near_m: tuple[float, float], far_m: tuple[float, float]
) -> None:
    """Camera 1 looks along -z from +z, camera 2 along +x from -x. Whoever is named first."""
    rig = default_rig(160, 120)
    parts = [placed(1, near_m), placed(2, far_m)]
    shot = next(render_scene([parts[n] for n in order], rig, 4, 9))
    near, far = (alone(part, rig)[camera] for part in parts)
    both = near & far
    assert both.sum() > 100
    seen_near, seen_far = (shot.masks[camera][order.index(n)] for n in (0, 1))
    np.testing.assert_array_equal(seen_near, near)
    assert (seen_far != far & ~both).sum() <= 3, "but for pixels that they share"
    own = next(render(*parts[0], rig, 4, 9)).frames[camera].astype(int)
    there = np.abs(shot.frames[camera].astype(int) - own).max(axis=2)[both]
    assert np.median(there) <= 3


def test_a_wall_hides_who_is_behind_it_and_shadows_add_up() -> None:
    rig = default_rig(160, 120)
    gone = next(render_scene([placed(1, (0.0, -4.0)), placed(2, (0.5, 0.0))], rig, 4, 9))
    assert not gone.masks[0][0].any()
    assert gone.masks[0][1].any()
    own = next(render_scene([placed(2, (0.5, 0.0))], rig, 4, 9)).frames[0]
    np.testing.assert_array_equal(gone.frames[0], own, "nor does he cast a shadow on its front")
    one, two = placed(1, (-0.8, 0.0)), placed(2, (0.6, 0.0))
    both = next(render_scene([one, two], rig, 4, 9)).frames[0].astype(int)
    for part, other in ((one, two), (two, one)):
        own = next(render_scene([part], rig, 4, 9)).frames[0].astype(int)
        bare = ~cv2.dilate(alone(other, rig)[0].astype(np.uint8), np.ones((5, 5))).astype(bool)
        darker = (own - both).max(axis=2) > 6
        assert darker[bare].sum() > 20, "the other's shadow is there"
        assert ((both - own).max(axis=2)[bare] <= 3).all(), "and nothing is brighter"


def test_a_thing_hides_what_is_behind_it_and_is_no_part_of_a_person() -> None:
    """A box of 0.4 m before a trunk, by hand: 401 px / 320 * 160 at 4 m make 20 px a side."""
    rig, part = default_rig(160, 120), placed(1, (0.0, 0.0))
    places = np.tile([0.0, 1.1, 0.6], (2, 1))
    red = Thing((0.4, 0.4, 0.4), (0, 0, 255), places)
    shot, bare = next(render_scene([part], rig, 4, 9, [red])), next(render(*part, rig, 4, 9))
    blue, green, reds = (shot.frames[0][..., k].astype(int) for k in range(3))
    box = (reds > 60) & (reds > 3 * blue) & (reds > 3 * green)
    rows, columns = np.nonzero(box)
    side = 401.14 / 2 * 0.4 / (4.5 - 0.8)
    assert np.ptp(rows) + 1 == pytest.approx(side, abs=1.5)
    assert np.ptp(columns) + 1 == pytest.approx(side, abs=1.5)
    inside = cv2.erode(box.astype(np.uint8), np.ones((3, 3))).astype(bool)
    assert bare.masks[0][inside].any()
    assert not shot.masks[0][0][inside].any()
    about = ~cv2.dilate(box.astype(np.uint8), np.ones((3, 3))).astype(bool)
    np.testing.assert_array_equal(shot.masks[0][0][about], bare.masks[0][about])
    behind = next(render_scene([part], rig, 4, 9, [red._replace(places_m=places - [0, 0, 1.5])]))
    np.testing.assert_array_equal(behind.masks[0][0], bare.masks[0])
    gone = next(render_scene([part], rig, 4, 9, [red._replace(places_m=places * np.nan)]))
    np.testing.assert_array_equal(gone.frames[0], bare.frames[0])


def test_who_is_behind_a_camera_is_not_in_its_picture() -> None:
    """Alone, or beside somebody who is before it."""
    rig, behind = default_rig(96, 72), placed(1, (0.0, 5.5))
    assert not any(mask.any() for mask in next(render_scene([behind], rig, 4, 9)).masks)
    both = next(render_scene([behind, placed(2, (0.0, 0.0))], rig, 4, 9)).masks[0]
    assert both[1].any()
    assert not both[0].any()


def test_one_person_in_a_scene_is_drawn_as_alone() -> None:
    rig, part = default_rig(96, 72), placed(3, (0.1, 0.2))
    scene, one = next(render_scene([part], rig, 4, 9)), next(render(*part, rig, 4, 9))
    for n in (0, 1):
        np.testing.assert_array_equal(scene.frames[n], one.frames[n])
        np.testing.assert_array_equal(scene.masks[n][0], one.masks[n])


def test_rows_are_by_frame_then_person_and_each_persons_are_their_own_truth() -> None:
    rig, parts = default_rig(*SIZE), [placed(1, (0.0, 0.0)), placed(2, (0.5, 0.0))]
    each = [truth_of(*part, rig, 1) for part in parts]
    truth = together(each)
    assert truth["frame"].tolist() == [0, 0, 1, 1]
    assert truth["person"].tolist() == [0, 1, 0, 1]
    for who, own in enumerate(each):
        for name in ("joints3d", "joints2d_cam1", "joints2d_cam2", "root", "present", "angles"):
            np.testing.assert_array_equal(truth[name][truth["person"] == who], own[name])
        for name in ("measures", "performer"):
            np.testing.assert_array_equal(truth[name][who], own[name])
    assert truth["frames_cam2"].tolist() == [0, 1]
    assert truth["joint_names"].tolist() == [*JOINTS]
    assert together(each[:1]) is each[0]


@pytest.mark.slow
def test_a_scene_is_a_clip_with_a_truth_of_each(folder: Path) -> None:
    rig, truth = load_rig(folder.parent / "calibration.json"), np.load(folder / "truth.npz")
    assert [camera.name for camera in rig.cameras] == ["cam1", "cam2", "cam3"]
    assert len(truth["person"]) == len(truth["joints3d"]) == 2 * 45
    names = dict.fromkeys(range(2), "")
    for who in names:
        own = {name: truth[name][truth["person"] == who] for name in ("joints3d", "present")}
        assert not own["present"][:9].any()
        for camera in rig.cameras:
            masks = np.unpackbits(truth[f"mask_{camera.name}"], axis=-1, count=96).astype(bool)
            masks = masks[truth["person"] == who]
            np.testing.assert_allclose(
                truth[f"joints2d_{camera.name}"][truth["person"] == who][20],
                project(camera, own["joints3d"][20].astype(float)),
                atol=0.01,
            )
            hits = total = 0
            for i in np.flatnonzero(own["present"])[::5]:
                near = cv2.dilate(masks[i].astype(np.uint8), np.ones((3, 3)))
                pixels = np.floor(project(camera, own["joints3d"][i].astype(float))).astype(int)
                within = ((pixels >= 0) & (pixels < SIZE)).all(axis=1)
                hits += int(near[pixels[within, 1], pixels[within, 0]].sum())
                total += int(within.sum())
            assert hits > 0.6 * total > 0, "what others hide is not in the mask"
        names[who] = str(truth["performer"][who])
    notes = json.loads((folder / "meta.json").read_text())
    assert [one["performer"] for one in notes["people"]] == [*names.values()]
    assert (notes["n_frames"], notes["fps"], notes["posture"]) == (45, 15.0, "scene")
    film = cv2.VideoCapture(str(folder / "cam3.avi"))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == 45


def test_a_seed_is_the_same_bytes_twice(folder: Path, tmp_path: Path) -> None:
    (again,) = write_scenes(tmp_path, SceneSet(2, 3.0, 1, 5, 3), SIZE)
    for name in ("cam1.avi", "cam3.avi", "meta.json", "truth.npz"):
        assert (again / name).read_bytes() == (folder / name).read_bytes()


@pytest.mark.slow
def test_each_may_be_shown_alone_too_with_the_same_motion_room_and_noise(tmp_path: Path) -> None:
    scene, *each = write_scenes(tmp_path, SceneSet(2, 3.0, 1, 5, 3, alone=True), SIZE)
    assert [one.name for one in each] == [f"{scene.name}_alone{who}" for who in (0, 1)]
    with np.load(scene / "truth.npz") as truth:
        for who, one in enumerate(each):
            with np.load(one / "truth.npz") as own:
                assert "person" not in own
                rows = truth["person"] == who
                for name in ("joints3d", "joints2d_cam2", "present", "phase"):
                    np.testing.assert_array_equal(truth[name][rows], own[name])
                both, whole = truth["mask_cam1"][rows], own["mask_cam1"]
                assert (np.bitwise_and(both, ~whole) == 0).all(), "nobody hides more than nothing"
                np.testing.assert_array_equal(truth["gain"], own["gain"])
    films = [cv2.VideoCapture(str(at / "cam1.avi")).read()[1] for at in (scene, *each)]
    np.testing.assert_array_equal(films[0], films[1])


@pytest.mark.parametrize(("people", "far_m"), [(1, 4.5), (3, 4.5), (4, 5.04), (5, 5.58)])
def test_cameras_stand_back_from_a_crowd_at_their_height(people: int, far_m: float) -> None:
    for camera, place in zip(
        rig_of(SceneSet(people), SIZE).cameras, ([0, 1, far_m], [-far_m, 1, 0]), strict=True
    ):
        np.testing.assert_allclose(centre(camera), place, atol=1e-9)


def test_one_person_alone_has_the_format_of_any_clip(tmp_path: Path) -> None:
    (scene,) = write_scenes(tmp_path / "s", SceneSet(1, 3.0), SIZE)
    part, rig = placed(1, (0.0, 0.0)), default_rig(*SIZE)
    write_clip(tmp_path / "c", *part, Filming(rig, 1, 1), 1)
    with np.load(scene / "truth.npz") as ours, np.load(tmp_path / "c" / "truth.npz") as usual:
        assert set(ours.files) == set(usual.files)
        for name in ours.files:
            assert ours[name].ndim == usual[name].ndim
            assert ours[name].dtype.kind == usual[name].dtype.kind
    ours, usual = (json.loads((at / "meta.json").read_text()) for at in (scene, tmp_path / "c"))
    assert ours.keys() == usual.keys()


def test_who_is_out_of_the_room_or_of_all_pictures_is_not_present() -> None:
    rig = default_rig(*SIZE)

    def present(at_m: tuple[float, float]) -> list[bool]:
        motion: Motion = placed(1, at_m).motion
        return [bool(there) for there in in_pictures(motion, rig, 4)]

    assert present((0.0, 0.0)) == [True, True]
    assert present((0.0, -4.0)) == [False, False]
    assert present((-3.5, 3.5)) == [False, False], "between the cameras, beside both pictures"
    assert present((0.0, 2.9)) == [True, True], "in camera 2's picture alone"


@pytest.mark.parametrize(
    ("wanted", "size", "reason"),
    [
        (SceneSet(0), SIZE, "people must be 1 to 5, got 0"),
        (SceneSet(6), SIZE, "people must be 1 to 5, got 6"),
        (SceneSet(2, cameras=9), SIZE, "cameras must be 1 to 8, got 9"),
        (SceneSet(2, 2.5), SIZE, "seconds must be 3 to 600, got 2.5"),
        (SceneSet(2, takes=0), SIZE, "takes must be at least 1, got 0"),
        (SceneSet(2, seed=-1), SIZE, "seed must be at least 0, got -1"),
        (SceneSet(2), (16, 48), "32 to 4096 pixels each way, got 16x48"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_written(
    tmp_path: Path, wanted: SceneSet, size: tuple[int, int], reason: str
) -> None:
    with pytest.raises(SynthError, match=reason):
        write_scenes(tmp_path / "out", wanted, size)
    assert not (tmp_path / "out").exists()
