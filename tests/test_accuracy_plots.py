"""The pictures of an accuracy report, held against numbers that are counted by hand."""

from pathlib import Path

import numpy as np
import pytest
from drawing import curves, figures_drawn

pytest.importorskip("matplotlib", reason="pip install 'tritrack[report]'")

from lab.accuracy.accuracy import JOINTS, Compared
from lab.accuracy.accuracy_plots import plot_all
from lab.accuracy.reliability import NEAR_MM


def compared(off_mm: float, sure: float) -> Compared:
    """One frame, every joint so far off and so sure."""
    true_m = np.zeros((1, len(JOINTS), 3))
    tracked_m = true_m + np.array([0.0, off_mm / 1e3, 0.0])
    rows, confidence = np.zeros(1, np.int64), np.full((1, len(JOINTS)), sure)
    return Compared(rows, rows, tracked_m, true_m, confidence, 1, 0, 0)


def test_every_plot_shows_the_numbers_of_the_report(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Two clips of one frame: all joints of one 10 mm off and sure, of the other 300 and unsure."""
    drawn, n = figures_drawn(monkeypatch), len(JOINTS)
    clips = [compared(10.0, 0.9), compared(300.0, 0.2)]
    bins = [
        {"from": 0.2, "count": 1, "confidence": 0.25, "near": 0.0},
        {"from": 0.5, "count": 0, "confidence": None, "near": None},
        {"from": 0.9, "count": 3, "confidence": 0.95, "near": 1.0},
    ]
    joints = {name: {"p95": 3.0 * i, "mean": 2.0 * i, "median": i} for i, name in enumerate(JOINTS)}
    report = {"per_joint": joints, "confidence": {"bins": bins, "auc": {"all": 0.875}}}
    files = plot_all(clips, report, tmp_path)
    assert sorted(files.values()) == sorted(path.name for path in tmp_path.iterdir())
    errors, each, reliability, roc = (figure.axes[0] for figure in drawn)

    ((off, share),) = curves(errors)
    assert off == pytest.approx([10.0] * n + [300.0] * n)
    assert share == pytest.approx(np.arange(1, 2 * n + 1) / (2 * n))
    assert errors.get_xlim() == pytest.approx((0.0, 300.0))
    assert [y for _, y in curves(each)] == [
        [times * i for i in range(n)] for times in (3.0, 2.0, 1.0)
    ]
    assert [bar.get_height() for bar in reliability.patches] == [0.25, 0.75]
    assert [bar.get_x() + bar.get_width() / 2 for bar in reliability.patches] == pytest.approx(
        [0.25, 0.95]
    )
    assert curves(reliability)[1] == ([0.25, 0.95], [0.0, 1.0])
    found, _ = curves(roc)
    assert (0.0, 1.0) in zip(*found, strict=True), "all near ones are surer than any other"
    assert "area 0.88" in roc.get_legend().get_texts()[0].get_text()
    assert f"{NEAR_MM:g} mm" in roc.get_xlabel()


def test_errors_of_less_than_two_decimetres_are_drawn_on_the_same_scale(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    drawn = figures_drawn(monkeypatch)
    joints = {name: {"p95": 1.0, "mean": 1.0, "median": 1.0} for name in JOINTS}
    bins = [{"from": 0.9, "count": 3, "confidence": 0.95, "near": 1.0}]
    report = {"per_joint": joints, "confidence": {"bins": bins, "auc": {"all": 0.5}}}
    plot_all([compared(5.0, 0.9)], report, tmp_path)
    assert drawn[0].axes[0].get_xlim() == (0.0, 200.0)
