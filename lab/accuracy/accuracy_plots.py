"""Plots of accuracy: the distribution of errors, and the reliability of confidence."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from common.npz_file import Facts
from lab.accuracy.accuracy import JOINTS, Compared
from lab.accuracy.reliability import NEAR_MM, roc

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_all(clips: Sequence[Compared], report: Facts, out: Path) -> dict[str, str]:
    """Write every plot as PNG; returns its caption and its file.

    Args:
        clips: The compared clips; at least one frame in all.
        report: The numbers: `per_joint`, `confidence`.
        out: Output folder.

    Raises:
        OSError: When a file cannot be written.
    """
    from matplotlib.figure import Figure

    drawn = {
        "Share of joints within a distance": ("errors.png", _errors),
        "Error of each joint": ("joints.png", _joints),
        "Reliability: what confidence promises, and what comes": ("reliability.png", _reliability),
        "ROC: near joints found by confidence": ("roc.png", _roc),
    }
    for name, plot in drawn.values():
        figure = Figure(figsize=(5.2, 3.6), layout="constrained")
        plot(figure.add_subplot(), clips, report)
        figure.savefig(out / name, dpi=110)
    return {title: name for title, (name, _) in drawn.items()}


def _errors(axes: "Axes", clips: Sequence[Compared], _report: Facts) -> None:
    off = np.sort(np.concatenate([clip.off_mm.ravel() for clip in clips]))
    axes.plot(off, np.arange(1, off.size + 1) / off.size)
    axes.set(xlim=(0, max(200.0, float(np.percentile(off, 98)))), ylim=(0, 1))
    axes.set(xlabel="error, mm", ylabel="share of joints")
    axes.grid(alpha=0.3)


def _joints(axes: "Axes", _clips: Sequence[Compared], report: Facts) -> None:
    for name, mark in (("p95", "_"), ("mean", "o"), ("median", "x")):
        axes.plot(JOINTS, [report["per_joint"][joint][name] for joint in JOINTS], mark, label=name)
    axes.set(ylabel="error, mm", ylim=(0, None))
    axes.tick_params(axis="x", rotation=60)
    axes.grid(axis="y", alpha=0.3)
    axes.legend()


def _reliability(axes: "Axes", _clips: Sequence[Compared], report: Facts) -> None:
    bins = [one for one in report["confidence"]["bins"] if one["count"]]
    counts = np.array([one["count"] for one in bins])
    said = [one["confidence"] for one in bins]
    axes.bar([one["from"] + 0.05 for one in bins], counts / counts.sum(), 0.09, alpha=0.25)
    axes.plot((0, 1), (0, 1), ":", color="grey")
    axes.plot(said, [one["near"] for one in bins], "o-", color="C3")
    axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="confidence")
    axes.set(ylabel=f"share within {NEAR_MM:g} mm (line), of all joints (bars)")
    axes.grid(alpha=0.3)


def _roc(axes: "Axes", clips: Sequence[Compared], report: Facts) -> None:
    confidence = np.concatenate([clip.confidence for clip in clips])
    near = np.concatenate([clip.off_mm for clip in clips]) < NEAR_MM
    area = report["confidence"]["auc"]["all"]
    axes.plot(*roc(confidence, near), label=f"all joints, area {area:.2f}")
    axes.plot((0, 1), (0, 1), ":", color="grey", label="a constant, area 0.50")
    axes.set(xlim=(0, 1), ylim=(0, 1))
    axes.set(xlabel=f"share of those beyond {NEAR_MM:g} mm", ylabel="share of those within")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right")
