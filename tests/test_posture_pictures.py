"""The pictures of a posture report, held against a matrix that is counted by hand."""

from pathlib import Path
from typing import Any

import pytest
from drawing import figures_drawn

pytest.importorskip("matplotlib", reason="pip install 'tritrack[report]'")

from lab.postures import posture_pictures
from lab.postures.posture_pictures import draw_confusion, draw_worst

RESULT: dict[str, Any] = {
    "confusion": {"counts": [[3, 1, 0], [0, 0, 2]], "named": ["squat", "kick", ""]},
    "postures": {"squat": {}, "kick": {}},
}


def test_the_matrix_has_a_row_for_what_was_shown_and_its_counts_in_its_cells(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (drawn,) = drawings(monkeypatch, RESULT, tmp_path)
    (axes,) = drawn.axes
    (image,) = axes.get_images()
    assert image.get_array().tolist() == [[0.75, 0.25, 0.0], [0.0, 0.0, 1.0]]
    assert image.get_clim() == (0.0, 1.3)
    assert [each.get_text() for each in axes.get_xticklabels()] == ["squat", "kick", "no name"]
    assert [each.get_rotation() for each in axes.get_xticklabels()] == [90.0] * 3
    assert [each.get_text() for each in axes.get_yticklabels()] == ["squat", "kick"]
    texts = {each.get_position(): each.get_text() for each in axes.texts}
    assert texts == {(0, 0): "3", (1, 0): "1", (2, 1): "2"}
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("named", "shown")
    assert axes.get_title() == "the default recogniser"
    assert tuple(drawn.get_size_inches()) == pytest.approx((2.9 + 0.72, 2.5 + 0.72))


def drawings(patch: pytest.MonkeyPatch, result: dict[str, Any], folder: Path) -> list[Any]:
    drawn = figures_drawn(patch)
    draw_confusion(result, "the default recogniser", folder / "confusion.png")
    assert (folder / "confusion.png").read_bytes() == b"png"
    return drawn


def test_a_posture_that_nobody_showed_has_an_empty_row(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    counts = {"counts": [[0, 0, 0], [0, 1, 0]], "named": ["squat", "kick", ""]}
    (drawn,) = drawings(monkeypatch, {**RESULT, "confusion": counts}, tmp_path)
    assert drawn.axes[0].get_images()[0].get_array().tolist() == [[0, 0, 0], [0, 1, 0]]


def test_each_of_the_worst_clips_has_a_strip_and_runs_have_none(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[Any] = []

    def strip(clip: Path, mode: Any, _: Any) -> bytes:
        asked.append((clip, mode))
        return clip.name.encode()

    monkeypatch.setattr(posture_pictures, "contact_strip", strip)
    run = tmp_path / "run"
    run.mkdir()
    (run / "poses.npz").write_bytes(b"")
    worst: list[dict[str, Any]] = [{"clip": clip} for clip in ("clips/a", "", str(run), "clips/b")]
    draw_worst({"worst": worst}, "paper", tmp_path, "worst_default")
    assert [one.get("picture") for one in worst] == [
        "worst_default_01.png",
        None,
        None,
        "worst_default_04.png",
    ]
    assert asked == [(Path("clips/a"), "paper"), (Path("clips/b"), "paper")]
    assert (tmp_path / "worst_default_04.png").read_bytes() == b"b"
