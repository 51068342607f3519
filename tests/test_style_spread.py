"""The spread of styles in clips' notes, and that the performers of an experiment differ enough."""

import json
from pathlib import Path

import numpy as np

from lab.posture_models.evaluation import Recording
from lab.postures.style_spread import spread_of
from synth.person.people import STYLE_RANGES, person, take_style

LEARNT, TESTED = 100, 900
"""Seeds of the two sets of the experiment."""


def noted(folder: Path, **notes: object) -> Recording:
    folder.mkdir()
    (folder / "meta.json").write_text(json.dumps(notes))
    return Recording("ann", "squat", np.empty((0, 20)), str(folder))


def test_the_least_and_the_largest_are_told(tmp_path: Path) -> None:
    given = [
        noted(tmp_path / "a", style={"amp": 0.9, "lean": -1}),
        noted(tmp_path / "b", style={"amp": 1.1, "lean": 3, "word": "odd"}),
        noted(tmp_path / "c"),
        Recording("ann", "squat", np.empty((0, 20)), str(tmp_path / "nowhere")),
    ]
    assert spread_of(given) == {"amp": (0.9, 1.1), "lean": (-1.0, 3.0)}


def test_both_dozens_move_at_least_as_differently_as_the_development_clips(data_dir: Path) -> None:
    """Amplitude, speed, phase, lean, carriage and all else that a style has."""
    clips = sorted((data_dir / "dev").glob("*/meta.json"))
    theirs = spread_of([Recording("", "", np.empty((0, 20)), str(path.parent)) for path in clips])
    for seed in (LEARNT, TESTED):
        dozen = [person(seed * 12 + i) for i in range(12)]
        takes = [take_style(one.style, np.random.default_rng(one.seed)) for one in dozen]
        for name in STYLE_RANGES:
            ours = np.ptp([getattr(style, name) for style in takes])
            assert ours >= np.ptp(theirs[name]), (seed, name)
