"""Measures of who is who, held against small cases worked by hand."""

import numpy as np
import pytest
from numpy.typing import NDArray

from common.npz_file import Arrays
from lab.accuracy.accuracy import JOINTS, Mismatch
from lab.accuracy.identity import (
    GATE_M,
    Counts,
    Presence,
    assigned,
    counts,
    figures,
    gaps_of,
    own_numbers,
    presences,
)

NAN = float("nan")


def truth_of(at_m: list[list[float]], absent: tuple[tuple[int, int], ...] = ()) -> Arrays:
    """People who stand at places on a line, frame by frame, NaN where they do not exist; `absent`
    are frames and people who are there but not to be tracked."""
    people = len(at_m[0])
    joints_m = joints_at(np.array(at_m).reshape(-1))
    present = np.isfinite(np.array(at_m))
    for frame, who in absent:
        present[frame, who] = False
    return {
        "joints3d": joints_m,
        "joint_names": np.array(JOINTS),
        "present": present.reshape(-1),
        "frame": np.repeat(np.arange(len(at_m)), people),
        "person": np.tile(np.arange(people), len(at_m)),
        "frames_cam1": np.arange(len(at_m)),
    }


def joints_at(at_m: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.arange(12.0)[None, :, None] * [0.0, 0.1, 0.0] + at_m[:, None, None] * [1.0, 0.0, 0.0]


def poses_of(*bodies: tuple[int, int, float]) -> Arrays:
    """Bodies by frame, number and place."""
    frame, number, at_m = (np.array(values) for values in zip(*bodies, strict=True))
    return {
        "frame": frame,
        "person": number,
        "joints_m": joints_at(at_m.astype(float)),
        "joint_names": np.array(JOINTS),
    }


def counted(poses: Arrays, truth: Arrays) -> Counts:
    return counts(gaps_of(poses, truth))


STAY = truth_of([[0.0, 2.0]] * 4)
"""Two people, two metres apart, four frames."""


def test_who_leaves_and_comes_back_is_there_twice_each_time_by_a_number() -> None:
    """Ten frames; the second person is away in frames 3 to 6, and comes back as 9; the first is
    matched in nine frames, and not looked for in one, which is no absence."""
    truth = truth_of([[0.0, 2.0]] * 10, absent=((8, 0), *((frame, 1) for frame in range(3, 7))))
    poses = poses_of(
        *((frame, 4, 0.0) for frame in range(10) if frame != 5),
        *((frame, 2, 2.0) for frame in range(3)),
        *((frame, 9, 2.0) for frame in range(8, 10)),
    )
    assert presences(gaps_of(poses, truth), 2) == [
        Presence(0, 0, 9, 4, 8 / 9),
        Presence(1, 0, 2, 2, 1.0),
        Presence(1, 7, 9, 9, 2 / 3),
    ]
    assert [one.last for one in presences(gaps_of(poses, truth), 5)] == [9, 9]


def test_who_has_no_body_is_there_without_a_number() -> None:
    found = presences(gaps_of(poses_of((0, 1, 7.0)), STAY), 2)
    assert found == [Presence(0, 0, 3, None, 0.0), Presence(1, 0, 3, None, 0.0)]


def test_people_who_are_tracked_exactly_are_perfect_whatever_their_numbers() -> None:
    told = counted(poses_of(*((i, n, x) for i in range(4) for n, x in ((7, 0.0), (3, 2.0)))), STAY)
    assert told == Counts(4, 8, 8, 8, 0, 0.0, 0, 8, 8.0, 8)
    found = figures([told])
    assert [found[name] for name in ("idf1", "assa", "mota", "kept")] == [1.0] * 4
    assert (found["switches"], found["misses"], found["false"], found["matched_mm"]) == (0,) * 4


def test_one_switch_worked_by_hand() -> None:
    """Numbers 0 and 1 are exchanged in the last frame of four, 0.1 m off throughout.

    MOTA: 8 due, no miss, no false body, 2 switches (each person's number changes): 1 - 2/8.
    IDF1: each person has their number in 3 of 4 frames: 2 * 6 / (8 + 8).
    AssA: of each person's 4 matches, 3 with the number that has 3 in common with them of 4 + 4 - 3
    frames, and 1 with the one that has 1 of 4 + 4 - 1: (6 * 3/5 + 2 * 1/7) / 8.
    """
    bodies = [(i, n, 2.0 * n + 0.1) for i in range(3) for n in (0, 1)]
    told = figures([counted(poses_of(*bodies, (3, 0, 2.1), (3, 1, 0.1)), STAY)])
    assert told["switches"] == 2
    assert told["mota"] == pytest.approx(0.75)
    assert told["idf1"] == pytest.approx(0.75)
    assert told["assa"] == pytest.approx((6 * 3 / 5 + 2 / 7) / 8)
    assert told["matched_mm"] == pytest.approx(100.0)
    assert told["kept"] == 0.0


def test_misses_false_bodies_and_invented_frames_worked_by_hand() -> None:
    """Person 1 is missed twice; number 9 is a ghost far away in two frames, beyond the gate in a
    third: 8 due, 2 misses + 1 in the third frame, 3 false, none switched."""
    bodies = [(i, 0, 0.0) for i in range(4)] + [(0, 1, 2.0)]
    ghosts = [(1, 9, 8.0), (2, 9, 8.0), (3, 9, 2.0 + GATE_M + 0.01)]
    told = counted(poses_of(*bodies, *ghosts), STAY)
    assert (told.due, told.bodies, told.matches, told.switches, told.invented) == (8, 8, 5, 0, 3)
    found = figures([told])
    assert (found["misses"], found["false"], found["invented"]) == (3, 3, 0.75)
    assert found["mota"] == pytest.approx(1 - 6 / 8)
    assert found["idf1"] == pytest.approx(2 * 5 / 16)
    assert found["assa"] == pytest.approx((4 * 1.0 + 1 * 1 / (4 + 1 - 1)) / 5)


def test_a_number_that_is_back_after_a_gap_is_no_switch_and_another_is() -> None:
    alone = truth_of([[0.0]] * 4)
    assert counted(poses_of((0, 5, 0.0), (3, 5, 0.0)), alone).switches == 0
    assert counted(poses_of((0, 5, 0.0), (3, 6, 0.0)), alone).switches == 1
    back = poses_of((0, 5, 0.0), (1, 6, 0.0), (2, 5, 0.0), (3, 5, 0.0))
    assert counted(back, alone).switches == 2


def test_a_match_is_kept_while_it_is_within_the_gate_even_where_another_is_nearer() -> None:
    """Two people 0.2 m apart: in frame 1 the bodies stand crosswise, but within the gate."""
    close = truth_of([[0.0, 0.2]] * 2)
    told = counted(poses_of((0, 0, 0.0), (0, 1, 0.2), (1, 0, 0.2), (1, 1, 0.0)), close)
    assert (told.matches, told.switches) == (4, 0)
    assert told.distance_m == pytest.approx(0.4)


def test_as_many_match_as_can_then_with_the_least_distance() -> None:
    inf = np.inf
    assert [*map(list, assigned(np.array([[0.01, 0.2], [0.1, inf]])))] == [[0, 1], [1, 0]]
    assert [*map(list, assigned(np.array([[0.2, 0.1], [0.1, 0.2]])))] == [[0, 1], [1, 0]]
    assert [*map(list, assigned(np.full((2, 3), inf)))] == [[], []]


def test_the_gate_is_the_mean_distance_of_the_joints() -> None:
    truth, poses = truth_of([[0.0]]), poses_of((0, 0, 0.0))
    poses["joints_m"][0, 0, 0] += 12 * 0.29
    assert counted(poses, truth).matches == 1
    poses["joints_m"][0, 0, 0] += 12 * 0.02
    assert counted(poses, truth).matches == 0


def test_bodies_of_those_who_are_not_to_be_tracked_are_left_out() -> None:
    """Who is out of all pictures may be tracked or not; a ghost elsewhere counts all the same."""
    leaving = truth_of([[0.0, 2.0]] * 2, absent=((1, 1),))
    bodies = [(0, 0, 0.0), (0, 1, 2.0), (1, 0, 0.0)]
    for more in ([], [(1, 1, 2.0)]):
        told = counted(poses_of(*bodies, *more), leaving)
        assert (told.due, told.bodies, told.matches, told.invented) == (3, 3, 3, 0)
    assert counted(poses_of(*bodies, (1, 1, 5.0)), leaving).invented == 1
    near = truth_of([[0.0, 0.1]], absent=((0, 1),))
    assert counted(poses_of((0, 0, 0.09)), near).matches == 0, "it is the other's"


def test_hotas_matches_are_those_that_match_often() -> None:
    """Number 6 is nearer in one frame of three, but number 5 is there in all: 3 matches of one
    number, whose association is 3 of 3."""
    bodies = [(i, 5, 0.1) for i in range(3)] + [(1, 6, 0.0)]
    told = counted(poses_of(*bodies), truth_of([[0.0]] * 3))
    assert (told.associated, told.aligned) == (3.0, 3)


def test_a_number_is_not_theirs_in_frames_in_which_they_are_not_to_be_tracked() -> None:
    """In frame 1 number 1 is on person 0; person 1 is near, but leaving."""
    truth = truth_of([[0.0, 2.0], [0.0, 0.1]], absent=((1, 1),))
    assert counted(poses_of((0, 1, 2.0), (1, 1, 0.01)), truth).identified == 1


def test_an_empty_room_and_bodies_without_joints_are_nothing() -> None:
    truth = truth_of([[NAN, NAN], [0.0, NAN]])
    told = counted(poses_of((0, 0, NAN), (1, 0, 0.0), (7, 0, 0.0), (-1, 0, 0.0)), truth)
    assert (told.due, told.bodies, told.matches, told.invented) == (1, 1, 1, 0)
    nothing = figures([counted(poses_of((0, 0, NAN)), truth_of([[NAN]]))])
    assert np.isnan([nothing["idf1"], nothing["mota"], nothing["assa"]]).all()


def test_frames_of_the_video_are_those_of_the_truth_by_its_own_list() -> None:
    truth = truth_of([[0.0], [1.0], [2.0]])
    truth["frames_cam1"] = np.array([0, 2])
    assert counted(poses_of((0, 0, 0.0), (1, 0, 2.0)), truth).matches == 2


def test_runs_and_truths_of_one_person_need_no_numbers() -> None:
    truth, poses = truth_of([[0.0]] * 2), poses_of((0, 0, 0.0), (1, 0, 0.0))
    del truth["person"], truth["frame"], poses["person"]
    assert figures([counted(poses, truth)])["idf1"] == 1.0


def test_clips_add_up() -> None:
    good = counted(poses_of((0, 0, 0.0)), truth_of([[0.0]]))
    bad = counted(poses_of((0, 0, 9.0)), truth_of([[0.0]] * 3))
    both = figures([good, bad])
    assert (both["clips"], both["misses"], both["false"]) == (2, 3, 1)
    assert both["idf1"] == pytest.approx(2 / 6)
    assert both["mota"] == pytest.approx(0.0)
    assert both["kept"] == 1.0


def test_each_person_has_the_number_that_is_theirs_most_often() -> None:
    bodies = [(i, 4, 2.0) for i in range(3)] + [(i, 6, 0.0) for i in range(2)] + [(3, 6, 2.0)]
    gaps = gaps_of(poses_of(*bodies), STAY)
    who, at = own_numbers(gaps)
    assert dict(zip(who.tolist(), gaps.numbers[at].tolist(), strict=True)) == {0: 6, 1: 4}


def test_a_run_of_other_shapes_is_refused() -> None:
    poses = poses_of((0, 0, 0.0))
    with pytest.raises(Mismatch, match="joints_m is"):
        gaps_of({**poses, "frame": np.arange(2)}, STAY)
