"""The installation, looked over."""

import importlib
import io
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from fake_mediapipe import install_fake
from rich.console import Console

import tritrack.__main__ as door
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
