"""Levels of a small house, worked by hand: who imports stands higher."""

from pathlib import Path

import pytest
from house_levels import Box, Package, heights, needed, ordered, package
from source_map import sources

FILES = {
    "pyproject.toml": '[tool.hatch.build.targets.wheel]\npackages = ["hut"]\n',
    "hut/__init__.py": '"""A hut: four walls."""\n',
    "hut/roof.py": '"""Roof."""\nimport hut.beam\nimport hut.loft.hay\nimport hut.floor\n',
    "hut/beam.py": '"""Beam."""\nfrom hut import floor\n',
    "hut/floor.py": '"""Floor."""\n',
    "hut/loft/__init__.py": '"""The loft: under the roof."""\n',
    "hut/loft/hay.py": '"""Hay."""\nfrom hut import floor\n',
}
ABOVE = {"a": {"b", "c"}, "b": {"c"}}


@pytest.fixture
def hut(tmp_path: Path) -> Package:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return package(tmp_path, "hut", sources(tmp_path))


def test_whatever_is_imported_stands_lower() -> None:
    assert heights(ABOVE, "abcd") == {"a": 0, "b": 1, "c": 2, "d": 0}


def test_an_arrow_that_follows_from_two_others_is_left_out() -> None:
    assert needed(ABOVE) == [("a", "b"), ("b", "c")]


def test_files_of_a_level_share_a_box_and_folders_say_what_they_are(hut: Package) -> None:
    assert hut.says == "A hut: four walls"
    assert hut.levels == [
        [Box(("hut/roof.py",), "")],
        [Box(("hut/beam.py",), ""), Box(("hut/loft",), "The loft")],
        [Box(("hut/floor.py",), "")],
    ]
    assert ("hut/roof.py", "hut/floor.py") not in hut.points


def test_a_box_stands_below_what_points_to_it(hut: Package) -> None:
    left, right = Box(("left",), ""), Box(("right",), "")
    low, far = Box(("low",), ""), Box(("far",), "")
    crossed = Package("", "", [[left, right], [low, far]], [("left", "far"), ("right", "low")])
    assert ordered(crossed)[1] == [far, low]
    assert ordered(hut) == hut.levels
