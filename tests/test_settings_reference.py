"""The page of all settings: that of the types, each setting explained."""

import tomllib

import msgspec
import pytest
from settings_reference import FILE, meanings, text

from common.config.part_settings import BusSettings, CameraSettings
from common.config.settings import Settings


def rows() -> dict[str, dict[str, list[str]]]:
    """Kind, default and meaning of each setting, by section and name, read off the page."""
    found: dict[str, dict[str, list[str]]] = {}
    for line in FILE.read_text().splitlines():
        if line.startswith("## "):
            section = found.setdefault(line[3:].strip("`"), {})
        elif line.startswith("| `"):
            name, *rest = (each.strip() for each in line.strip("|").replace("\\|", "/").split("|"))
            section[name.strip("`")] = rest
    return found


def test_the_page_is_written_from_the_types() -> None:
    """Else: .venv/bin/python benchmarks/settings_reference.py."""
    assert FILE.read_text() == text()


def test_every_setting_is_there_with_a_meaning() -> None:
    found = rows()
    tables = {name.strip("[]") for name in found} - {"At the top of the file", "cameras.NAME"}
    top = {*found["At the top of the file"], "cameras", *tables}
    assert top == {field.name for field in msgspec.structs.fields(Settings)}
    assert all(meaning for section in found.values() for *_, meaning in section.values())


@pytest.mark.parametrize("section", ["silhouette", "search", "body", "recognizer", "page", "bus"])
def test_the_defaults_as_they_stand_are_the_settings_without_a_file(section: str) -> None:
    """Read by Python's own TOML: a file of all defaults changes nothing."""
    lines = [
        f"{name} = {default.strip('`')}" for name, (_, default, _) in rows()[f"[{section}]"].items()
    ]
    given = {section: tomllib.loads("\n".join(lines))}
    assert msgspec.convert(given, Settings) == Settings()


def test_a_field_without_a_word_below_it_has_no_meaning_of_another() -> None:
    assert meanings(CameraSettings)["device"] == "Index of a camera of this host; -1: none."
    assert meanings(BusSettings)["open_to_all"].startswith("True: accept every connection")
