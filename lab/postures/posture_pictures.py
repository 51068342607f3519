"""Pictures of a posture report: the confusions, and the worst clips."""

from pathlib import Path
from typing import Final

import numpy as np

from common.method import Mode
from common.npz_file import Facts
from lab.postures.contact_strip import contact_strip
from runtime.offline.lockstep import Decoders

DPI: Final = 110


def draw_confusion(result: Facts, title: str, path: Path) -> None:
    """Write the confusion matrix of one recogniser as PNG.

    Raises:
        OSError: When it cannot be written.
    """
    from matplotlib.figure import Figure

    counts = np.array(result["confusion"]["counts"])
    named = [name or "no name" for name in result["confusion"]["named"]]
    side = 2.5 + 0.36 * len(counts)
    figure = Figure(figsize=(side + 0.4, side), layout="constrained")
    axes = figure.add_subplot()
    axes.imshow(counts / np.maximum(counts.sum(axis=1, keepdims=True), 1), cmap="Blues", vmax=1.3)
    axes.set_xticks(range(len(named)), named, rotation=90)
    axes.set_yticks(range(len(counts)), list(result["postures"]))
    axes.set(xlabel="named", ylabel="shown", title=title)
    for row, column in np.argwhere(counts).tolist():
        axes.text(column, row, str(counts[row, column]), ha="center", va="center", fontsize=8)
    figure.savefig(path, dpi=DPI)


def draw_worst(result: Facts, mode: Mode | None, folder: Path, prefix: str) -> None:
    """Write a strip of frames of each of the worst clips, and record its file name.

    A run folder holds no pictures, so it gets no strip.

    Raises:
        ClipError: When a clip cannot be used any more.
        OSError: When a picture cannot be written.
    """
    with Decoders() as decoders:
        for number, one in enumerate(result["worst"], 1):
            clip = Path(one["clip"])
            if not one["clip"] or (clip / "poses.npz").is_file():
                continue
            one["picture"] = f"{prefix}_{number:02d}.png"
            (folder / one["picture"]).write_bytes(contact_strip(clip, mode, decoders))
