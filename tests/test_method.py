"""What the three modes do beyond the print, by name."""

import msgspec
import pytest
from ablation import departures

from common.method import DEFAULT, METHODS, PAPER, THESIS, Method


def test_the_paper_departs_in_nothing() -> None:
    assert departures(PAPER) == ()
    assert not any(getattr(PAPER, name) for name in Method.__struct_fields__)


def test_the_default_takes_every_departure_but_the_thesis_own_way() -> None:
    assert set(departures(DEFAULT)) == set(Method.__struct_fields__) - {"stick_lifting"}


def test_the_thesis_takes_our_silhouettes_and_its_own_way_from_there_on() -> None:
    """T8 has no threshold. What names postures is not the thesis's."""
    assert departures(THESIS) == (
        *("steady_light", "pixel_evidence", "body_colours", "alpha_matte", "slow_light"),
        *("density_recognizer", "stick_lifting"),
    )


def test_a_method_names_every_field_and_cannot_be_changed() -> None:
    with pytest.raises(TypeError):
        Method(steady_light=True)  # type: ignore[call-arg]
    with pytest.raises(AttributeError):
        PAPER.proposals = True  # type: ignore[misc]
    assert msgspec.structs.replace(PAPER, proposals=True) != PAPER


def test_every_mode_has_its_method() -> None:
    assert METHODS == {"default": DEFAULT, "paper": PAPER, "thesis": THESIS}
