"""What is typed for reports reaches what makes them."""

from pathlib import Path

import pytest
from typed import instead, typed

from tritrack.commands.clip_commands import track
from tritrack.commands.report_commands import compare, report

MADE = {"reports": {"runs/walk": {"report": "runs/walk/report.html", "overlay": "overlay.mp4"}}}


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_runs_are_reported_and_the_page_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    done = instead(monkeypatch, "tritrack.reporting.reporting.report_all", MADE)
    assert "open runs/walk/report.html" in typed(report, "runs/walk").output
    assert done.last[0] == [Path("runs/walk")]


def test_track_reports_where_it_is_asked_to(monkeypatch: pytest.MonkeyPatch) -> None:
    facts = {"clips": {"walk": {"believed": 0.9, "followed": 0.9}}}
    instead(monkeypatch, "runtime.offline.batch.track_all", facts)
    done = instead(monkeypatch, "tritrack.reporting.reporting.report_all", MADE)
    assert "report" not in typed(track, "walk").output
    assert done.given == []
    assert "open runs/walk/report.html" in typed(track, "walk", "--report").output
    assert done.last[0] == [Path("runs/walk")]


def test_two_runs_are_compared_and_their_differences_said(monkeypatch: pytest.MonkeyPatch) -> None:
    facts = {"file": "a/compare.html", "lines": ["joints 9 mm apart"], "people": []}
    done = instead(monkeypatch, "tritrack.reporting.comparing.compare_runs", facts)
    said = typed(compare, "a", "b").output
    assert said.splitlines() == ["joints 9 mm apart", "open a/compare.html"]
    assert done.last == (Path("a"), Path("b"))
