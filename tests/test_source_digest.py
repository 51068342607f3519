"""Digests of the sources: what changes them, and what does not."""

import hashlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from common import source_digest
from common.packages import PACKAGES, ROOT
from common.source_digest import Source, digest_of, module_digest, source_of


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    root = tmp_path / "sources"
    for package in PACKAGES:
        (root / package / "room").mkdir(parents=True)
        (root / package / "room" / "stage.py").write_text("STEP = 1\n")
    return root


@pytest.mark.parametrize("package", PACKAGES)
def test_any_change_in_any_package_gives_another_digest(sources: Path, package: str) -> None:
    before, stage = digest_of(sources), sources / package / "room" / "stage.py"
    times = stage.stat().st_atime_ns, stage.stat().st_mtime_ns
    stage.write_text("STEP = 2\n")
    os.utime(stage, ns=times)
    assert digest_of(sources) != before


@pytest.mark.parametrize(
    "change",
    [
        lambda room: (room / "stage.py").rename(room / "stage_two.py"),
        lambda room: (room / "stage.py").unlink(),
        lambda room: (room / "more.py").write_text(""),
    ],
)
def test_a_file_that_moves_comes_or_goes_gives_another_digest(
    sources: Path, change: Callable[[Path], object]
) -> None:
    before = digest_of(sources)
    change(sources / "viewer" / "room")
    assert digest_of(sources) != before


def test_what_is_no_source_leaves_the_digest(sources: Path) -> None:
    before = digest_of(sources)
    (sources / "viewer" / "room" / "network.npz").write_bytes(b"1")
    (sources / "README.md").write_text("1")
    assert digest_of(sources) == before


def test_the_digest_reads_each_of_our_sources_once_and_nothing_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Every process takes it as it starts; how long that takes `tritrack bench` tells."""
    opened: list[Path] = []
    content = source_digest._content

    def counted(path: str) -> bytes:
        opened.append(Path(path))
        return content(path)

    monkeypatch.setattr(source_digest, "_content", counted)
    digest_of(ROOT)
    ours = [path for name in PACKAGES for path in (ROOT / name).rglob("*.py")]
    assert sorted(opened) == sorted(ours)


@pytest.mark.parametrize(
    ("statement", "imported"),
    [
        ("from common.raster.bits import pack", {"common.raster.bits"}),
        (
            "from common.raster import bits, kernel",
            {"common.raster", "common.raster.bits", "common.raster.kernel"},
        ),
        ("from common.raster.bits import (\n    pack,\n)", {"common.raster.bits"}),
        ("import common.raster.bits as bits, os", {"common.raster.bits"}),
        ("def f():\n    from common.raster.bits import pack", {"common.raster.bits"}),
        ("from numpy import linalg\nimport os", set()),
        ("# from common.raster.bits import pack", set()),
    ],
)
def test_imports_are_read_in_every_form(
    statement: str, imported: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(source_digest, "_content", lambda _: statement.encode())
    assert set(source_of.__wrapped__("common.packages").imports) == imported


def test_a_digest_follows_imports_of_imports(monkeypatch: pytest.MonkeyPatch) -> None:
    """kernel -> row_spans -> bits: a byte in the last changes the first, and none in merge does."""
    content = source_digest._content

    def digest(edited: str) -> str:
        def read(path: str) -> bytes:
            return content(path) + (b"#" if path.endswith(edited) else b"")

        monkeypatch.setattr(source_digest, "_content", read)
        source_of.cache_clear()
        return module_digest.__wrapped__("common.raster.kernel")

    try:
        before = digest("nothing")
        assert len(before) == 16
        assert digest("raster/bits.py") != before
        assert digest("raster/kernel.py") != before
        assert digest("integrator/merge.py") == before
    finally:
        source_of.cache_clear()


def test_a_module_without_a_source_is_refused() -> None:
    with pytest.raises(FileNotFoundError, match=r"common\.nowhere"):
        module_digest("common.nowhere")


def test_a_digest_is_of_every_module_that_is_reached_once_and_in_the_order_of_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """b -> a -> c -> b, and another that none of them imports."""
    known = {
        "b": Source(b"2", ("a",)),
        "a": Source(b"1", ("c",)),
        "c": Source(b"3", ("b",)),
        "d": Source(b"4", ("b",)),
    }
    monkeypatch.setattr(source_digest, "source_of", known.__getitem__)
    due = hashlib.sha256()
    for name in "abc":
        for part in (name.encode(), known[name].digest):
            due.update(len(part).to_bytes(8, "little") + part)
    assert module_digest.__wrapped__("b") == due.hexdigest()[:16]


def test_a_digest_does_not_ask_in_which_order_a_disk_has_its_files(
    sources: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("attic", "cellar"):
        (sources / "viewer" / name).mkdir()
        for file in ("one.py", "two.py"):
            (sources / "viewer" / name / file).write_text(f"PLACE = '{name}'\n")
    before, walk = digest_of(sources), os.walk

    def backwards(top: Path) -> Iterator[tuple[str, list[str], list[str]]]:
        for folder, folders, files in walk(top):
            folders.sort(reverse=True)
            yield folder, folders, sorted(files, reverse=True)

    monkeypatch.setattr(os, "walk", backwards)
    assert digest_of(sources) == before
