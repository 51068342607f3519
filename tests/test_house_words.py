"""What modules name and reach, held against a small house whose figures are worked by hand."""

from pathlib import Path

import pytest
from house_words import names_a_pair, needed, reaching
from source_map import Source, sources


def built(root: Path, files: dict[str, str]) -> dict[str, Source]:
    """A house of one package, by its files' names."""
    whole = {"house/__init__.py": "", **{f"house/{name}": text for name, text in files.items()}}
    whole["pyproject.toml"] = '[tool.hatch.build.targets.wheel]\npackages = ["house"]\n'
    for name, text in whole.items():
        (root / name).parent.mkdir(exist_ok=True, parents=True)
        (root / name).write_text(text)
    return {each.path.relative_to("house").as_posix(): each for each in sources(root)}


@pytest.mark.parametrize(
    ("code", "pair"),
    [
        ("first, second = views", True),
        ("first = views[0]", False),
        ("a = settings.camera_1", True),
        ("a = camera_12", False),
        ("a = rig[viewer - 1]", True),
        ("def f(a: tuple[Facing, Facing]) -> None: ...", True),
        ("def f(a: tuple[Facing, ...]) -> None: ...", False),
        ("def f(a: tuple[int, int], b: tuple[Facing, Other]) -> None: ...", False),
        ('a = "camera_1"  # first, second, Pair', False),
        ("from bus import Pair", True),
        ("from bus import Pairing", False),
    ],
)
def test_a_module_names_a_pair_in_its_code_not_in_its_words(
    tmp_path: Path, code: str, pair: bool
) -> None:
    assert names_a_pair(built(tmp_path, {"a.py": code + "\n"})["a.py"]) is pair


def test_what_is_imported_at_once_carries_what_it_needs(tmp_path: Path) -> None:
    """Not what a function imports as it runs, nor what only a checker reads."""
    found = built(
        tmp_path,
        {
            "lock.py": "import fcntl\n",
            "above.py": "if FAST:\n    from house import lock\n",
            "later.py": "def f():\n    import fcntl\n    from house import lock\n",
            "typed.py": "if TYPE_CHECKING:\n    from house import lock\n",
            "room/__init__.py": "from house.above import LOCK\n",
            "room/inside.py": "import os\n",
            "guest.py": "from house.room.inside import NAME\n",
        },
    )
    assert needed(found["room/inside.py"]) == {"os", "house", "house.room"}
    due = ["above.py", "guest.py", "lock.py", "room/__init__.py", "room/inside.py"]
    assert sorted(str(path) for path in reaching([*found.values()])) == [f"house/{n}" for n in due]


def test_an_open_type_is_counted_where_it_is_all_that_is_said(tmp_path: Path) -> None:
    code = "from typing import Any\nx: Any = 1\ny: dict[str, Any] = {}\n"
    code += "def f(a: Any, *b: Any, c: int) -> Any:\n    z: Any\n"
    assert built(tmp_path, {"a.py": code})["a.py"].open_types == 5
