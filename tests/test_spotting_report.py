"""What is told of performances found in streams, held against a case worked by hand."""

from pathlib import Path

import numpy as np
import pytest
from acting import perform
from rich.console import Console

from lab.posture_models.evaluation import wilson
from lab.posture_models.learning import train
from lab.posture_models.streams import Act, Found
from lab.postures import spotting_report
from lab.postures.spotting_report import evaluate_spotting
from lab.training.training import TrainingError
from recognizer.performance_judge import Event

QUIET = Console(quiet=True)
FALSE = (Event("squat", 12, 41, 1.0, 1), Event("bow", 99, 120, 1.0, 1))
RESULTS = [
    Found("one", 900, 3, (15, 30), (Act("kick", 400, 430),), FALSE),
    Found("two", 900, 2, (0, 45), (), ()),
]
"""A minute each at 15 frames a second; four of five are found, 0, 1, 2 and 3 s after their end."""


@pytest.fixture
def result(monkeypatch: pytest.MonkeyPatch) -> list[Found]:
    """What is found, instead of a model's own findings."""
    given = [*RESULTS]
    monkeypatch.setattr(
        spotting_report, "load", lambda _: train({"squat": [perform("squat", 0)] * 3})
    )
    monkeypatch.setattr(spotting_report, "streams", lambda *_: [None] * len(given))
    monkeypatch.setattr(spotting_report, "found", lambda *_: given.pop(0))
    return given


def test_shares_delays_and_false_alarms_are_counted_over_all_streams(
    result: list[Found], tmp_path: Path
) -> None:
    report = evaluate_spotting([], tmp_path / "new" / "out", None, None, QUIET)
    assert (report["found"], report["performances"], report["share"]) == (4, 5, 0.8)
    assert report["interval_95"] == wilson(4, 5)
    assert report["minutes"] == pytest.approx(2.0)
    assert report["false_alarms_a_minute"] == pytest.approx(1.0)
    assert report["latency_median_s"] == pytest.approx(1.5)
    assert report["latency_p90_s"] == pytest.approx(np.percentile([0.0, 1.0, 2.0, 3.0], 90))
    assert [one["name"] for one in report["streams"]] == ["one", "two"]
    low, high = wilson(4, 5)
    assert report["table"].splitlines() == [
        "one: missed kick at 400",
        "one: false squat at 12",
        "one: false bow at 99",
        f"found and named: 4/5 = 80.0% (95 % interval {low:.1%} to {high:.1%}), "
        "told 1.50 s after their end (90 %: 2.70 s)",
        "false alarms: 2 in 2.0 minutes, 1.00 a minute",
    ]
    written = (tmp_path / "new" / "out" / "spotting.json").read_text()
    assert '"false_alarms": 2' in written


def test_streams_in_which_nothing_is_performed_or_found_have_a_report_too(
    result: list[Found], tmp_path: Path
) -> None:
    result[:] = [Found("empty", 0, 0, (), (), ())]
    report = evaluate_spotting([], tmp_path, None, None, QUIET)
    assert (report["share"], report["false_alarms_a_minute"]) == (0.0, 0.0)
    assert report["latency_median_s"] is report["latency_p90_s"] is None
    assert "told" not in report["table"]


def test_a_file_where_the_report_should_lie_and_the_papers_model_are_named(
    result: list[Found], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(TrainingError, match=r"cannot write .*file.*another --out"):
        evaluate_spotting([], tmp_path / "file" / "out", None, None, QUIET)
    papers = train({name: [perform(name, n) for n in range(3)] for name in ("squat",)}, "paper")
    monkeypatch.setattr(spotting_report, "load", lambda _: papers)
    with pytest.raises(TrainingError, match=r"mine\.npz is the paper's recogniser"):
        evaluate_spotting([], tmp_path, Path("mine.npz"), None, QUIET)
