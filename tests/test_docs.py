"""The documentation: what it quotes is said, what it types is understood, and it makes a site."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import unknown_in, words_of
from source_map import tracked

ROOT = Path(__file__).parents[1]
PAGES = sorted((ROOT / "docs").glob("*.md"))
TYPED = re.compile(r"^ {4}tritrack (\S.*)$", re.MULTILINE)
QUOTED = re.compile(r"^\| `([^`]+)`", re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_a_page_types_is_a_command_with_such_options(page: Path) -> None:
    for typed in TYPED.findall(page.read_text()):
        assert unknown_in(words_of(typed)) == [], f"tritrack {typed}"


def test_each_message_of_the_troubleshooting_is_said_somewhere() -> None:
    sources = [path for path in tracked(ROOT) if path.suffix == ".py" and "tests" not in path.parts]
    said = " ".join(re.sub(r'"\s*f?"', "", path.read_text()) for path in sources)
    quoted = QUOTED.findall((ROOT / "docs" / "troubleshooting.md").read_text())
    assert len(quoted) > 15
    assert [text for text in quoted if text not in said] == []


@pytest.mark.parametrize("page", [*PAGES, *ROOT.glob("*.md")], ids=lambda page: page.stem)
def test_no_page_waits_for_a_figure(page: Path) -> None:
    assert re.findall(r"@@\w+|\bTODO:|\bTBD\b|\bFIXME\b", page.read_text()) == []


def test_every_page_has_its_place_in_the_site() -> None:
    named = re.findall(r"(\w+\.md)", (ROOT / "mkdocs.yml").read_text())
    above = ["index.md", "contributing.md", "changelog.md"]
    assert sorted(named) == sorted([*above, *(page.name for page in PAGES)])


@pytest.mark.slow
def test_the_pages_make_a_site_without_a_broken_link(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs", reason="pip install 'tritrack[docs]'")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path / "site")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    first = (tmp_path / "site" / "index.html").read_text()
    assert "two ordinary cameras, or one" in first
    assert "fonts.googleapis" not in first
    reference = (tmp_path / "site" / "api" / "index.html").read_text()
    for name in ("Tracker", "Bodies", "track", "load_run", "export", "subscribe", "Body"):
        assert re.search(rf"<span[^>]*>{name}</span>|<code>{name}</code>", reference), name
