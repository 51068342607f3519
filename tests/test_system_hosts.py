"""Containers and units of a rig over hosts: what they start is there, once, on the right cameras.

No image is built here: that wants an engine, and a registry to take Python from.
"""

import re
import shutil
import subprocess
import sys
import tomllib
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

import pytest
from command_line import unknown_in
from meeting import free_endpoint

from common.config.config_file import load
from tritrack import subscribe

ROOT: Final = Path(__file__).parents[1]
UNITS: Final = ROOT / "configs" / "systemd"
RIG: Final = "rig.toml"
BODY: Final = ("integrate", "recognize", "animate")
STARTED: Final = re.compile(r"^ExecStart=/opt/tritrack/bin/tritrack (.+)$", re.MULTILINE)
TOLD: Final = re.compile(r"^# .*: systemctl enable --now (.+)$", re.MULTILINE)


@pytest.fixture(scope="module")
def services() -> dict[str, Any]:
    yaml = pytest.importorskip("yaml", reason="pip install 'tritrack[docs]'")
    found: dict[str, Any] = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"]
    return found


def parts(commands: list[list[str]]) -> list[str]:
    """Each command's word, and a viewer's number, once it is seen to be one for the rig's file."""
    for words in commands:
        assert unknown_in(words) == []
        assert Path(words[1]).name == RIG
    return [" ".join([words[0], *words[3:]]) for words in commands]


def started_by_units() -> list[list[str]]:
    found = []
    for path in sorted(UNITS.glob("*@.service")):
        (command,) = STARTED.findall(path.read_text())
        (told,) = TOLD.findall(path.read_text())
        for unit in told.split():
            name, _, instance = unit.partition("@")
            assert path.name == f"{name}@.service"
            found.append(command.replace("%i", instance).split())
    return found


def test_the_services_are_all_processes_of_a_rig(services: dict[str, Any]) -> None:
    started = parts([one["command"] for one in services.values()])
    assert sorted(started) == sorted([*BODY, "view 1", "view 2"])


def test_the_units_are_all_processes_of_a_rig() -> None:
    assert sorted(parts(started_by_units())) == sorted([*BODY, "view 1", "view 2"])


def test_the_cameras_are_those_of_the_settings(services: dict[str, Any]) -> None:
    settings = load(ROOT / "configs" / RIG)
    for number, camera in ((1, settings.cameras["cam1"]), (2, settings.cameras["cam2"])):
        assert services[f"viewer-{number}"]["devices"] == [f"/dev/video{camera.device}"]


def test_each_host_has_its_profile(services: dict[str, Any]) -> None:
    on = {name: one["profiles"] for name, one in services.items()}
    assert {name for name, profiles in on.items() if profiles == ["cameras"]} == {
        "viewer-1",
        "viewer-2",
    }
    assert all(profiles in (["cameras"], ["body"]) for profiles in on.values())


def test_the_image_asks_for_extras_and_modules_that_there_are() -> None:
    text = (ROOT / "Containerfile").read_text()
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    (wanted,) = re.findall(r"\.whl\)\[([a-z,]+)\]", text)
    assert set(wanted.split(",")) <= set(extras["optional-dependencies"])
    (module,) = re.findall(r"python -m ([\w.]+)", text)
    assert (ROOT / module.replace(".", "/")).with_suffix(".py").is_file()


@pytest.mark.parametrize("instance", ["tritrack@integrate.service", "tritrack-view@1.service"])
def test_systemd_understands_every_line_of_a_unit(instance: str, tmp_path: Path) -> None:
    if shutil.which("systemd-analyze") is None:
        pytest.skip("there is no systemd here to read units")
    template = (UNITS / re.sub("@.*", "@.service", instance)).read_text()
    unit = tmp_path / instance
    unit.write_text(template.replace("/opt/tritrack/bin/tritrack", sys.executable))
    done = subprocess.run(
        ["systemd-analyze", "verify", str(unit)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert instance not in done.stderr


@pytest.mark.slow
@pytest.mark.live
def test_the_processes_of_a_rig_find_each_other_in_any_order(clip: Path, tmp_path: Path) -> None:
    """The viewers first, who wait for the integrator: as on two hosts that are switched on."""
    pytest.importorskip("websockets", reason="pip install 'tritrack[page]'")
    endpoint, page = free_endpoint(), free_endpoint().rpartition(":")[2]
    rig = tmp_path / RIG
    told = f'[page]\nport = {page}\n[bus]\nendpoint = "{endpoint}"\nsession = "word"\n'
    rig.write_text(f'clip = "{clip}"\n{told}')
    started: dict[str, subprocess.Popen[bytes]] = {}
    with ExitStack() as doors:
        for words in started_by_units():
            command = [sys.executable, "-m", "tritrack", words[0], str(rig), *words[2:]]
            process = doors.enter_context(subprocess.Popen(command, stderr=subprocess.DEVNULL))
            doors.callback(process.terminate)
            started[" ".join([words[0], *words[3:]])] = process
        bodies = [body for body in subscribe(endpoint, wait_s=60.0) if body.joints_m]
        for name in ("view 1", "view 2", "integrate"):
            assert started[name].wait(60.0) == 0, name
    assert len(bodies) > 10
    assert {process.returncode for process in started.values()} == {0}
