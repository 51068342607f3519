"""Who is learnt from and named in the experiment, and the sizes that are swept."""

import pytest
from acting import perform
from rich.console import Console

from recognizer.evaluation import Recording
from tritrack.postures import posture_split
from tritrack.postures.posture_split import EACH_IN_TURN, Job, jobs_of, judged, sweep_of

QUIET = Console(quiet=True)


def of(*performers: str) -> list[Recording]:
    return [
        Recording(who, posture, perform(posture, number), f"clips/{who}_{posture}")
        for number, who in enumerate(performers)
        for posture in ("squat", "raise_right_lateral", "swing_both_backforth")
    ]


def people(job: Job) -> tuple[set[str], set[str]]:
    learnt, tested = job.fold
    return {one.performer for one in learnt}, {one.performer for one in tested}


def test_the_headline_is_other_people_and_beside_it_each_of_them_in_turn() -> None:
    jobs = list(jobs_of(of("a1", "a2", "b1", "b2", "b3"), "a*:b*", "paper"))
    assert [job.group for job in jobs] == ["headline", *["within test"] * 3]
    assert people(jobs[0]) == ({"a1", "a2"}, {"b1", "b2", "b3"})
    assert people(jobs[1]) == ({"b2", "b3"}, {"b1"})
    assert {job.recognizer for job in jobs} == {"paper"}


def test_in_turn_everybody_is_tested_once() -> None:
    jobs = list(jobs_of(of("a", "b", "c"), EACH_IN_TURN, "default"))
    assert [people(job) for job in jobs] == [
        ({"b", "c"}, {"a"}),
        ({"a", "c"}, {"b"}),
        ({"a", "b"}, {"c"}),
    ]


def test_one_tested_performer_has_nobody_beside() -> None:
    assert len(list(jobs_of(of("a", "b"), "a:b", "default"))) == 1


def test_outcomes_come_in_one_order_and_with_their_clips() -> None:
    jobs = list(jobs_of(of("a", "b", "c"), EACH_IN_TURN, "default"))
    found = judged(jobs, QUIET)["headline"]
    assert found == judged(jobs[::-1], QUIET)["headline"]
    assert [one.performer for one in found] == sorted(one.performer for one in found)
    assert found[0].clip == "clips/a_raise_right_lateral"
    assert all((one.margin > 0) == (one.truth == one.named) for one in found)


def test_the_sweep_meets_the_papers_sizes(monkeypatch: pytest.MonkeyPatch) -> None:
    """16 to 256 symbols, 3 to 8 states; 64 and 5 give what the headline gives."""
    jobs = list(sweep_of(of("a", "b"), "a:b"))
    sizes = {(job.sizes.symbols, job.sizes.states) for job in jobs}
    assert sizes == {
        (symbols, states) for symbols in (16, 32, 64, 128, 256) for states in range(3, 9)
    }
    papers = [job for job in jobs if (job.sizes.symbols, job.sizes.states) == (64, 5)]
    headline = list(jobs_of(of("a", "b"), "a:b", "paper"))
    assert [*judged(papers, QUIET).values()] == [*judged(headline, QUIET).values()]
    small = [job for job in jobs if (job.sizes.symbols, job.sizes.states) == (16, 3)]
    assert len(judged(small, QUIET)[small[0].group]) == 3
    assert posture_split.swept(16, 3) == small[0].group
