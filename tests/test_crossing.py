"""A second person walks past one who stays on a spot."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synth import write
from synth.motion.crossing import BESIDE_M, crossing
from synth.motion.on_spot import on_spot
from synth.person.people import person
from synth.picture.render import render_scene
from synth.write import ClipSet, write_set


@pytest.mark.parametrize("seed", range(60, 72))
def test_who_crosses_walks_past_the_one_who_stays_and_never_into_them(seed: int) -> None:
    """Two pelvises stay 0.4 m apart at least, and come as near as the way is aside."""
    stays = on_spot(person(seed), 1)
    walks = crossing(person(seed + 500), 1, stays)
    assert walks.joints_m.shape == stays.joints_m.shape
    assert np.isfinite(walks.joints_m).all()
    apart_m = np.linalg.norm((walks.joints_m - stays.joints_m)[:, 0, [0, 2]], axis=1)
    assert 0.4 < apart_m.min() < BESIDE_M[1] + 0.3
    travelled_m = np.linalg.norm(walks.joints_m[-1, 0] - walks.joints_m[0, 0])
    assert travelled_m > 2.0


def test_a_set_of_crossings_has_both_in_the_pictures_and_the_first_in_the_truth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    real = render_scene

    def rendered(parts: Any, *rest: Any, **others: Any) -> Any:
        short = [part._replace(motion=_cut(part.motion)) for part in parts]
        asked.append(parts)
        return real(short, *rest, **others)

    monkeypatch.setattr(write, "render_scene", rendered)
    (folder,) = write_set(tmp_path, ClipSet("cross", seed=4), (48, 36))
    ((stays, walks),) = asked
    truth = np.load(folder / "truth.npz", allow_pickle=False)
    assert folder.name.endswith("_cross")
    assert stays.someone == person(4)
    assert walks.someone != stays.someone
    np.testing.assert_array_equal(truth["joints3d"], stays.motion.joints_m.astype(np.float32))
    assert truth["mask_cam1"].ndim == 3, "of the first alone"


def _cut(motion: Any) -> Any:
    names = ("joints_m", "bones", "angles_deg", "root_m", "phase")
    return motion._replace(**{name: getattr(motion, name)[:2] for name in names})
