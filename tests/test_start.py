"""The start page in a real browser: dropped videos, runs, cameras, calibrations."""

import json
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.request import urlopen

import cv2
import numpy as np
import pytest

from runtime.live.free_ports import free_port

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import open_tab
from filmed_board import board_picture
from spoiling import film_of, write_video
from test_live import CHROMIUM, SIZES, SOFT, Looking

from animator.page.door import Entrance, invitation_of
from animator.start.start_page import StartPage
from animator.start.wishes import CHUNK_BYTES
from calibration.board.board import BOARDS
from calibration.foreign.toml_rig import toml_text
from common.config import config_file
from common.rig.rig_file import load_rig
from common.video.camera_file import write_times
from tritrack.starting.start import LOOK_S
from tritrack.starting.start_desk import Given, StartDesk

TOKEN = "a-long-word"
AXE = Path(os.environ.get("AXE", "node_modules/axe-core/axe.min.js"))
"""axe-core of npm, which is no part of this project."""
FRAMES = 36
"""Of a video that a job works on."""
BEYOND = (
    "[...document.querySelectorAll('main *')].filter("
    "e => e.getBoundingClientRect().right > {width} && !e.closest('pre, #drop label')).length"
)
"""How many elements are cut by the window's edge."""
WORK_S = 280.0
"""For one job: a busy machine compiles nothing, but tracks slowly."""


class Started(NamedTuple):
    """A start page at work in this process."""

    runs: Path
    address: str


@contextmanager
def served(runs: Path, cameras: tuple[Path, ...]) -> Iterator[Started]:
    """The page in this process, with videos that play as cameras."""
    port, entrance = free_port(), Entrance(token=TOKEN)
    desk = StartDesk(Given(runs, cameras))
    page = StartPage(desk.hello, desk.file, port, entrance)
    over = threading.Event()

    def serve() -> None:
        while not over.wait(LOOK_S):
            desk.turn(page)

    thread = threading.Thread(target=serve)
    thread.start()
    yield Started(runs, invitation_of(entrance, port))
    over.set()
    thread.join()
    page.close()
    desk.close()


@pytest.fixture
def started(tmp_path: Path, clip: Path) -> Iterator[Started]:
    """With an empty folder of runs, and a clip's videos as cameras."""
    with served(tmp_path / "runs", tuple(sorted(clip.glob("cam*.avi")))) as one:
        yield one


