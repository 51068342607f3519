"""A run as a file for other programs: animation, movement laboratories, spreadsheets."""

from pathlib import Path
from typing import Final, NamedTuple

from animator.exchange import LibraryMissing
from common.atomic_file import refuse_to_replace, replacing, unwritten
from common.npz_file import Facts
from runtime.store.past_run import PastRun, open_run
from runtime.store.run_exports import OWN_NAMES, Format, name_of_person
from runtime.store.run_people import of_person, people_of
from tritrack.export_formats import WRITERS, ExportError, Scale

__all__ = ["ENDINGS", "ExportError", "export", "export_run"]

ENDINGS: Final[dict[Format, tuple[str, ...]]] = {
    **{to: (Path(name).suffix,) for to, name in OWN_NAMES.items()},
    "usd": (".usdc", ".usd", ".usda"),
}
"""Allowed suffixes: none of them is a suffix of a run's own files or its video."""


def export(
    folder: str | Path,
    to: Format,
    out: str | Path | None = None,
    *,
    scale: Scale = "m",
    replace: bool = False,
    person: int | None = None,
) -> Facts:
    """Write a run in another format, as `tritrack export` does.

    Examples:
        >>> from tritrack import export
        >>> written = export(folder, "csv")
        >>> written["frames"]
        69

    Args:
        folder: The run's folder.
        to: bvh, gltf, fbx, usd, trc, mot, c3d, csv or angles.
        out: The file to write; None: the default one in the run folder, which is replaced.
        scale: Unit of a BVH file, m or cm; other formats define theirs.
        replace: True: a file at `out` may be replaced.
        person: Number of the person to write; None: all, where there are several in a file each,
            whose name ends in `_person1` and so on.

    Returns:
        `file`, `files`, `frames`, and for a skeleton of fixed bones `off_mm`, the distance of its
        joints from the run's. Of several people, `people` has these by person, and `left_out` says
        who has too few poses to be animated.

    Raises:
        PastRunError: When there is no such run, or no such person in it.
        ExportError: When it has no poses, the format's library is not installed, or the file cannot
            be written or has another format's suffix.
        FileRefused: When a file would be replaced.
    """
    if to not in OWN_NAMES:
        raise ExportError(f"there is no format {to!r}: there are {', '.join(OWN_NAMES)}")
    path = None if out is None else Path(out)
    return export_run(Path(folder), to, path, scale, replace, person)


def export_run(
    folder: Path,
    to: Format,
    out: Path | None,
    scale: Scale = "m",
    replace: bool = False,
    person: int | None = None,
) -> Facts:
    """Write a run in another format; arguments, result and errors are those of `export`."""
    if scale != "m" and to != "bvh":
        raise ExportError(f"--scale is for bvh: {to} has a unit of its own, leave it out")
    path = out or folder / OWN_NAMES[to]
    _refuse_ending(path, to)
    run = open_run(folder)
    parts = _parts(run, path, person, out is not None)
    made, left_out = _made(parts, to, scale)
    files = {place: content for own in made.values() for place, content in own.files.items()}
    for place in files:
        refuse_to_replace(place, replace or out is None)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for place, content in files.items():
            with replacing(place) as new:
                new.write_bytes(content)
    except OSError as error:
        raise ExportError(unwritten(path, error, "name another --out")) from error
    return _told(made, left_out, alone=len(parts) == 1)


def _refuse_ending(path: Path, to: Format) -> None:
    """Refuse a name whose suffix belongs to another format."""
    if path.suffix.lower() not in ENDINGS[to]:
        raise ExportError(f"{path} is no name for {to}: let it end in {' or '.join(ENDINGS[to])}")


class _Made(NamedTuple):
    """What is written of one person."""

    files: dict[Path, bytes]
    facts: Facts


def _parts(
    run: PastRun, path: Path, person: int | None, is_named: bool
) -> dict[int, tuple[Path, PastRun]]:
    """By person, the file and the rows to write."""
    people = people_of(run.poses)
    if person is None and len(people) == 1:
        return {people[0]: (path, run)}
    is_whole = len(people) == 1 or (person is not None and is_named)
    return {
        number: (path if is_whole else name_of_person(path, number), of_person(run, number))
        for number in (people if person is None else (person,))
    }


def _made(
    parts: dict[int, tuple[Path, PastRun]], to: Format, scale: Scale
) -> tuple[dict[int, _Made], dict[int, str]]:
    """By person, the files to write; and why others cannot be animated."""
    from animator.even_steps import NoMotion

    made, left_out = {}, {}
    for number, (path, run) in parts.items():
        try:
            written = WRITERS[to](run, path.name, scale)
        except LibraryMissing as error:
            raise ExportError(str(error)) from error
        except NoMotion as error:
            left_out[number] = str(error)
            continue
        files = {path: written.content}
        if written.beside is not None:
            files[path.with_suffix(written.beside[0])] = written.beside[1]
        made[number] = _Made(files, written.facts)
    if not made:
        _, run = next(iter(parts.values()))
        why = next(iter(left_out.values()))
        raise ExportError(f"{run.folder} cannot be animated: {why}; export another run")
    return made, left_out


def _told(made: dict[int, _Made], left_out: dict[int, str], alone: bool) -> Facts:
    """The command's output."""
    each = [
        {"person": number, "file": names[0], "files": names, **own.facts}
        for number, own in made.items()
        for names in [[str(place) for place in own.files]]
    ]
    if alone:
        return {name: fact for name, fact in each[0].items() if name != "person"}
    return {
        "file": each[0]["file"],
        "files": [name for own in each for name in own["files"]],
        "frames": sum(own["frames"] for own in each),
        "people": each,
        "left_out": left_out,
    }
