"""The posture models, held against hmmlearn, a textbook forward algorithm and unseen people."""

import json
import math
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from acting import perform, performances, standing
from hmmlearn.hmm import CategoricalHMM, GaussianHMM

from common.body.body import ANGLE_INDEX, ANGLE_NAMES
from lab.posture_models.evaluation import Recording, folds, recognise
from lab.posture_models.learning import train
from recognizer.codebook import symbols
from recognizer.features import bearings, features
from recognizer.forward import forward
from recognizer.postures import (
    POSTURES,
    DensityModel,
    Recognizer,
    SymbolModel,
    Topology,
    log_likelihoods,
    name,
)

TOPOLOGIES: list[Topology] = ["left-right", "ergodic"]
RECOGNIZERS: list[Recognizer] = ["default", "paper"]


@pytest.fixture(scope="module", params=TOPOLOGIES)
def model(request: pytest.FixtureRequest) -> SymbolModel:
    learnt = train(performances(range(3)), "paper", request.param)
    assert isinstance(learnt, SymbolModel)
    return learnt


@pytest.fixture(scope="module", params=TOPOLOGIES)
def densities(request: pytest.FixtureRequest) -> DensityModel:
    learnt = train(performances(range(3)), "default", request.param)
    assert isinstance(learnt, DensityModel)
    return learnt


def scores_of(model: SymbolModel, observed: np.ndarray) -> np.ndarray:
    """Of symbols, by the compiled forward algorithm."""
    log_emission = np.log(model.emission).transpose(2, 0, 1)[observed]
    return np.asarray(forward(model.start, model.transition, log_emission))


def textbook_log_forward(
    start: np.ndarray, transition: np.ndarray, emission: np.ndarray, observed: list[int]
) -> float:
    """log P(O | lambda), one number at a time (Rabiner 1989, eqs. 19-21, in logarithms)."""

    def log(p: float) -> float:
        return math.log(p) if p > 0 else -math.inf

    def log_sum(terms: list[float]) -> float:
        top = max(terms)
        return top if top == -math.inf else top + math.log(sum(math.exp(t - top) for t in terms))

    states = range(len(start))
    alpha = [log(start[j]) + log(emission[j, observed[0]]) for j in states]
    for symbol in observed[1:]:
        alpha = [
            log_sum([alpha[i] + log(transition[i, j]) for i in states]) + log(emission[j, symbol])
            for j in states
        ]
    return log_sum(alpha)


def test_fifteen_postures_of_the_papers_five_movements() -> None:
    """P56."""
    assert len(POSTURES) == 15
    movements = {"walking", "arm_raising", "arm_swing", "squatting", "kicking"}
    assert set(Counter(POSTURES.values())) == movements


def test_fifteen_models_of_five_states_and_64_symbols(model: SymbolModel) -> None:
    """P57."""
    assert model.names == tuple(POSTURES)
    assert model.start.shape == (15, 5)
    assert model.transition.shape == (15, 5, 5)
    assert model.emission.shape == (15, 5, 64)


def test_every_row_is_a_distribution(model: SymbolModel) -> None:
    for rows in (model.start, model.transition, model.emission):
        assert (rows >= 0).all()
        assert rows.sum(axis=-1) == pytest.approx(1.0, abs=1e-12)


def test_left_right_states_stay_or_step_on_and_ergodic_ones_go_anywhere() -> None:
    """P57."""
    sequences = performances(range(1))
    chain = train(sequences, "paper", "left-right")
    allowed = np.eye(5, dtype=bool) | np.eye(5, k=1, dtype=bool)
    assert ((chain.transition > 0) == allowed).all()
    assert (chain.start == [1, 0, 0, 0, 0]).all()
    free = train(sequences, "paper", "ergodic")
    assert (free.start == 0.2).all()
    for transition in (chain.transition[:, allowed], free.transition):
        assert transition.min() > 0.9e-3  # no way is closed for want of data


def test_likelihood_is_that_of_hmmlearn_and_of_the_textbook(model: SymbolModel) -> None:
    """P57, to 1e-9."""
    observed = symbols(model.codebook, features(perform("squat", performer=9)))
    scores = scores_of(model, observed)
    for i in range(15):
        hmm = CategoricalHMM(5, n_features=64)
        hmm.startprob_, hmm.transmat_ = model.start[i], model.transition[i]
        hmm.emissionprob_ = model.emission[i]
        own = textbook_log_forward(
            model.start[i], model.transition[i], model.emission[i], observed.tolist()
        )
        assert scores[i] == pytest.approx(hmm.score(observed[:, np.newaxis]), abs=1e-9)
        assert scores[i] == pytest.approx(own, abs=1e-9)


