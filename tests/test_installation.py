"""The installation, looked over."""

import importlib
import io
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fake_mediapipe import install_fake
from local_bus import LocalBus
from rich.console import Console
from spoiling import film_of

import tritrack.__main__ as door
from common.packages import PACKAGES, ROOT
from tritrack.doctor import installation as doctor
from tritrack.doctor.installation import Finding, examine, table_of


@pytest.fixture(scope="module")
def findings() -> dict[str, Finding]:
    return {finding.what: finding for finding in examine()}


def test_a_sound_installation_is_found_sound(findings: dict[str, Finding]) -> None:
    """The posture model may be absent from a checkout; all else that is needed is here."""
    needed = {name for name, one in findings.items() if one.needed and name != "posture model"}
    assert [findings[name] for name in needed if not findings[name].ok] == []
    assert {*doctor.REQUIRED, "python", "matching kernel", "video decoder"} <= needed
    assert {"bus on loopback", "own packages"} <= needed


def test_a_missing_package_is_named_with_its_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "REQUIRED", {"no-such-package": "no_such_package"})
    (missing,) = [one for one in examine() if one.what == "no-such-package"]
    assert (missing.ok, missing.cure) == (False, "pip install no-such-package")


def test_every_extra_that_a_command_needs_is_looked_at(findings: dict[str, Finding]) -> None:
    told = {name.rpartition("(")[2].rstrip(")") for name, one in findings.items() if not one.needed}
    assert {"viser", "tomlkit", "scikit-image", "matplotlib", "mediapipe"} <= told


def test_a_mediapipe_is_tried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that stands there may still not work: what it says is shown, and how it is installed."""
    install_fake(monkeypatch, tmp_path, born="raise OSError('no model here')")
    found = doctor._mediapipe()
    assert not found.ok
    assert not found.needed
    assert "no model here" in found.detail
    assert "pip install" not in found.detail
    assert found.cure.startswith("pip install --no-deps mediapipe==0.10.21 && pip install")


def test_a_look_that_fails_does_not_keep_the_others_from_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def breaks() -> Finding:
        raise OSError("no sockets here")

    monkeypatch.setattr(doctor, "_bus", breaks)
    found = examine()
    (bus,) = [one for one in found if "no sockets here" in one.detail]
    assert not bus.ok
    assert found[-1].what == "cores"


def test_the_cure_is_shown_only_where_something_is_wrong() -> None:
    paper = io.StringIO()
    rows = [
        Finding("good", True, "1.0", "not wanted"),
        Finding("bad", False, "gone", "install it"),
        Finding("nice to have", False, "none", "perhaps", needed=False),
    ]
    Console(file=paper, width=100).print(table_of(rows))
    said = paper.getvalue()
    assert "not wanted" not in said
    assert "install it" in said
    assert said.count("missing") == 1


def test_the_extra_that_a_cure_names_is_not_taken_for_markup() -> None:
    paper = io.StringIO()
    row = Finding("page", False, "not in [here]", "pip install 'tritrack[page]'", needed=False)
    Console(file=paper, width=100).print(table_of([row]))
    assert "pip install 'tritrack[page]'" in paper.getvalue()
    assert "not in [here]" in paper.getvalue()


@pytest.mark.parametrize(
    ("findings", "code"),
    [
        ([Finding("all", True, "")], None),
        ([Finding("page", False, "", needed=False)], None),
        ([Finding("numpy", False, "")], 2),
    ],
    ids=["sound", "less of it", "broken"],
)
def test_the_exit_code_says_whether_tritrack_works(
    findings: list[Finding],
    code: int | None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    stub: Callable[[], list[Finding]] = lambda: findings  # noqa: E731
    monkeypatch.setattr(importlib.import_module("tritrack.doctor.installation"), "examine", stub)
    assert door.app(["doctor", "--json"], standalone_mode=False) == code
    assert [one["what"] for one in json.loads(capsys.readouterr().out)] == [findings[0].what]


@pytest.mark.parametrize(
    ("cores", "sound"), [({0}, False), ({0, 5}, True), ({1, 2, 3}, True)], ids=["1", "2", "3"]
)
def test_two_cores_of_those_that_may_be_used_are_enough(
    monkeypatch: pytest.MonkeyPatch, cores: set[int], sound: bool
) -> None:
    monkeypatch.setattr("os.sched_getaffinity", lambda _: cores, raising=False)
    told = (str(len(cores)), "a live run wants two", False)
    assert doctor._cores() == Finding("cores", sound, *told)
    monkeypatch.delattr("os.sched_getaffinity")
    monkeypatch.setattr("os.cpu_count", lambda: None)
    assert (doctor._cores().detail, doctor._cores().ok) == ("1", False)


def test_any_chromium_is_a_browser(monkeypatch: pytest.MonkeyPatch) -> None:
    there: set[str] = set()
    monkeypatch.setattr("shutil.which", lambda name: f"/bin/{name}" if name in there else None)
    none = ("browser", False, "none: only the browser tests need one", "install chromium", False)
    assert doctor._browser() == none
    for name in ("google-chrome", "chromium-browser", "chromium"):
        there.add(name)
        assert doctor._browser()[1:3] == (True, f"/bin/{name}")


@pytest.mark.parametrize(("found", "sound"), [((3, 10, 9), False), ((3, 11, 0), True)])
def test_an_old_python_is_named(
    monkeypatch: pytest.MonkeyPatch, found: tuple[int, ...], sound: bool
) -> None:
    monkeypatch.setattr("sys.version_info", found)
    told = doctor._python()
    assert (told.ok, told.detail, told.cure) == (
        sound,
        ".".join(map(str, found)),
        "install Python 3.11 or newer",
    )


def test_a_film_of_which_frames_are_missing_is_no_sound_decoder(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Three black pictures of 64x48 are written, and two come."""
    asked: list[Any] = []

    class Short:
        def __enter__(self) -> "Short":
            return self

        def __exit__(self, *_: object) -> None:
            """Nothing to close."""

        def frames(self, path: str, size: tuple[int, int]) -> Iterator[int]:
            asked.append((size, len(film_of(Path(path))), film_of(Path(path))[0].shape))
            yield from (1, 2)

    assert doctor._decoder()[1:3] == (True, "3 of 3 frames")
    monkeypatch.setattr("common.video.decoding.Decoder", Short)
    told = doctor._decoder()
    assert (told.ok, told.detail) == (False, "2 of 3 frames")
    assert told.cure == "reinstall opencv-python-headless"
    assert asked == [((64, 48), 3, (48, 64, 3))]


