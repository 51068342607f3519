"""The wheel's one namespace: imports that are renamed, and what cannot be."""

import ast
import re
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from source_map import packages, tracked

pytest.importorskip("hatchling", reason="pip install 'tritrack[dev]'")

from hatch_build import Immovable, moved, renamed

ROOT = Path(__file__).parents[1]
NAMES = {name: f"tritrack.{name}" for name in packages(ROOT) if name != "tritrack"}


class Renaming(ast.NodeTransformer):
    """The same by the tree, without a care for lines."""

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.ImportFrom:
        if node.level == 0 and node.module is not None:
            node.module = new_name(node.module)
        return node

    def visit_Import(self, node: ast.Import) -> ast.Import:
        for alias in node.names:
            alias.name = new_name(alias.name)
        return node


def new_name(name: str) -> str:
    top, dot, rest = name.partition(".")
    return NAMES.get(top, top) + dot + rest


@pytest.mark.parametrize(
    ("source", "new"),
    [
        ("from common.x import y", "from tritrack.common.x import y"),
        ("from viewer import track", "from tritrack.viewer import track"),
        ("import synth.write as w, os", "import tritrack.synth.write as w, os"),
        ("from  common.x import (\n  y,\n  z)", "from  tritrack.common.x import (\n  y,\n  z)"),
        ("from \\\n  common import x", "from \\\n  tritrack.common import x"),
        ("s = 'é'; from common import x", "s = 'é'; from tritrack.common import x"),
        ("def f():\n\tfrom common import x", "def f():\n\tfrom tritrack.common import x"),
    ],
)
def test_an_import_of_ours_names_the_namespace(source: str, new: str) -> None:
    assert renamed(source.encode(), NAMES).decode() == new


@pytest.mark.parametrize(
    "source",
    [
        "from tritrack.commands import options",
        "from commons import x",
        "from . import common",
        "from numpy import viewer",
        "import viewers",
        "'from common import x'  # from common import x",
        "def f():\n    yield from common",
        "common = viewer.synth",
    ],
)
def test_all_else_stays_as_it_is(source: str) -> None:
    assert renamed(source.encode(), NAMES).decode() == source


def test_an_import_that_binds_the_old_name_is_refused() -> None:
    with pytest.raises(Immovable, match=r"2: import common.config as something"):
        renamed(b"import os\nimport common.config", NAMES)


def test_a_module_named_in_a_string_is_refused_with_its_place(tmp_path: Path) -> None:
    (tmp_path / "common").mkdir()
    (tmp_path / "common" / "child.py").write_text("KEPT = 'common.npz'\nMODULE = 'common.child'\n")
    with pytest.raises(Immovable, match=r"common/child.py:2: 'common.child' .* by __package__"):
        moved(tmp_path, Path("common/child.py"), NAMES)


LINES = st.lists(
    st.sampled_from(
        [
            *("from common.bus import bus", "from viewer import (\n    track,\n)", "x = 'äöü'"),
            *(
                "import synth as s, animator.video_file as f",
                "from numpy import array",
                "# from common",
            ),
            *("if x:\n    from integrator import merge; y = 1", "from tritrack import client"),
            *("'''\nfrom common import x\n'''", "x = 'ü'; import recognizer.events as e"),
        ]
    )
)


@given(LINES)
def test_renaming_is_that_of_the_tree_and_no_line_moves(lines: list[str]) -> None:
    source = "\n".join(lines)
    new = renamed(source.encode(), NAMES).decode()
    assert ast.dump(ast.parse(new)) == ast.dump(Renaming().visit(ast.parse(source)))
    assert new.count("\n") == source.count("\n")
    assert renamed(new.encode(), NAMES).decode() == new


@pytest.mark.slow
def test_every_file_of_ours_can_be_moved() -> None:
    """Nothing is left of the old names, and a traceback's line is that of the checkout."""
    old = re.compile(rf"^\s*(from|import) ({'|'.join(NAMES)})\b", re.MULTILINE)
    paths = [path.relative_to(ROOT) for path in tracked(ROOT) if path.suffix == ".py"]
    ours = [path for path in paths if path.parts[0] in {"tritrack", *NAMES}]
    assert len(ours) > 300
    for path in ours:
        new, text = moved(ROOT, path, NAMES).decode(), (ROOT / path).read_text()
        assert not old.search(new), path
        assert new.count("\n") == text.count("\n")


def test_all_packages_go_into_one_where_nothing_has_their_names() -> None:
    told = tomllib.loads((ROOT / "pyproject.toml").read_text())
    wheel = told["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert wheel["sources"] == {name: f"tritrack/{name}" for name in NAMES}
    assert {path.stem for path in (ROOT / "tritrack").iterdir()}.isdisjoint(NAMES)
