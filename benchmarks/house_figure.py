"""The house drawn from its imports: packages, the folders in them, and arrows that go down.

Run from the checkout that is to be drawn:

    .venv/bin/python benchmarks/house_figure.py docs/house.png

A box is a folder, or the files that lie at a package's top and stand equally high: what nobody
else in the package imports stands highest. An arrow points to what is imported; one that follows
from two others is left out. Arrows between packages hold for all of their files.
"""

import argparse
import io
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from house_levels import Box, Package, ordered, package
from source_map import sources

MIDDLE: Final = ("viewer", "integrator", "recognizer", "animator", "synth")
"""Packages of the middle floor; what runs them stands on it, what they share lies below."""
FLOORS: Final = (("tritrack",), ("lab",), ("runtime",), MIDDLE, ("calibration",), ("common",))
STACKED: Final = (("tritrack",), ("lab",), ("calibration",))
"""Floors that stand on another of one package."""
SHARES: Final = {"viewer": 26, "integrator": 25, "recognizer": 21, "animator": 17, "synth": 11}
"""Widths of the packages of the middle floor; the others are as wide as all of these."""
INCHES: Final = 0.125
"""What one of them is on paper; letters have a fixed size."""
LETTERS: Final = 2.05
"""How many letters of the small print one of them takes."""
SMALL: Final = 8
"""Points of the small print ..."""
BOLD: Final = 1.15
"""... and how much wider fat letters are."""
BOX: Final = 4.0
"""Height of a box, and of the head of a package in the middle."""
LEVEL: Final = 5.4
"""From one row of boxes to the next, at least; LOOSEST times that at most."""
LOOSEST: Final = 1.5
WIDEST: Final = 18.0
FLOOR_GAP: Final = 4.0
COLOURS: Final = {
    **{"tritrack": "#e8e4f3", "common": "#e9e9e6", "viewer": "#dcecf7", "integrator": "#def0df"},
    **{"recognizer": "#fbe9d4", "animator": "#f8dfe3", "synth": "#f4f0cf"},
    **{"lab": "#e3edf0", "runtime": "#efe6dc", "calibration": "#e0efe8"},
}
INK: Final = "#55555c"


def draw(packages: Mapping[str, Package], out: Path) -> None:
    """Write the picture."""
    from matplotlib.figure import Figure

    tall = [BOX + LEVEL * max(len(packages[name].levels) for name in floor) for floor in FLOORS]
    width, height = sum(SHARES.values()), sum(tall) + FLOOR_GAP * (len(FLOORS) - 1)
    figure = Figure(figsize=(width * INCHES, height * INCHES))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(-0.3, width - 0.3), ylim=(height + 0.3, -0.3))
    axes.axis("off")
    top = 0.0
    for floor, depth in zip(FLOORS, tall, strict=True):
        left = 0.0
        for name in floor:
            share = float(SHARES.get(name, width))
            panel(axes, packages[name], (left, top, share - 0.6, depth))
            if name in MIDDLE:
                below = (top + depth + FLOOR_GAP,) if name == "integrator" else ()
                for y in (top, *below):
                    x = left + share / 2
                    arrow(axes, (x, y - FLOOR_GAP + 0.2), (x, y - 0.2), 2.2)
            elif floor in STACKED:
                y = top + depth + FLOOR_GAP
                arrow(axes, (width / 2, y - FLOOR_GAP + 0.2), (width / 2, y - 0.2), 2.2)
            left += share
        top += depth + FLOOR_GAP
    save(figure, out)


def panel(axes: Any, drawn: Package, place: tuple[float, float, float, float]) -> None:
    """A package: (left, top, width, height)."""
    left, top, width, height = place
    rectangle(axes, place, COLOURS[drawn.name], 0)
    axes.text(left + 0.5, top + 1.3, f"{drawn.name}/", va="center", size=13, weight="bold")
    said = textwrap.fill(drawn.says, int(width * LETTERS))
    axes.text(left + 0.5, top + 2.3, said, va="top", size=8)
    spots: dict[str, tuple[float, float]] = {}
    step = min((height - BOX) / len(drawn.levels), LOOSEST * LEVEL)
    for n, level in enumerate(ordered(drawn)):
        each = (width - 0.6) / len(level)
        for k, box in enumerate(level):
            wide = min(each - 0.5, WIDEST)
            middle, y = left + 0.3 + each * (k + 0.5), top + BOX + 0.7 + step * n
            rectangle(axes, (middle - wide / 2, y, wide, BOX), "white", 2)
            write(axes, box, (middle, y), wide)
            spots.update(dict.fromkeys(box.names, (middle, y)))
    for a, b in drawn.points:
        (x0, y0), (x1, y1) = spots[a], spots[b]
        arrow(axes, (x0, y0 + BOX), (x1, y1), 0.8)


def write(axes: Any, box: Box, above: tuple[float, float], width: float) -> None:
    """What a box says, under the middle of its upper edge."""
    x, y = above
    letters = int(width * LETTERS)
    style = {"ha": "center", "va": "center", "zorder": 3}
    if box.says:
        name = box.names[0].split("/", 1)[1]
        size = fitting(f"{name}/", width / BOLD, 10)
        axes.text(x, y + 0.8, f"{name}/", size=size, weight="bold", **style)
        said = textwrap.wrap(box.says, letters, max_lines=2, placeholder=" ...")
        axes.text(x, y + 2.5, "\n".join(said), size=8, **style)
        return
    stems = ", ".join(Path(name).stem for name in box.names)
    said = textwrap.wrap(stems, letters, break_long_words=False)
    size = fitting(max(said, key=len), width, 9 if len(said) < 3 else SMALL)
    axes.text(x, y + BOX / 2, "\n".join(said), size=size, **style)


def fitting(line: str, width: float, largest: float) -> float:
    """The size of letters, points, at which a line stays in its box."""
    return min(largest, SMALL * LETTERS * width / len(line))


def rectangle(
    axes: Any, place: tuple[float, float, float, float], colour: str, zorder: int
) -> None:
    """A filled one, (left, top, width, height)."""
    from matplotlib.patches import Rectangle

    left, top, width, height = place
    axes.add_patch(Rectangle((left, top), width, height, fc=colour, ec=INK, lw=0.8, zorder=zorder))


def arrow(axes: Any, start: tuple[float, float], end: tuple[float, float], width: float) -> None:
    """Down from one box to another, behind those between."""
    style = {"arrowstyle": "-|>", "lw": width, "color": INK, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops={**style, "mutation_scale": 8 + 4 * width}, zorder=1)


def save(figure: Any, out: Path) -> None:
    """As a PNG of few colours: a third of the bytes."""
    from PIL import Image

    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=130)
    Image.open(drawn).convert("RGB").quantize(48).save(out, "PNG", optimize=True)


def main() -> None:
    """Draw the house."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("out", type=Path, help="the picture to write")
    given = parser.parse_args()
    root = Path.cwd()
    found = sources(root)
    draw({name: package(root, name, found) for floor in FLOORS for name in floor}, given.out)


if __name__ == "__main__":
    main()
