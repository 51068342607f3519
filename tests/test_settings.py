"""The settings of a run that says nothing of them, held against the papers."""

from common.config.picture_size import size_of
from common.config.settings import Settings


def test_the_defaults_are_the_papers() -> None:
    """P1, P41: 160x120; windows of 64 and 32 degrees down to 4."""
    settings = Settings()
    assert size_of(settings.size) == (160, 120)
    search = settings.search
    assert (search.arm_window_deg, search.leg_window_deg, search.stop_deg) == (64, 32, 4)
    assert settings.body.stature_m == 1.75
    assert not settings.pictures
