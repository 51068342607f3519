"""Made-up rooms, seen by cameras that stand anywhere."""

import numpy as np
import pytest

from synth.picture.random_rig import random_rig
from synth.picture.synth_room import furnished


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("seed", [2, 32])
def test_a_room_is_lit_as_rooms_are_wherever_its_cameras_stand(seed: int) -> None:
    """Of seed 32 one camera stands higher than most ceilings: it saw light without end."""
    rig = random_rig(np.random.default_rng([seed, 81]), 0.4, (2.3, 5.6))
    for picture in furnished(seed, rig).pictures:
        assert np.isfinite(picture).all()
        assert picture.std() > 5.0
        assert picture.mean() < 250.0
