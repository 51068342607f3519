"""The cameras that Linux lists, those that are tried elsewhere, and files that play as cameras."""

from pathlib import Path

from tritrack.machine_cameras.camera_list import TRIED, cameras_of, devices_to_try, linux_cameras


def device(listed: Path, number: int, name: str, index: int, bus: str) -> None:
    """As the kernel lays it out: a link to the device on its bus."""
    folder = listed / f"video{number}"
    folder.mkdir(parents=True)
    (folder / "name").write_text(f"{name}\n")
    (folder / "index").write_text(f"{index}\n")
    place = listed.parent / "devices" / bus
    place.mkdir(parents=True, exist_ok=True)
    (folder / "device").symlink_to(place)


def test_identical_cameras_are_told_apart_by_their_bus_path(tmp_path: Path) -> None:
    """Each has a second device, of metadata, that gives no pictures."""
    listed = tmp_path / "video4linux"
    device(listed, 0, "HD Webcam", 0, "1-1:1.0")
    device(listed, 1, "HD Webcam", 1, "1-1:1.0")
    device(listed, 2, "HD Webcam", 0, "1-4:1.0")
    device(listed, 10, "Other", 0, "2-1:1.0")
    (listed / "v4l-touch0").mkdir()
    found = linux_cameras(listed)
    assert [(each.name, each.where, each.source) for each in found] == [
        ("HD Webcam", "1-1:1.0 (/dev/video0)", 0),
        ("HD Webcam", "1-4:1.0 (/dev/video2)", 2),
        ("Other", "2-1:1.0 (/dev/video10)", 10),
    ]


def test_files_play_as_cameras_after_the_real_ones(tmp_path: Path) -> None:
    listed = tmp_path / "video4linux"
    device(listed, 0, "HD Webcam", 0, "1-1:1.0")
    found = cameras_of([Path("a/cam1.avi"), Path("b/cam1.avi")], listed)
    assert [each.camera for each in found] == ["video0", "file0", "file1"]
    assert [each.source for each in found] == [0, "a/cam1.avi", "b/cam1.avi"]
    assert len({each.where for each in found}) == 3


def test_linux_without_a_list_has_no_camera_and_elsewhere_some_are_tried(tmp_path: Path) -> None:
    (tmp_path / "class").mkdir()
    assert cameras_of([], tmp_path / "class/video4linux") == []
    assert cameras_of([], tmp_path / "none/video4linux") == devices_to_try()
    assert [each.source for each in devices_to_try()] == [*range(TRIED)]