@pytest.fixture(scope="session")
def short(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The clip's first two seconds, in which its person appears."""
    folder = tmp_path_factory.mktemp("short")
    for name in ("cam1.avi", "cam2.avi"):
        write_video(folder / name, film_of(clip / name)[:FRAMES])
    return folder


@pytest.fixture
def looking(started: Started) -> Iterator[Looking]:
    if CHROMIUM is None:
        pytest.skip("no Chromium here: the page is not looked at")
    with open_tab(CHROMIUM, SOFT) as tab:
        found = Looking(tab, started.address, SIZES["desk"])
        assert found.until("document.body?.dataset.heard")
        yield found


def choose(looking: Looking, *files: Path) -> None:
    """As a person does in the browser's own dialog."""
    made = looking.tab.call(
        "Runtime.evaluate", expression="document.getElementById('choose-files')"
    )
    looking.tab.call(
        "DOM.setFileInputFiles",
        files=[str(path) for path in files],
        objectId=made["result"]["objectId"],
    )


def click(looking: Looking, what: str) -> None:
    assert looking.until(f"(e => !!e && !e.disabled)(document.querySelector({what!r}))"), what
    looking.ask(f"document.querySelector({what!r}).click()")


def words(looking: Looking, where: str) -> str:
    return str(looking.ask(f"document.querySelector({where!r})?.innerText ?? ''"))


def job_ended(looking: Looking, number: int = 1) -> str:
    """The state of the newest job, of so many, once it is over."""
    assert looking.until(f"document.querySelectorAll('#jobs li').length == {number}")
    state = "document.querySelector('#jobs li')?.dataset.state"
    over = f"['done', 'failed', 'cancelled'].includes({state})"
    assert looking.until(over, WORK_S), words(looking, "#jobs")
    return str(looking.ask(state))


@pytest.mark.slow
def test_a_dropped_video_becomes_a_run_that_is_exported_and_deleted(
    looking: Looking, started: Started, short: Path
) -> None:
    pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")
    choose(looking, short / "cam1.avi")
    assert looking.until("!!document.querySelector('#do-single')")
    told = words(looking, "#files")
    assert "cam1.avi" in told
    assert "160x120" in told
    assert "at 15 a second" in told
    looking.ask("document.querySelector('#name').select()")
    looking.tab.call("Input.insertText", text="walk")
    click(looking, "#do-single")
    assert looking.until("document.querySelector('#jobs progress')?.value > 0.05", WORK_S)
    assert f"tritrack single {started.runs}/.clips/walk/walk.avi" in words(looking, "#jobs")
    assert looking.until("/cutting out|posing/.test(document.querySelector('#jobs').innerText)")
    assert job_ended(looking) == "done", words(looking, "#jobs")
    assert (started.runs / "walk/poses.npz").is_file()
    assert looking.until("document.querySelector('#runs img')?.naturalWidth > 100")
    assert "believed in" in words(looking, "#runs")

    looking.ask("document.querySelector('#format-walk').value = 'csv'")
    click(looking, "#export-walk")
    assert job_ended(looking, 2) == "done", words(looking, "#jobs")
    link = "document.querySelector('#runs a[download=\"walk_poses.csv\"]')"
    assert looking.until(f"!!{link}")
    rows = looking.tab.call(
        "Runtime.evaluate",
        expression=f"fetch({link}.href).then(got => got.text())",
        awaitPromise=True,
    )["result"]["value"].splitlines()
    with np.load(started.runs / "walk/poses.npz") as poses:
        assert len(rows) == len(poses["frame"]) + 1

    click(looking, "#retouch-walk")
    assert looking.until("!!document.querySelector('#jobs a[id^=page]')", WORK_S)
    with urlopen(looking.ask("document.querySelector('#jobs a[id^=page]').href")) as page:
        assert page.status == 200
    click(looking, "#jobs button")
    assert job_ended(looking, 3) == "done", words(looking, "#jobs")

    click(looking, "#delete-walk")
    assert looking.until("document.querySelector('#asking').open")
    looking.ask("document.querySelector('#asking button[value=no]').click()")
    looking.drawn()
    assert (started.runs / "walk").is_dir(), "keeping it keeps it"
    click(looking, "#delete-walk")
    looking.ask("document.querySelector('#asking button[value=yes]').click()")
    assert looking.until("!document.querySelector('#runs li')")
    assert not (started.runs / "walk").exists()
    assert not (started.runs / ".clips/walk").exists()
    assert all(
        address.startswith(("http://127.0.0.1", "ws://127.0.0.1", "data:"))
        for address in looking.tab.asked
        if address != "about:blank"
    )


def test_no_serious_fault_of_access_and_nothing_beyond_the_window(
    started: Started, clip: Path
) -> None:
    """By axe-core, with the files in the tray, cameras open, recordings, a failed job and runs."""
    if CHROMIUM is None:
        pytest.skip("no Chromium here: the page is not looked at")
    if not AXE.is_file():
        pytest.skip("no axe-core here: npm install axe-core, or name its axe.min.js by AXE")
    for name in ("walk", "a_run_of_a_long_name_that_has_no_space_to_be_broken_at_2026"):
        written_run(started.runs / name)
        written_recording(started.runs / ".recorded" / name)
    with open_tab(CHROMIUM, SOFT) as tab:
        for size in SIZES.values():
            looking = Looking(tab, started.address, size)
            assert looking.until("document.body?.dataset.heard")
            fill_page(looking, clip, is_first=size == SIZES["desk"])
            wide = looking.ask("document.documentElement.scrollWidth")
            beyond = looking.ask(BEYOND.format(width=size[0]))
            assert (wide <= size[0], beyond) == (True, 0), size
            alone = "e => e.offsetWidth && !e.control.offsetWidth"
            unseen = f"[...document.querySelectorAll('label')].filter({alone})"
            assert looking.ask(f"{unseen}.map(e => e.innerText).join()") == "", "a label alone"
            tab.call("Runtime.evaluate", expression=AXE.read_text())
            found = tab.call(
                "Runtime.evaluate",
                expression="axe.run().then(found => JSON.stringify(found.violations))",
                awaitPromise=True,
            )["result"]["value"]
            faults = [(each["id"], each["nodes"][0]["html"]) for each in json.loads(found)]
            assert faults == []


def written_run(folder: Path) -> None:
    """A run without poses: enough to be listed."""
    folder.mkdir(parents=True)
    (folder / "poses.npz").write_bytes(b"")
    told = {"frames": 9, "believed": 0.97, "warnings": ["it is dark"]}
    (folder / "summary.json").write_text(json.dumps(told))


def written_recording(folder: Path) -> None:
    """One without pictures: enough to be listed."""
    folder.mkdir(parents=True)
    for camera in ("cam1", "cam2"):
        (folder / f"{camera}.avi").write_bytes(b"RIFF")
    write_times(folder, {"cam1": [0.0, 9.5], "cam2": [0.1, 9.4]})


def fill_page(looking: Looking, clip: Path, is_first: bool) -> None:
    """Something in every list; files and open cameras stay for the second look."""
    click(looking, "#export-walk")
    if is_first:
        choose(looking, clip / "cam1.avi", clip / "cam2.avi")
        click(looking, "#look")
    assert looking.until("!!document.querySelector('#do-track')")
    shown = "[...document.querySelectorAll('#cameras img')].filter(e => e.naturalWidth).length == 2"
    assert looking.until(shown)
    click(looking, "#use-file0")
    assert looking.until("document.querySelector('#jobs li')?.dataset.state == 'failed'")


def test_everything_is_reached_by_the_keyboard(looking: Looking, started: Started) -> None:
    written_run(started.runs / "walk")
    assert looking.until("!!document.querySelector('#delete-walk')")
    reached = set()
    for _ in range(40):
        looking.key("Tab", 9)
        reached.add(looking.ask("document.activeElement.id"))
    due = {"choose-files", "look", "live-calibration", "paper", "board", "export-walk"}
    assert due | {"format-walk", "delete-walk"} <= reached
    looking.ask("document.querySelector('#delete-walk').focus()")
    looking.tab.call(
        "Input.dispatchKeyEvent", type="keyDown", key="Enter", windowsVirtualKeyCode=13, text="\r"
    )
    assert looking.until("document.querySelector('#asking').open")
    assert looking.ask("document.activeElement.value") == "no", "Enter twice deletes nothing"
    looking.key("Escape", 27)
    assert looking.until("!document.querySelector('#asking').open")
    assert (started.runs / "walk").is_dir()


def test_what_is_dropped_is_seen_at_once_and_can_be_taken_away(
    looking: Looking, started: Started
) -> None:
    looking.ask(
        "{const data = new DataTransfer(); data.items.add(new File(['no video'], '../<b>.avi'));"
        "dispatchEvent(Object.assign(new Event('drop', {cancelable: true}), {dataTransfer: data}))}"
    )
    assert looking.until("!!document.querySelector('#files .bad')")
    assert "<b>.avi" in words(looking, "#files"), "as text"
    assert not looking.ask("!!document.querySelector('#do-single')")
    click(looking, "#files button[id^=away]")
    assert looking.until("!document.querySelector('#files li')")
    assert [path.name for path in (started.runs / ".uploads").iterdir()] == ["owner"]


def drop(looking: Looking, *paths: Path) -> None:
    """As a person drags them onto the page out of a window of files."""
    data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        looking.tab.call("Input.dispatchDragEvent", type=kind, x=200, y=200, data=data)


def test_of_a_folder_its_videos_are_taken_and_one_without_is_named(
    looking: Looking, clip: Path, tmp_path: Path
) -> None:
    (tmp_path / "my papers/more").mkdir(parents=True)
    (tmp_path / "my papers/notes.txt").write_text("no video")
    drop(looking, tmp_path / "my papers")
    assert looking.until("document.querySelector('#told').innerText.includes('my papers')")
    assert "no video" in words(looking, "#told")
    drop(looking, clip)
    assert looking.until("!!document.querySelector('#do-track')")
    names = "[...document.querySelectorAll('#files h3')].map(e => e.innerText).join()"
    assert looking.ask(names) == "camera 1: cam1.avi,camera 2: cam2.avi"


def test_large_files_come_whole_in_pieces_beside_each_other(
    looking: Looking, started: Started, tmp_path: Path
) -> None:
    contents = {f"cam{n}.avi": os.urandom(5 * CHUNK_BYTES // 2 + n) for n in (1, 2)}
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
    choose(looking, *(tmp_path / name for name in contents))
    assert looking.until("document.querySelectorAll('#files .bad').length == 2"), "no videos"
    found = {path.name: path.read_bytes() for path in started.runs.glob(".uploads/*/*")}
    assert found == contents


@pytest.mark.slow
def test_a_calibration_of_another_program_is_taken_over_or_refused_with_its_reason(
    looking: Looking, started: Started, clip: Path, tmp_path: Path
) -> None:
    theirs = tmp_path / "Calib.toml"
    theirs.write_text("not = a calibration")
    choose(looking, theirs)
    click(looking, "#do-import")
    assert job_ended(looking) == "failed"
    assert "Calib.toml" in words(looking, "#jobs [role=alert]")
    click(looking, "#files button[id^=away]")
    assert looking.until("!document.querySelector('#files li')")
    ours = load_rig(clip.parent / "calibration.json")
    theirs.write_text(toml_text(ours, "caliscope"))
    choose(looking, theirs)
    click(looking, "#do-import")
    assert job_ended(looking, 2) == "done", words(looking, "#jobs")
    assert looking.until("!!document.querySelector('#calibrations li')")
    assert "2 cameras" in words(looking, "#calibrations")
    taken = load_rig(started.runs / ".calibrations/Calib.json")
    for one, other in zip(taken.cameras, ours.cameras, strict=True):
        assert np.allclose(one.K, other.K)
    click(looking, "#delete-calibration-Calib")
    looking.ask("document.querySelector('#asking button[value=yes]').click()")
    assert looking.until("!document.querySelector('#calibrations li')")
    assert [*(started.runs / ".calibrations").iterdir()] == []


@pytest.mark.slow
def test_cameras_are_seen_chosen_and_tracked_live(looking: Looking, started: Started) -> None:
    """Two files play as cameras; the live page is the one that stands."""
    click(looking, "#look")
    shown = "[...document.querySelectorAll('#cameras img')].filter(e => e.naturalWidth).length == 2"
    assert looking.until(shown, WORK_S)
    assert words(looking, "#cameras").count("160x120, 15 frames a second") == 2
    before = looking.ask("document.querySelector('#cameras img').src")
    assert looking.until(f"document.querySelector('#cameras img').src != {before!r}")
    click(looking, "#use-file1")
    click(looking, "#use-file0")
    assert looking.until("document.querySelector('#live').innerText.includes('2 cameras')")
    click(looking, "#live")
    assert looking.until("!!document.querySelector('#jobs a[id^=page]')", WORK_S), words(
        looking, "#jobs"
    )
    assert looking.until("!document.querySelector('#cameras img')"), "no camera is held twice"
    (settings,) = (started.runs / ".settings").iterdir()
    first = config_file.load(settings).cameras["cam1"].source
    assert first.endswith("cam2.avi"), "the camera that was chosen first is camera 1"
    page = looking.ask("document.querySelector('#jobs a[id^=page]').href")
    looking.tab.call("Page.navigate", url=page)
    assert looking.until("document.body?.dataset.drawn", WORK_S)
    looking.tab.call("Page.navigate", url=started.address)
    click(looking, "#jobs button")
    assert job_ended(looking) == "done"
    assert looking.until("!!document.querySelector('#runs li')")
    assert looking.ask("document.querySelector('#runs h3').innerText").startswith("live_")


@pytest.mark.slow
def test_cameras_are_recorded_into_a_clip_that_is_tracked(
    looking: Looking, started: Started
) -> None:
    """The clip stands in the tray and in its list; the times of its frames go with it."""
    assert looking.until("document.querySelectorAll('#cameras li').length == 2")
    click(looking, "#use-file0")
    assert looking.ask("document.querySelector('#record').disabled"), "one camera is no clip"
    click(looking, "#use-file1")
    looking.ask("document.querySelector('#record-seconds').value = 3")
    looking.ask("document.querySelector('#record-name').value = 'walk'")
    assert looking.until("document.querySelector('#record').innerText == 'Record 2 cameras'")
    click(looking, "#record")
    assert looking.until("!!document.querySelector('#jobs progress')", WORK_S)
    assert job_ended(looking) == "done"
    assert looking.until("document.querySelectorAll('#files li').length == 2"), words(
        looking, "#tray-says"
    )
    assert looking.until("!!document.querySelector('#do-track')", WORK_S)
    assert "2 cameras" in words(looking, "#recordings")
    meta = json.loads((started.runs / ".recorded/walk/meta.json").read_text())
    click(looking, "#do-track")
    assert looking.until("document.querySelectorAll('#jobs li').length == 2")
    assert looking.until("!!document.querySelector('#runs h3')", WORK_S), words(looking, "#jobs")
    assert looking.ask("document.querySelector('#runs h3').innerText") == "walk"
    times = json.loads((started.runs / ".clips/walk/meta.json").read_text())["capture_s"]
    assert times == meta["capture_s"]
    tracked = np.load(started.runs / "walk/poses.npz", allow_pickle=False)
    assert tracked["time_s"][:5] == pytest.approx(times["cam1"][:5], abs=0.05)
    click(looking, "#delete-recording-walk")
    looking.ask("document.querySelector('#asking button[value=yes]').click()")
    assert looking.until("document.querySelector('#recorded').hidden")
    assert [*(started.runs / ".recorded").iterdir()] == []


@pytest.mark.slow
def test_two_videos_calibrate_their_cameras_and_say_how_well(
    looking: Looking, started: Started, clip: Path
) -> None:
    choose(looking, clip / "cam1.avi", clip / "cam2.avi")
    click(looking, "#do-person")
    assert job_ended(looking) == "done", words(looking, "#jobs")
    assert looking.until("!!document.querySelector('#calibrations li')")
    said = words(looking, "#calibrations")
    assert "views agree to" in said
    assert "2 cameras" in said
    assert looking.ask("document.querySelector('#calibration').options.length") == 2
    assert load_rig(started.runs / ".calibrations/clip.json").cameras[1].name == "cam2"
    assert looking.until("!!document.querySelector('#do-track')"), "the tray keeps its files"
    assert not (started.runs / ".clips/clip").exists()


@pytest.fixture
def boards(tmp_path: Path) -> tuple[Path, Path]:
    """A board that rests before two cameras; the second one's picture is mirrored."""
    board = cv2.resize(board_picture(BOARDS["a3"]), (300, 240), interpolation=cv2.INTER_AREA)
    picture = np.full((480, 640, 3), 120, np.uint8)
    picture[100:340, 150:450] = board[..., None]
    paths = tmp_path / "left.avi", tmp_path / "right.avi"
    write_video(paths[0], [picture] * 30)
    write_video(paths[1], [np.ascontiguousarray(picture[:, ::-1])] * 30)
    return paths


@pytest.mark.slow
def test_a_board_is_watched_and_the_cameras_are_calibrated_by_what_it_showed(
    tmp_path: Path, boards: tuple[Path, Path]
) -> None:
    if CHROMIUM is None:
        pytest.skip("no Chromium here: the page is not looked at")
    with served(tmp_path / "runs", boards) as started, open_tab(CHROMIUM, SOFT) as tab:
        looking = Looking(tab, started.address, SIZES["desk"])
        click(looking, "#use-file0")
        click(looking, "#use-file1")
        click(looking, "#watch")
        mirrored = "document.querySelector('#board-says').innerText.includes('mirrored')"
        assert looking.until(mirrored, WORK_S)
        assert looking.until(mirrored.replace("mirrored", "Camera 1: 1 pose, "), WORK_S)
        assert "upper left" in words(looking, "#board-says")
        assert looking.until("document.querySelector('#cameras img')?.naturalWidth == 480")
        click(looking, "#watched")
        assert job_ended(looking) == "failed"
        assert "cam2.avi: it is read in the mirror" in words(looking, "#jobs [role=alert]")
        assert "calibrate board" in words(looking, "#jobs code")