def test_density_likelihood_is_that_of_hmmlearn(densities: DensityModel) -> None:
    """To 1e-9, of rows that the model knows and of such that no state expects."""
    for posture in ("squat", "walk_toward"):
        shown = bearings(perform(posture, performer=9))
        scores = list(log_likelihoods(densities, perform(posture, performer=9)).values())
        for i in range(15):
            hmm = GaussianHMM(5, "diag")
            hmm.startprob_, hmm.transmat_ = densities.start[i], densities.transition[i]
            hmm.means_, hmm.covars_ = densities.mean[i], densities.variance[i]
            assert scores[i] == pytest.approx(hmm.score(shown), rel=1e-12, abs=1e-9)


def test_a_state_knows_nobody_better_than_the_tracker_does() -> None:
    """One person who never varies still leaves room: 5.7 degrees in a direction."""
    still = {posture: [perform(posture, 1)] * 3 for posture in POSTURES}
    learnt = train(still, "default")
    assert isinstance(learnt, DensityModel)
    assert learnt.variance.min() >= np.radians(5.7) ** 2


def test_only_travel_tells_a_walk_from_a_walk_in_place() -> None:
    """The same limbs, one person moving on: the ten angles cannot part them, the densities do."""
    walk = [perform("walk_toward", i, frames=60) for i in range(4)]
    treadmill = [one.copy() for one in walk]
    for one in treadmill:
        one[:, 17:] = one[:1, 17:]
    shown = {"walk_toward": walk[:3], "walk_in_place": treadmill[:3]}
    model = train(shown, "default")
    assert name(model, walk[3]) == "walk_toward"
    assert name(model, treadmill[3]) == "walk_in_place"
    paper = train(shown, "paper")
    assert log_likelihoods(paper, walk[3]) == log_likelihoods(paper, treadmill[3])


def test_models_that_emit_anything_alike_score_by_length_alone(model: SymbolModel) -> None:
    """Worked by hand: P = 64^-n, whatever the states do."""
    indifferent = replace(model, emission=np.full((15, 5, 64), 1 / 64))
    scores = log_likelihoods(indifferent, perform("squat", 1, frames=1000))
    assert list(scores.values()) == pytest.approx([-1000 * math.log(64)] * 15, abs=1e-6)


def test_renaming_symbols_changes_no_score(model: SymbolModel) -> None:
    """P57."""
    order = np.random.default_rng(0).permutation(64)
    renamed = replace(model, codebook=model.codebook[order], emission=model.emission[:, :, order])
    for posture in POSTURES:
        angles_deg = perform(posture, performer=9)
        expected = log_likelihoods(model, angles_deg)
        assert log_likelihoods(renamed, angles_deg) == pytest.approx(expected, abs=1e-9)


def test_symbols_that_a_posture_never_showed_keep_its_likelihood_finite(
    model: SymbolModel,
) -> None:
    """P57: each model is shown all 64 symbols, most of which its training never met."""
    assert np.isfinite(scores_of(model, np.tile(np.arange(64), 20))).all()
    assert model.emission.min() > 0.9e-4  # one odd frame costs at most a factor of about 10 000


def test_unseen_symbols_are_likelier_the_nearer_they_lie_to_seen_ones() -> None:
    """What one person showed vouches for what the next one does a little differently."""
    sequences = performances(range(6))
    model = train(sequences, "paper")
    assert isinstance(model, SymbolModel)
    for i, posture in enumerate(POSTURES):
        shown = np.concatenate(
            [symbols(model.codebook, features(one)) for one in sequences[posture]]
        )
        unseen = np.setdiff1d(np.arange(64), shown)
        apart = np.linalg.norm(model.codebook[unseen, np.newaxis] - model.codebook[shown], axis=2)
        nearest, farthest = unseen[[apart.min(axis=1).argmin(), apart.min(axis=1).argmax()]]
        assert model.emission[i, :, nearest].sum() > 2 * model.emission[i, :, farthest].sum()


def test_the_likeliest_posture_is_named(model: SymbolModel) -> None:
    """P58."""
    angles_deg = perform("kick_left_side", performer=9)
    scores = log_likelihoods(model, angles_deg)
    assert name(model, angles_deg) == max(scores, key=lambda posture: scores[posture])


@pytest.mark.parametrize("recognizer", RECOGNIZERS)
def test_people_never_seen_are_recognised(recognizer: Recognizer) -> None:
    """Three performers learnt from, three others named: at least 40 of 45, where chance gives 3."""
    model = train(performances(range(3)), recognizer)
    named = [
        name(model, perform(posture, performer)) == posture
        for performer in (11, 12, 13)
        for posture in POSTURES
    ]
    assert sum(named) >= 40


