"""The report of a run: what stands on it, that nothing is loaded, and what is made anew."""

import io
import os
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import pytest
from rich.console import Console
from written_runs import body, written

from common.body.body import POSE_INDEX, rest_pose
from common.bus.messages import Body
from runtime.store.past_run import open_run
from tritrack.reporting.reporting import report_run


def walking() -> list[Body]:
    """Nobody, then a knee that bends, then a body that is lost."""
    bodies = [body(0, None, "empty")]
    for n in range(1, 7):
        pose = rest_pose()
        pose[POSE_INDEX["r_knee_x"]] = -10.0 * n
        bodies.append(body(n, pose, sure=0.9 if n != 4 else 0.6))
    return [*bodies, *(body(n, None, "lost", 0.0) for n in (7, 8, 9))]


def reported(folder: Path) -> tuple[str, str]:
    """The page, and what the terminal shows."""
    said = io.StringIO()
    report_run(folder, Console(file=said, width=300), lambda _: None)
    return (folder / "report.html").read_text(), said.getvalue()


class Loaded(HTMLParser):
    """Every address from which a page would load something by itself."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: list[str] = []
        self.opened: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "br", "img", "path"):
            self.opened.append(tag)
        for name, value in attrs:
            if name in ("src", "data", "poster", "srcset") or (name == "href" and tag != "a"):
                self.asked.append(value or "")

    def handle_endtag(self, tag: str) -> None:
        if tag != "path":
            assert self.opened.pop() == tag


class Report(NamedTuple):
    """A run's folder, its page, and what the terminal shows."""

    folder: Path
    html: str
    said: str


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """Who changes its folder copies it before."""
    warned = ["<img src=x> & more"]
    out = tmp_path_factory.mktemp("walk")
    folder = written(out, walking(), followed=0.667, believed=0.64, warnings=warned)
    return Report(folder, *reported(folder))


def test_the_page_says_what_was_followed_when_it_was_believed_and_why_not(walk: Report) -> None:
    html = walk.html
    text = " ".join(re.sub(r"<[^>]+>", " ", re.sub(r"(?s)<style>.*?</style>", "", html)).split())
    assert "cameras that saw a person cam1, cam2" in text
    assert "followed, of frames with a person 67%" in text
    assert (
        "Believed, by both views of the person in 40 moments: joints 21 mm (2.1 px) apart" in text
    )
    assert "0.70 to 1.00 s: not believed: a person is seen, and no pose fits" in text
    assert "frame 7, 0.70 s, lost" in text
    assert walk.said == ""


def test_the_page_loads_nothing_and_its_pictures_are_in_it(walk: Report) -> None:
    html, page = walk.html, Loaded()
    page.feed(html)
    assert page.opened == []
    assert page.asked, "the worst frames"
    beside = {
        address for address in page.asked if not address.startswith("data:image/jpeg;base64,")
    }
    assert beside == {"overlay.mp4"}, "the video, and nothing else"
    assert "url(" not in html
    assert "&lt;img src=x&gt; &amp; more" in html


def test_the_video_has_a_picture_for_each_row(walk: Report) -> None:
    name = re.search(r'<a href="(overlay\.\w+)"', walk.html)
    assert name is not None
    video = cv2.VideoCapture(str(walk.folder / name[1]))
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == 10
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(10.0)
    assert video.get(cv2.CAP_PROP_FRAME_WIDTH) == 320


def test_the_video_of_single_is_kept_for_it_shows_more(tmp_path: Path) -> None:
    folder = written(tmp_path, walking(), run_of={"command": "single", "footage": []})
    (folder / "overlay.mp4").write_bytes(b"single's")
    html, _ = reported(folder)
    assert (folder / "overlay.mp4").read_bytes() == b"single's"
    assert '<a href="overlay.mp4"' in html
    assert "<video" not in html, "no browser plays that"
    assert "<img" in html


def test_without_its_videos_a_run_is_reported_without_pictures(tmp_path: Path) -> None:
    folder = written(tmp_path, walking())
    (tmp_path / "clip" / "cam1.avi").unlink()
    html, said = reported(folder)
    assert "<img" not in html
    assert "overlay" not in html
    assert "cam1.avi" in said


def test_each_of_several_people_has_a_part(tmp_path: Path) -> None:
    bodies = [body(n, rest_pose(), person=person) for n in range(4) for person in (1, 2)]
    html, _ = reported(written(tmp_path, bodies))
    assert re.findall(r"<h2[^>]*>(Person \d)</h2>", html) == ["Person 1", "Person 2"]
    assert len(re.findall("<img", html)) == 2


def test_a_run_that_is_written_anew_loses_its_report(walk: Report, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(walk.folder, tmp_path / walk.folder.name))
    assert (folder / "report.html").exists()
    assert written(tmp_path, walking()) == folder
    assert sorted(path.name for path in folder.iterdir() if path.name != "angles.png") == [
        *("poses.npz", "summary.json")
    ]


def test_a_run_without_a_person_or_a_pose_is_reported_too(tmp_path: Path) -> None:
    folder = written(tmp_path, [body(n, None, "empty") for n in range(3)])
    assert np.isnan(open_run(folder).poses["joints_m"]).all()
    html, _ = reported(folder)
    assert "does not repeat itself" in html
    html, said = reported(written(tmp_path / "none", []))
    assert "does not repeat itself" in html
    assert "the run has no frame" in said


def test_a_run_whose_clip_has_a_name_that_is_no_unicode_is_reported(tmp_path: Path) -> None:
    html, _ = reported(written(tmp_path, walking(), clip=os.fsdecode(b"caf\xe9")))
    assert "<h1>caf?</h1>" in html
