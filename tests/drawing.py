"""What is drawn by matplotlib, looked at before it becomes a picture."""

from typing import Any

import pytest


def figures_drawn(patch: pytest.MonkeyPatch) -> list[Any]:
    """Every figure, as it is when it is saved; the picture is a few bytes."""
    from matplotlib.figure import Figure

    drawn: list[Any] = []

    def saved(figure: Figure, to: Any, **_: object) -> None:
        drawn.append(figure)
        to.write(b"png") if hasattr(to, "write") else to.write_bytes(b"png")

    patch.setattr(Figure, "savefig", saved)
    return drawn


def curves(axes: Any) -> list[tuple[list[float], list[float]]]:
    """x and y of every line; an axis of names has their places."""
    return [([*line.get_xdata(False)], [*line.get_ydata(False)]) for line in axes.get_lines()]
