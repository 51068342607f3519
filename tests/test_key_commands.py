"""Keys under a user's hands: made by a command, looked over by another."""

import importlib
import json
import sys
from pathlib import Path

import pytest

pytest.importorskip("cryptography", reason="keys are an extra: install tritrack[keys]")

import tritrack.__main__ as door
from runtime.keys.authority import make_keys
from tritrack.commands import key_commands
from tritrack.commands.key_commands import examined_keys


@pytest.fixture
def only_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    """The doctor looks at nothing else."""
    monkeypatch.setattr(importlib.import_module("tritrack.doctor.installation"), "examine", list)


def code_of(monkeypatch: pytest.MonkeyPatch, *words: str | Path) -> int:
    monkeypatch.setattr(sys, "argv", ["tritrack", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        door.main()
    return int(ended.value.code or 0)


@pytest.mark.usefixtures("only_keys")
def test_what_the_command_makes_the_doctor_finds_sound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "keys"
    assert code_of(monkeypatch, "keys", folder, "--host", "rig.local", "--json") == 0
    assert len(json.loads(capsys.readouterr().out)["files"]) == 29
    assert code_of(monkeypatch, "doctor", "--keys", folder, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert all(one["ok"] for one in found)
    assert "rig.local" in found[1]["detail"]


def test_keys_that_are_there_are_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert code_of(monkeypatch, "keys", tmp_path) == 0
    capsys.readouterr()
    assert code_of(monkeypatch, "keys", tmp_path) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert "ca.pem is there already" in line
    assert code_of(monkeypatch, "keys", tmp_path, "--force") == 0


@pytest.mark.usefixtures("only_keys")
def test_an_expired_certificate_is_named_by_the_doctor_who_then_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    make_keys(tmp_path, [], 0)
    assert code_of(monkeypatch, "doctor", "--keys", tmp_path, "--json") == 2
    found = {one["what"]: one for one in json.loads(capsys.readouterr().out)}
    assert found["keys: viewer1"]["detail"].startswith("expired on")
    assert "tritrack keys FOLDER --force" in found["keys: viewer1"]["cure"]


def test_without_the_library_both_say_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("runtime.keys.authority", "tritrack.doctor.key_check"):
        monkeypatch.setitem(sys.modules, name, None)
    assert code_of(monkeypatch, "keys", tmp_path / "keys") == 2
    assert key_commands.INSTALL in capsys.readouterr().err
    (found,) = examined_keys(tmp_path)
    assert (found.ok, found.cure) == (False, key_commands.INSTALL)
