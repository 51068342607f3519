"""The curves of a run: which joint is drawn where, over which seconds."""

import numpy as np
import pytest
from drawing import curves, figures_drawn

pytest.importorskip("matplotlib", reason="pip install 'tritrack[report]'")

from common.body.body import ANGLE_NAMES
from tritrack.single.angle_plot import angle_plot


@pytest.mark.parametrize(("time_s", "until_s"), [((0.5, 1.0, 2.5), 2.5), ((0.5,), 0.6), ((), 0.1)])
def test_each_row_has_both_sides_of_one_joint_over_time(
    monkeypatch: pytest.MonkeyPatch, time_s: tuple[float, ...], until_s: float
) -> None:
    """Every angle is its place in the list of names, plus a tenth each frame."""
    drawn = figures_drawn(monkeypatch)
    angles = np.arange(len(ANGLE_NAMES)) + 0.1 * np.arange(len(time_s))[:, None]
    poses = {"angle_names": np.array(ANGLE_NAMES), "angles_deg": angles, "time_s": np.array(time_s)}
    assert angle_plot(poses) == b"png"
    rows = drawn[0].axes
    for axes, joint, says in zip(
        rows,
        ("hip_x", "knee_x", "shoulder_x", "elbow_x"),
        ("hip, forwards", "knee", "shoulder, forwards", "elbow"),
        strict=True,
    ):
        assert axes.get_ylabel() == f"{says}, deg"
        for (x, y), side in zip(curves(axes), "lr", strict=True):
            assert x == list(time_s)
            assert y == pytest.approx(
                [ANGLE_NAMES.index(f"{side}_{joint}") + 0.1 * n for n in range(len(time_s))]
            )
    amber, blue = (line.get_color() for line in rows[0].get_lines()[:2])
    assert amber[0] - amber[2] > 0.4
    assert blue[2] - blue[0] > 0.4, "as on the pages and in overlays"
    assert [text.get_text() for text in rows[0].get_legend().get_texts()] == ["left", "right"]
    assert rows[-1].get_xlim() == pytest.approx((time_s[0] if time_s else 0.0, until_s))
    assert rows[-1].get_xlabel() == "time, s"
