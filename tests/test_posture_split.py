"""Who is learnt from and named in the experiment, and the sizes that are swept."""

import pytest
from acting import perform
from rich.console import Console

from lab.posture_models.evaluation import Recording
from lab.postures import posture_split
from lab.postures.posture_split import EACH_IN_TURN, Job, jobs_of, judged, sweep_of
from lab.training.training import TrainingError
from recognizer.codebook import LearningError

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


def test_performers_are_named_by_patterns_with_blanks_between_them() -> None:
    learnt, tested = posture_split.parts_of(of("a1", "a2", "b1", "c"), "a? , c:b*") or ([], [])
    assert {one.performer for one in learnt} == {"a1", "a2", "c"}
    assert {one.performer for one in tested} == {"b1"}
    for split in ("a1", "a1:", ":b1", "a1:zoe", "a1,b1"):
        with pytest.raises(TrainingError, match=f"the split '{split}' must be leave-one-performer"):
            posture_split.parts_of(of("a1", "b1"), split)
    with pytest.raises(TrainingError, match="one performer alone: none is left to learn from"):
        posture_split.parts_of(of("a1"), EACH_IN_TURN)
    assert posture_split.parts_of(of("a1", "a2"), EACH_IN_TURN) is None


def test_each_fold_of_a_sweep_is_answered_in_each_size() -> None:
    jobs = list(sweep_of(of("a", "b"), EACH_IN_TURN))
    assert len(jobs) == 2 * 5 * 6
    assert {job.recognizer for job in jobs} == {"paper"}
    assert jobs[0].group == "16 symbols, 3 states"
    assert (jobs[0].sizes.symbols, jobs[0].sizes.states) == (16, 3)
    assert people(jobs[0]) == ({"b"}, {"a"})
    assert people(jobs[-1]) == ({"a"}, {"b"})


def test_a_split_that_tests_no_posture_that_others_show_is_refused_as_a_whole() -> None:
    squat, arm, wave = of("a")
    shared = [squat, arm, wave._replace(performer="b"), squat._replace(performer="b")]
    posture_split.refuse_in_vain(shared, EACH_IN_TURN)
    posture_split.refuse_in_vain(shared, "a:b")
    with pytest.raises(TrainingError, match="none of the postures that are tested is shown by"):
        posture_split.refuse_in_vain(shared[:3], "a:b")
    both = [*shared, arm._replace(performer="c"), wave._replace(performer="c")]
    posture_split.refuse_in_vain(both, EACH_IN_TURN)
    with pytest.raises(LearningError, match="a: in training and in test"):
        posture_split.refuse_in_vain(shared, "a,b:a")
