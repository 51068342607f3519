"""What is counted of source files, held against a small house whose figures are worked by hand."""

from pathlib import Path

import pytest
from source_map import arrows, circles, sources

FILES = {
    "pyproject.toml": '[tool.hatch.build.targets.wheel]\npackages = ["upper", "lower"]\n',
    "upper/__init__.py": '"""Above."""\n',
    "upper/deep.py": '''"""Deep things."""

import os
from lower import stone
from lower.stone import LIMIT  # twice the same file


class Wall:
    """A wall."""

    def high(self, one, two, *, three=None):
        """So high.

        In two lines.
        """
        # why
        if one:
            for each in two:
                with each:
                    pass
        elif two:
            while three:
                pass

        return os.path.join(
            one, LIMIT
        )


@compiled
def fast(): return stone
''',
    "lower/__init__.py": '"""Below."""\n',
    "lower/stone.py": '"""A stone."""\n\nLIMIT = 1\n"""How many."""\n',
    "tests/test_stone.py": '"""No part of the packages."""\n',
}


@pytest.fixture
def house(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def test_lines_of_code_are_neither_words_nor_blanks(house: Path) -> None:
    counted = {each.path.as_posix(): each.code_lines for each in sources(house)}
    assert counted == {
        "upper/__init__.py": 0,
        "upper/deep.py": 17,
        "lower/__init__.py": 0,
        "lower/stone.py": 1,
    }


def test_a_function_is_counted_by_its_body(house: Path) -> None:
    deep = next(each for each in sources(house) if each.path.name == "deep.py")
    high, fast = sorted(deep.functions, key=lambda each: -each.code_lines)
    assert high == ("upper/deep.py (high)", 10, 3, 3, "plain")
    assert fast == ("upper/deep.py (fast)", 1, 0, 0, "compiled")


def test_an_arrow_joins_the_files_however_they_are_named(house: Path) -> None:
    found = {(str(a), str(b)) for a, b in arrows(house, sources(house))}
    assert found == {("upper/deep.py", "lower/stone.py")}


def test_a_circle_is_what_leads_back() -> None:
    graph = {"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}}
    assert circles(graph) == [{"b", "c"}]
