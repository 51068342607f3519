"""A report with the stick body of its silhouette: which stature, which pose before."""

import msgspec
import numpy as np
import pytest
from posing import BODY, box_around, picture, posed
from stick_posing import STATURE_PX, drawn, stick_pose

from common.body.observation import Observation
from common.body.proportions import thesis_bdp
from common.method import DEFAULT
from common.raster.silhouette_report import pack
from common.raster.similarity import Mask
from common.rig.camera import PAPER_ROTATIONS
from viewer.expected_body import ExpectedBody
from viewer.paper.posed_model import view_at
from viewer.stick import stick_fit
from viewer.stick.standing_height import Standing
from viewer.stick.stick_report import with_stick

ROTATION = np.array(PAPER_ROTATIONS[1])


def seen_as(mask: Mask) -> Observation:
    return Observation(
        width=mask.shape[1],
        height=mask.shape[0],
        silhouette=pack(mask),
        box=box_around(mask),
        area_px=int(mask.sum()),
    )


def known_body() -> ExpectedBody:
    """A body of 2 m, 45 px a metre, whose left arm is out."""
    pose = posed(l_shoulder_z=290.0)
    return ExpectedBody(
        thesis_bdp(2.0), True, tuple(pose.tolist()), "facade", 45.0, (70.0, 60.0), 60.0
    )


def asked(
    monkeypatch: pytest.MonkeyPatch, known: ExpectedBody | None, standing: Standing | None
) -> tuple[np.ndarray | None, float]:
    """With which pose before and which stature a body is fitted to rows 20 to 119 of a picture."""
    got: list[tuple[np.ndarray | None, float]] = []

    def fit(_mask: Mask, before: np.ndarray | None, stature_px: float, _method: object) -> None:
        got.append((before, stature_px))
        raise stick_fit.NoFit

    monkeypatch.setattr(stick_fit, "fit", fit)
    mask = np.zeros((140, 160), np.bool_)
    mask[20:120, 70:80] = True
    person = seen_as(mask)
    assert with_stick(person, mask, ROTATION, known, standing, DEFAULT) is person
    return got[0]


def test_the_report_has_the_fit_and_its_score() -> None:
    mask = drawn(stick_pose({"r_upper_arm": 200.0, "r_lower_arm": 190.0}))
    person = with_stick(seen_as(mask), mask, ROTATION, None, None, DEFAULT)
    tall = float(np.flatnonzero(mask.any(axis=1)).size)
    fitted = stick_fit.fit(mask, None, tall, DEFAULT)
    assert person.stick == stick_fit.fit_of(fitted)
    assert person.stick is not None
    assert person.stick.score == fitted.score > 0.85
    assert person.stick.stature_px == pytest.approx(STATURE_PX, rel=0.05)
    assert msgspec.structs.replace(person, stick=None) == seen_as(mask)


def test_a_stature_is_what_is_seen_where_nothing_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    assert asked(monkeypatch, None, None) == (None, 100.0)


def test_a_followed_body_has_its_own_stature_and_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    known = known_body()
    before, stature_px = asked(monkeypatch, known, None)
    assert stature_px == pytest.approx(90.0)
    view = view_at(ROTATION, 45.0, (70.0, 60.0))
    wanted = stick_fit.expected(2.0 * BODY, np.array(known.pose), view, 90.0)
    assert before == pytest.approx(wanted, abs=1e-6)


def test_a_film_that_was_looked_at_knows_the_stature_at_these_feet(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By the row below the feet, 120: 20 + 0.5 * 120; with a followed body too."""
    standing = Standing(sole_row=100.0, tall_px=70.0, level_px=20.0, slope=0.5, least_px=30.0)
    assert asked(monkeypatch, None, standing) == (None, 80.0)
    before, stature_px = asked(monkeypatch, known_body(), standing)
    assert stature_px == 80.0
    assert before is not None


def test_a_silhouette_without_a_body_leaves_the_report_as_it_is() -> None:
    mask = drawn(stick_pose({}))
    flat = Standing(0.0, 0.0, 0.0, 0.0, 0.0)
    person = seen_as(mask)
    assert with_stick(person, picture(posed()), ROTATION, None, flat, DEFAULT) is person