def test_training_twice_gives_the_same_model_bit_for_bit() -> None:
    sequences = performances(range(1))
    fitted: dict[Recognizer, tuple[str, ...]] = {
        "paper": ("codebook", "transition", "emission"),
        "default": ("transition", "mean", "variance"),
    }
    for recognizer, arrays in fitted.items():
        first, again = (train(sequences, recognizer, seed=5) for _ in range(2))
        for array in arrays:
            assert getattr(first, array).tobytes() == getattr(again, array).tobytes()


def test_the_card_says_what_the_model_was_made_from() -> None:
    sequences = performances(range(2))
    sequences["squat"].append(np.full((30, 20), np.nan))
    card = train(sequences, "paper", "ergodic", seed=7, performers=["a", "b"]).card
    assert (card.recognizer, card.topology, card.seed) == ("paper", "ergodic", 7)
    assert card.performers == ("a", "b")
    assert set(card.sequences.values()) == {2}  # the one without a pose taught nothing
    assert card.frames == 15 * 2 * 40


def test_frames_without_a_pose_are_no_observation(model: SymbolModel) -> None:
    angles_deg = perform("squat", performer=9)
    gaps = np.insert(angles_deg, [0, 10, 40], np.nan, axis=0)
    assert log_likelihoods(model, gaps) == log_likelihoods(model, angles_deg)


def test_where_no_pose_was_seen_nothing_is_named(model: SymbolModel) -> None:
    nobody = np.full((40, 20), np.nan)
    assert name(model, nobody) == ""
    assert set(log_likelihoods(model, nobody).values()) == {0.0}


def test_a_posture_that_nobody_showed_is_refused_by_name() -> None:
    sequences = performances(range(1))
    sequences["squat"] = [np.full((40, 20), np.nan), standing(4)]
    with pytest.raises(ValueError, match="squat: none of 2 sequences has 5 frames with a pose"):
        train(sequences)


def paper_angles(joints_m: np.ndarray, names: list[str]) -> np.ndarray:
    """True joints as the paper's angles (C3, C4), (n, 17): the yaw from shoulders and hips."""
    joint = {name: joints_m[:, i].astype(np.float64) for i, name in enumerate(names)}
    left = joint["l_hip"] - joint["r_hip"] + joint["l_shoulder"] - joint["r_shoulder"]
    left = left * [1.0, 0.0, 1.0] / np.hypot(left[:, :1], left[:, 2:])
    axes = np.stack(
        [left, np.broadcast_to([0.0, 1.0, 0.0], left.shape), left[:, ::-1] * [-1, 0, 1]]
    )
    angles_deg = np.zeros((len(joints_m), len(ANGLE_NAMES)))

    def limb(upper: str, lower: str) -> np.ndarray:
        along = joint[lower] - joint[upper]
        unit = along / np.linalg.norm(along, axis=1)[:, np.newaxis]
        return np.asarray(np.einsum("anc,nc->an", axes, unit))

    for side in "rl":
        for at, upper, lower, end in (
            ("shoulder", "shoulder", "elbow", "wrist"),
            ("hip", "hip", "knee", "ankle"),
        ):
            x, y, z = near = limb(f"{side}_{upper}", f"{side}_{lower}")
            bend = np.arccos(
                np.clip((near * limb(f"{side}_{lower}", f"{side}_{end}")).sum(0), -1, 1)
            )
            sign = 1.0 if lower == "elbow" else -1.0
            angles_deg[:, ANGLE_INDEX[f"{side}_{at}_x"]] = np.degrees(np.arcsin(np.clip(z, -1, 1)))
            angles_deg[:, ANGLE_INDEX[f"{side}_{at}_z"]] = np.degrees(np.arctan2(-x, y)) % 360
            angles_deg[:, ANGLE_INDEX[f"{side}_{lower}_x"]] = sign * np.degrees(bend)
    return angles_deg


def dev_recordings(folder: Path) -> list[Recording]:
    """The moving part of each development clip, as true angles."""
    recordings = []
    for clip in sorted(folder.glob("r*")):
        meta = json.loads((clip / "meta.json").read_text())
        truth = np.load(clip / "truth.npz")
        moving = truth["phase"] == 3
        angles_deg = paper_angles(truth["joints3d"][moving], truth["joint_names"].tolist())
        angles_deg = np.pad(angles_deg, [(0, 0), (0, 3)])  # the paper's ten angles need no root
        recordings.append(Recording(meta["performer"], meta["posture"], angles_deg))
    return recordings


@pytest.mark.slow
def test_true_angles_of_unseen_people_reach_the_papers_rate(data_dir: Path) -> None:
    """P59: 332 of 360 or better; each of three people named by models of the other two."""
    people = folds(dev_recordings(data_dir / "dev"))
    outcomes = [one for others, own in people for one in recognise(others, own, "paper")]
    assert len(outcomes) == 45
    assert sum(one.named == one.truth for one in outcomes) / 45 >= 332 / 360
