"""What a person reads while a command works."""

from rich.console import Console

from tritrack.terminal import bar, by_share


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
