"""The arrays of a run's poses: of many bodies the same as of few, and the same file of them."""

from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest

from common.bus.messages import Body, Lifting
from runtime.offline.lockstep import Tracked
from runtime.store import pose_arrays
from runtime.store.joint_arrays import on_disk
from runtime.store.pose_arrays import mapped_poses, poses


@pytest.fixture
def bodies(tracked_clip: Tracked) -> list[Body]:
    return list(tracked_clip.bodies)


def lifted(body: Body) -> Body:
    return msgspec.structs.replace(body, lifting=Lifting("left", 0.5, (0.25,) * 10))


def without(body: Body) -> Body:
    return msgspec.structs.replace(body, extremities_m=(), extremities_px=())


CASES: dict[str, Callable[[Body], Body]] = {
    "as tracked": lambda body: body,
    "one lifted": lambda body: lifted(body) if body.frame == 20 else body,
    "one without extremities": lambda body: without(body) if body.frame == 30 else body,
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("at_once", [1, 7, 10**6])
def test_however_many_are_taken_at_once_the_file_is_the_same(
    name: str, at_once: int, bodies: list[Body], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pose_arrays, "AT_ONCE", at_once)
    told = [CASES[name](body) for body in bodies]
    np.savez(tmp_path / "whole.npz", allow_pickle=False, **on_disk(poses(told)))
    with mapped_poses(told, tmp_path, on_disk) as arrays:
        np.savez(tmp_path / "parts.npz", allow_pickle=False, **arrays)
    whole, parts = (tmp_path / f"{name}.npz" for name in ("whole", "parts"))
    assert whole.read_bytes() == parts.read_bytes()
    assert sorted(tmp_path.iterdir()) == sorted([whole, parts])


def test_of_nobody_there_are_arrays_without_rows(tmp_path: Path) -> None:
    with mapped_poses([], tmp_path) as arrays:
        assert {name: a.tobytes() for name, a in arrays.items()} == {
            name: a.tobytes() for name, a in poses([]).items()
        }
