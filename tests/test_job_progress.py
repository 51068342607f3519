"""What a command's lines say of its progress."""

from tritrack.starting.job_progress import MOST_LETTERS, MOST_LINES, Progress, duration, step, words


def after(*lines: str) -> Progress:
    state = Progress()
    for line in lines:
        state = step(state, line)
    return state


def test_progress_lines_move_the_bar_and_others_are_kept() -> None:
    state = after(
        "warning: walk: dark\n", 'progress {"what": "posing", "done": 2.25, "of": 4}\n', "\n"
    )
    assert state.share == 2.25 / 4
    assert state.lines == ("warning: walk: dark",)
    assert words(state, 120, 90.0) == "posing (3 of 4): 30 of 120 frames, about 70 s left"


def test_no_time_is_guessed_of_a_beginning() -> None:
    state = after('progress {"what": "tracking", "done": 0.01, "of": 1}')
    assert words(state, 300, 5.0) == "tracking: 3 of 300 frames"
    assert words(Progress(), 300, 5.0) == "starting"
    done = after('progress {"what": "tracking", "done": 1.0, "of": 1}')
    assert words(done, 300, 5.0) == "tracking: 300 of 300 frames"


def test_what_is_no_progress_after_all_changes_nothing() -> None:
    for line in ("progress {", "progress 3", 'progress {"what": "x"}', "progress [1]"):
        assert after(line) == Progress()
    assert after('progress {"what": "x", "done": 7, "of": null}').share == 1.0


def test_the_first_page_that_is_named_is_the_commands_own() -> None:
    said = after(
        "the bus: tcp/127.0.0.1:7447", "the page: http://127.0.0.1:8123", "http://127.0.0.1:1"
    )
    assert said.address == "http://127.0.0.1:8123"
    assert said.bus == "tcp/127.0.0.1:7447"
    assert after("the page: http://127.0.0.1:8123").bus == ""
    assert after("the page is at http://127.0.0.1:81; Ctrl-C ends it").address[-3:] == ":81"
    assert after("http://example.org:80").address == ""


def test_the_last_fault_is_why_it_ended() -> None:
    said = after("error: one is bad", "more", "error: 2 of 2 clips could not be tracked")
    assert said.fault == "2 of 2 clips could not be tracked"
    assert after("all is well").fault == ""


def test_a_command_that_prints_without_end_is_kept_in_part() -> None:
    state = after(*(f"{n} " + "x" * 9999 for n in range(3 * MOST_LINES)))
    assert len(state.lines) == MOST_LINES
    assert state.lines[-1].startswith(f"{3 * MOST_LINES - 1} ")
    assert max(map(len, state.lines)) == MOST_LETTERS


def test_a_duration_is_as_round_as_a_guess() -> None:
    assert [duration(each) for each in (0.2, 42.4, 200.0, 8000.0)] == [
        *("1 s", "42 s", "3 min", "2 h"),
    ]
