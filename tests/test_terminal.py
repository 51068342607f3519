"""What a person reads while a command works."""

import io
import json

import pytest
from rich.console import Console

from runtime.terminal import PROGRESS, bar, by_pass, by_share


def test_a_bar_moves_with_the_frames_of_the_one_video_that_there_is() -> None:
    with bar(Console(quiet=True)) as progress:
        seen = []
        for video, tell in by_share(progress, ["dance.mp4"], "following"):
            assert video == "dance.mp4"
            for frame in range(1, 5):
                tell(frame / 4)
                seen.append(progress.tasks[0].percentage)
    assert seen == [25.0, 50.0, 75.0, 100.0]


def test_a_bar_moves_with_each_of_several_even_if_nothing_is_told_of_them() -> None:
    with bar(Console(quiet=True)) as progress:
        steps = [
            (thing, progress.tasks[0].percentage) for thing, _ in by_share(progress, "abcd", "")
        ]
    assert steps == [("a", 0.0), ("b", 25.0), ("c", 50.0), ("d", 75.0)]
    assert progress.finished


def test_a_bar_moves_with_the_frames_of_every_pass_over_a_video() -> None:
    with bar(Console(quiet=True)) as progress:
        seen = []
        for _, begun in by_pass(progress, ["dance.mp4", "walk.mp4"], ("cutting out", "drawing")):
            for name in ("cutting out", "drawing"):
                tell = begun(name)
                for share in (0.5, 1.0):
                    tell(share)
                    seen.append((progress.tasks[0].description, progress.tasks[0].percentage))
    assert seen[:4] == [
        *(("cutting out", 12.5), ("cutting out", 25.0)),
        *(("drawing", 37.5), ("drawing", 50.0)),
    ]
    assert seen[-1] == ("drawing", 100.0)


def test_a_video_that_fails_in_its_first_pass_is_over() -> None:
    with bar(Console(quiet=True)) as progress:
        for _, begun in by_pass(progress, "ab", ("cutting out", "drawing")):
            begun("cutting out")(0.5)
    assert progress.finished


def test_a_program_that_started_the_command_is_given_its_progress_as_lines(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first word of each pass at once; then five lines a second at most."""
    monkeypatch.setenv(PROGRESS, "lines")
    said = io.StringIO()
    with bar(Console(file=said)) as progress:
        for _, begun in by_pass(progress, ["dance.mp4"], ("cutting out", "drawing")):
            for name in ("cutting out", "drawing"):
                tell = begun(name)
                for frame in range(1, 101):
                    tell(frame / 100)
    lines = [line.removeprefix("progress ") for line in said.getvalue().splitlines()]
    told = [json.loads(line) for line in lines]
    assert [each["what"] for each in told[:2]] == ["cutting out", "drawing"]
    assert told[0] == {"what": "cutting out", "done": 0.01, "of": 2}
    assert told[1] == {"what": "drawing", "done": 1.01, "of": 2}
    assert len(told) < 10
