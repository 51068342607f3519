"""A model is taught new postures: three takes are enough, and what it knew it still knows."""

from pathlib import Path

import numpy as np
import pytest
from acting import perform, performances

from lab.posture_models.learning import extended, train
from recognizer.model_file import load, save
from recognizer.postures import PER_POSTURE, POSTURES, PostureModel, Recognizer, name

KNOWN = [posture for posture in POSTURES if posture not in ("raise_right_lateral", "squat")]


@pytest.fixture(scope="module", params=["default", "paper"])
def known(request: pytest.FixtureRequest) -> PostureModel:
    """Thirteen postures by four people."""
    shown = performances(range(4))
    recognizer: Recognizer = request.param
    return train({posture: shown[posture] for posture in KNOWN}, recognizer, performers=["p0"])


def takes(posture: str, count: int, performer: int = 7) -> list[np.ndarray]:
    return [perform(posture, performer, take) for take in range(count)]


def test_three_takes_of_one_person_teach_a_posture(known: PostureModel) -> None:
    """Their further takes get the new name; the other postures keep theirs."""
    model = extended(known, {"raise_right_lateral": takes("raise_right_lateral", 3)})
    assert model.names == (*KNOWN, "raise_right_lateral")
    for take in (5, 6, 7, 8):
        assert name(model, perform("raise_right_lateral", 7, take)) == "raise_right_lateral"
    named = [name(model, perform(posture, 9)) == posture for posture in KNOWN]
    assert named == [name(known, perform(posture, 9)) == posture for posture in KNOWN]


def test_what_was_known_stays_bit_for_bit(known: PostureModel) -> None:
    model = extended(known, {"squat": takes("squat", 3)}, ["user"])
    for array in PER_POSTURE:
        if hasattr(known, array):
            assert np.array_equal(getattr(model, array)[: len(KNOWN)], getattr(known, array))
    assert model.card.sequences == {**known.card.sequences, "squat": 3}
    assert model.card.performers == ("p0", "user")


def test_a_posture_that_is_taught_again_is_replaced_in_its_place(known: PostureModel) -> None:
    """From now on a user's squat is what this model calls a walk in place."""
    model = extended(known, {"walk_in_place": takes("squat", 3)})
    assert model.names == known.names
    assert model.card.sequences["walk_in_place"] == 3
    assert name(model, perform("squat", 7, 5)) == "walk_in_place"


def test_a_taught_model_is_saved_as_any_other(known: PostureModel, tmp_path: Path) -> None:
    model = extended(known, {"squat": takes("squat", 3)})
    save(model, tmp_path / "m.npz")
    again = load(tmp_path / "m.npz", [*KNOWN, "squat"])
    assert again.card == model.card


def test_takes_in_which_nobody_moved_teach_nothing(known: PostureModel) -> None:
    with pytest.raises(ValueError, match="wave: none of 3 sequences has 5 frames with a pose"):
        extended(known, {"wave": [np.full((40, 20), np.nan)] * 3})


def test_the_card_counts_what_was_usable_posture_by_posture() -> None:
    """A sequence of five frames with a pose is learnt from, one of four is not."""
    whole = perform("squat", 0)
    gaps = np.full((3, 20), np.nan)
    five, four = (np.concatenate([gaps, whole[:n], gaps]) for n in (5, 4))
    given = {"squat": [whole, five, four], "kick_left_side": takes("kick_left_side", 2)}
    model = train(given, performers=["bob", "ann"], seed=3)
    card = model.card
    assert model.names == ("squat", "kick_left_side")
    assert card.sequences == {"squat": 2, "kick_left_side": 2}
    assert card.frames == len(whole) + 5 + sum(len(one) for one in given["kick_left_side"])
    assert (card.performers, card.seed) == (("bob", "ann"), 3)
    assert (card.recognizer, card.topology) == ("default", "ergodic")
    with pytest.raises(ValueError, match="bow: none of 2 sequences has 5 frames with a pose;"):
        train({"bow": [four, four]})


def test_frames_of_what_was_known_and_of_what_is_new_are_counted_together(
    known: PostureModel,
) -> None:
    new = takes("squat", 3)
    model = extended(known, {"squat": new})
    assert model.card.frames == known.card.frames + sum(map(len, new))
