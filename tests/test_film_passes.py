"""One camera's silhouettes made into bodies: the scale of all of a film, then the live steps."""

import sys
from collections.abc import Iterator, Sequence
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.bus.messages import Body, Report
from common.config.settings import Settings
from common.method import METHODS, Mode
from common.notes.notes import Note, Notes
from common.raster.silhouette_report import silhouette_report
from tritrack.offline.film_passes import FilmFacts, bodies_of

SIZE = (160, 120)
FEW = 10
"""Matches of a frame whose outline is enough; a stick body takes hundreds."""


@pytest.fixture(scope="module")
def silhouettes(clip: Path) -> list[Report]:
    """True silhouettes of somebody who raises an arm."""
    with np.load(clip / "truth.npz") as truth:
        masks = np.unpackbits(truth["mask_cam1"], axis=2)[:, :, : SIZE[0]].astype(np.bool_)
    return [silhouette_report(1, mask, n, n / 15) for n, mask in enumerate(masks)]


def posed(reports: list[Report], mode: Mode = "default", notes: Notes = Notes()) -> list[Body]:
    film = FilmFacts(Settings(mode=mode), METHODS[mode], 1, 1 / 15, None, notes)
    return list(bodies_of(reports, film).bodies)


def test_who_is_known_by_the_silhouette_is_not_fitted(
    silhouettes: list[Report], clip: Path
) -> None:
    """Shows 7: the search of the stick body took half of the time. Shows 3 holds all the same."""
    seen = [body for body in posed(silhouettes) if body.joints_m]
    assert len(seen) == sum(report.box is not None for report in silhouettes)
    assert np.mean([body.matches <= FEW for body in seen]) > 0.8
    with np.load(clip / "truth.npz") as truth:
        names = [str(name) for name in truth["joint_names"]]
        at = {name: truth["joints2d_cam1"][:, names.index(name)] for name in JOINT_NAMES}
    for name in ("head_top", "r_wrist", "l_ankle"):
        shown = np.array([body.joints_px[0][JOINT_NAMES.index(name)] for body in seen])
        true = at[name][[body.frame for body in seen]]
        tall = np.ptp([at["head_top"][-1][1], at["l_ankle"][-1][1]])
        assert np.linalg.norm(shown - true, axis=1).mean() < 0.06 * tall


def test_the_thesis_fits_every_frame(silhouettes: list[Report]) -> None:
    """T10 to T18: as printed, nothing is proposed."""
    some = silhouettes[20:23]
    assert min(body.matches for body in posed(some, "thesis")) > 100


def test_who_is_told_to_face_elsewhere_is_fitted(silhouettes: list[Report]) -> None:
    """T22: what is proposed faces the camera; the user's word goes before it."""
    some = silhouettes[20:24]
    notes = Notes(note=(Note(some[2].frame, orientation="left"),))
    found = posed(some, notes=notes)
    assert [body.matches <= FEW for body in found] == [True, True, False, False]
    assert [body.lifting.orientation for body in found[2:] if body.lifting] == ["left", "left"]


def test_who_left_is_met_afresh(silhouettes: list[Report]) -> None:
    """P9: a frame without anybody has no pose, and the next one owes it nothing."""
    empty = silhouette_report(1, np.zeros((SIZE[1], SIZE[0]), np.bool_), 2, 2 / 15)
    some = [silhouettes[20], silhouettes[21], empty, silhouettes[20], silhouettes[21]]
    bodies = posed(some)
    assert [bool(body.joints_m) for body in bodies] == [True, True, False, True, True]
    assert np.allclose(bodies[3].joints_m, bodies[0].joints_m, rtol=0.0, atol=1e-12)


class Lent(Sequence[Report]):
    """Reports that are read one by one, as from a file, and how many were alive at once."""

    def __init__(self, reports: list[Report]) -> None:
        self.reports = reports
        self.kept: list[int] = []

    def __len__(self) -> int:
        return len(self.reports)

    def __getitem__(self, index: Any) -> Any:
        return copy(self.reports[index])

    def __iter__(self) -> Iterator[Report]:
        for report in self.reports:
            lent = copy(report)
            yield lent
            self.kept.append(sys.getrefcount(lent))


def test_a_film_of_any_length_is_not_held_in_memory(silhouettes: list[Report]) -> None:
    let_go, passed = Lent(silhouettes[20:24]), Lent(silhouettes[20:24])
    for _ in let_go:
        pass
    film = FilmFacts(Settings(), METHODS["default"], 1, 1 / 15, None, Notes())
    bodies_of(passed, film)
    assert len(passed.kept) >= len(let_go.kept)
    assert max(passed.kept) <= max(let_go.kept)
