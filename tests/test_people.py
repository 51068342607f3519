"""Invented people: as different from each other as those of the development clips, and stable."""

import json
from pathlib import Path

import numpy as np
import pytest

from synth.person.people import MEASURE_NAMES, STYLE_RANGES, measure_vector, person, take_style
from synth.person.skeleton import JOINTS, rest_origins

DOZEN = [person(seed) for seed in range(12)]


def test_a_seed_is_one_person_and_another_seed_another() -> None:
    assert person(5) == person(5)
    assert len({measure_vector(someone).tobytes() for someone in DOZEN}) == 12
    assert len({someone.style for someone in DOZEN}) == 12
    assert len({someone.look for someone in DOZEN}) == 12


def test_a_body_is_as_tall_as_its_parts() -> None:
    """Sole to ankle, knee, hip, neck and crown: no length is lost."""
    for someone in DOZEN:
        m = someone.measures
        parts = ("ankle_height_m", "shin_m", "thigh_m", "torso_m", "neck_to_headtop_m")
        assert sum(m[name] for name in parts) == pytest.approx(m["stature_m"])
        at = rest_origins(m)
        assert at["head"][1] - at["pelvis"][1] == pytest.approx(m["torso_m"])


def test_proportions_are_human() -> None:
    """Segment shares of the stature of adults (Drillis and Contini 1966): 0.186 for the upper
    arm and 0.146 for the forearm from the acromion, 0.245 and 0.246 for thigh and shank."""
    for someone in DOZEN:
        m, stature = someone.measures, someone.measures["stature_m"]
        assert 0.14 < m["upper_arm_m"] / stature < 0.19
        assert 0.125 < m["forearm_m"] / stature < 0.16
        assert 0.235 < m["thigh_m"] / stature < 0.265
        assert 0.225 < m["shin_m"] / stature < 0.255
        assert m["waist_halfdepth_m"] < m["waist_halfwidth_m"]


def test_a_dozen_differ_at_least_as_much_as_the_filmed_three(data_dir: Path) -> None:
    """Spread (largest minus smallest) of every measure, against the performers r01, r04, r07."""
    filmed = {}
    for meta in sorted((data_dir / "dev").glob("*_01_*/meta.json")):
        notes = json.loads(meta.read_text())
        filmed[notes["performer"]] = notes["measures"]
    assert len(filmed) == 3
    ours = np.ptp([measure_vector(someone) for someone in DOZEN], axis=0)
    for name, spread in zip(MEASURE_NAMES, ours, strict=True):
        theirs = np.ptp([measures[name] for measures in filmed.values()])
        assert spread >= theirs, name


def test_a_dozen_move_at_least_as_differently_as_the_filmed_three(data_dir: Path) -> None:
    styles = [
        json.loads(meta.read_text())["style"]
        for meta in sorted((data_dir / "dev").glob("*_01_*/meta.json"))
    ]
    for name in STYLE_RANGES:
        ours = np.ptp([getattr(someone.style, name) for someone in DOZEN])
        assert ours >= np.ptp([style[name] for style in styles]), name


def test_takes_of_one_person_are_more_alike_than_people() -> None:
    """A take stays within an eighth of the range of people, and no two takes are the same."""
    someone = DOZEN[0]
    takes = [take_style(someone.style, np.random.default_rng(i)) for i in range(20)]
    assert len(set(takes)) == 20
    for name, (low, high) in STYLE_RANGES.items():
        departures = [abs(getattr(t, name) - getattr(someone.style, name)) for t in takes]
        assert 0 < max(departures) <= (high - low) / 8
        assert all(low <= getattr(t, name) <= high for t in takes)


def test_there_are_twenty_joints_as_in_the_filmed_truth(data_dir: Path) -> None:
    truth = next((data_dir / "dev").glob("*/truth.npz"))
    with np.load(truth) as arrays:
        assert tuple(arrays["joint_names"].tolist()) == JOINTS