def test_a_bus_that_is_silent_is_named_with_its_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    silent = LocalBus()

    @contextmanager
    def opened(settings: Any, room: str, *_: object) -> Iterator[Any]:
        assert settings.endpoint.startswith("tcp/127.0.0.1:")
        assert room == "doctor"
        yield silent

    monkeypatch.setattr("common.bus.bus.open_hub", opened)
    monkeypatch.setattr("common.bus.bus.open_client", opened)
    assert doctor._bus()[:3] == ("bus on loopback", True, "answered")
    monkeypatch.setattr(silent, "answer", lambda *_: None)
    monkeypatch.setattr(silent, "_answers", {})
    told = doctor._bus()
    assert told == Finding(
        "bus on loopback", False, "silent", "allow programs to talk over 127.0.0.1"
    )


def test_a_package_of_another_that_stands_in_place_of_ours_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert doctor._own_names()[1:3] == (True, "all from one place")
    places = {name: str(ROOT / name / "__init__.py") for name in PACKAGES}
    places["viewer"] = str(tmp_path / "viewer.py")
    monkeypatch.setattr(
        doctor, "import_module", lambda name: SimpleNamespace(__file__=places[name])
    )
    told = doctor._own_names()
    assert (told.ok, told.detail) == (False, "viewer")
    assert told.cure.endswith("use a virtual environment of its own")


def test_an_extra_is_told_by_its_use_and_missed_by_nothing_that_is_needed() -> None:
    told = doctor._extra("a use", "no-such-package", "page")
    cure = "pip install 'tritrack[page]'"
    assert told == Finding("a use (no-such-package)", False, "not installed", cure, False)
    assert doctor._extra("arrays", "numpy", "x")[:2] == ("arrays (numpy)", True)
    assert not doctor._extra("arrays", "numpy", "x").needed


def test_a_table_marks_what_is_there_what_is_missing_and_what_may_be() -> None:
    rows = [
        Finding("good", True, "1.0", "not wanted"),
        Finding("bad", False, "gone", "install it"),
        Finding("nice", False, "none", "perhaps", needed=False),
    ]
    columns = table_of(rows).columns
    assert [column.header for column in columns] == ["", "what", "found", "what to do"]
    assert [[*column.cells] for column in columns] == [
        ["[green]ok[/]", "[red]missing[/]", "[yellow]-[/]"],
        ["good", "bad", "nice"],
        ["1.0", "gone", "none"],
        ["", "install it", "perhaps"],
    ]
