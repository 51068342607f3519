"""Learning step by step: batches in their order, and work that is kept and taken up."""

from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy_torch import Tensor, importable, numpy_torch, tensor


@pytest.fixture(scope="module")
def learning() -> Any:
    """The module, also where the extra `train` is not installed."""
    with importable():
        from lab.landmark_lessons import landmark_learning

        return landmark_learning


@pytest.fixture(scope="module")
def loss() -> Any:
    """The module of the loss, also where the extra `train` is not installed."""
    with importable():
        from lab.landmark_lessons import landmark_loss

        return landmark_loss


class Later(NamedTuple):
    """What a pool promises."""

    asked: int

    def get(self) -> list[int]:
        return [self.asked]


class Pool:
    """Notes what it is asked for."""

    def __init__(self) -> None:
        self.asked: list[int] = []

    def apply_async(self, _: Any, given: tuple[int]) -> Later:
        self.asked.append(given[0])
        return Later(given[0])


def test_batches_come_in_their_order_and_a_few_are_asked_for_ahead(learning: Any) -> None:
    pool: Any = Pool()
    coming: Any = learning.ahead(pool, list, iter(range(10)))
    assert next(coming) == [0]
    assert pool.asked == [0, 1, 2, 3, 4]
    assert [batch for (batch,) in coming] == list(range(1, 10))


def _begun(torch: Any) -> Any:
    from lab.landmark_lessons.landmark_learning import Paced, begun

    network = torch.nn.Linear(2, 1)
    return begun(network, [Paced([network.weight], 0.5)])


def test_what_was_never_kept_begins_and_what_was_kept_goes_on(tmp_path: Path) -> None:
    torch = pytest.importorskip("torch", reason="the extra `train` is not installed")
    from lab.landmark_lessons.landmark_learning import keep, resumed

    work = _begun(torch)
    assert resumed(work, tmp_path / "kept.pt").batch == 0
    keep(work._replace(batch=7), tmp_path / "kept.pt")
    again = resumed(_begun(torch), tmp_path / "kept.pt")
    assert again.batch == 7
    assert torch.equal(again.network.weight, work.network.weight)


def test_only_weights_that_are_named_learn_each_at_its_pace(
    learning: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    noted = list[Any]()

    def weight(name: str) -> Any:
        copied = SimpleNamespace(clone=lambda: f"{name} at first")
        return SimpleNamespace(
            requires_grad_=lambda on: noted.append((name, on)), detach=lambda: copied
        )

    def adam(groups: Any, weight_decay: float) -> Any:
        noted.append((groups, weight_decay))
        return "adam"

    weights = [weight(name) for name in "abc"]
    network = SimpleNamespace(requires_grad_=lambda on: noted.append(("all", on)), tag=[1])
    monkeypatch.setattr(learning, "torch", numpy_torch(optim=SimpleNamespace(AdamW=adam)))
    parts = [
        learning.Paced(weights[:2], 1.0),
        learning.Paced(weights[2:], 0.1, 0.002),
    ]
    work = learning.begun(network, parts)
    assert noted[:4] == [("all", False), ("a", True), ("b", True), ("c", True)]
    heads = {"params": weights[:2], "pace": 1.0, "pull": 0.0, "began": ["a at first", "b at first"]}
    trunk = {"params": weights[2:], "pace": 0.1, "pull": 0.002, "began": ["c at first"]}
    assert noted[4] == ([heads, trunk], 1e-4)
    assert (work.network, work.adam, work.batch) == (network, "adam", 0)
    assert work.mean is not network
    assert work.mean.tag is not network.tag


class Running(Tensor):
    """A weight of the running mean."""

    def is_floating_point(self) -> bool:
        return self.dtype == np.float32

    def lerp_(self, other: Any, share: float) -> None:
        self[...] = self + share * (other - self)


class Net:
    """Weights under names."""

    def __init__(self, values: list[float], steps: int) -> None:
        self.held: dict[str, Any] = {
            "weight": tensor(values).view(Running),
            "steps": np.array(steps).view(Running),
        }

    def state_dict(self) -> dict[str, Any]:
        return self.held

    def load_state_dict(self, held: dict[str, Any]) -> None:
        self.held = held

    def parameters(self) -> list[Any]:
        return [self.held["weight"]]


def test_a_batch_moves_the_network_by_its_slopes_and_the_mean_by_a_share(
    learning: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half of the highest rate, 2e-3; what is pulled back goes half of a tenth of its way."""
    noted = list[Any]()
    network, mean = Net([4.0, 8.0], 7), Net([0.0, 1.0], 3)
    slow = tensor([3.0, 5.0]).view(Running)
    adam = SimpleNamespace(
        param_groups=[
            {"pace": 1.0, "pull": 0.0, "params": [network.held["weight"]], "began": [tensor(9.0)]},
            {"pace": 0.1, "pull": 0.1, "params": [slow], "began": [tensor([1.0, 5.0])]},
        ],
        zero_grad=lambda: noted.append("zero"),
        step=lambda: noted.append("step"),
    )

    def loss_of(one: Any, shown: Any) -> Any:
        noted.append((one is network, shown))
        return SimpleNamespace(backward=lambda: noted.append("slope"))

    library = numpy_torch()
    library.nn.utils.clip_grad_norm_ = lambda _, size: noted.append(("cut", size))
    monkeypatch.setattr(learning, "torch", library)
    monkeypatch.setattr(learning.landmark_loss, "loss", loss_of)
    work = learning.Work(network, mean, adam, 12)
    found = learning.learnt_from(work, "shown", 0.5, 0.25)
    assert noted == ["zero", (True, "shown"), "slope", ("cut", 5.0), "step"]
    assert [group["lr"] for group in adam.param_groups] == pytest.approx([1e-3, 1e-4])
    assert slow == pytest.approx([3.0 - 0.05 * 2.0, 5.0])
    assert mean.held["weight"] == pytest.approx([1.0, 1 + 7 / 4])
    assert int(mean.held["steps"]) == 3
    assert network.held["weight"] == pytest.approx([4.0, 8.0])
    assert found == work._replace(batch=13)


def test_each_part_of_a_work_is_kept_under_its_own_name_in_place_of_the_old(
    learning: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    saved = dict[str, Any]()

    def save(held: Any, path: Path) -> None:
        saved[path.name] = held
        path.write_text("new")

    def load(path: Path, weights_only: bool) -> Any:
        assert weights_only
        assert path.read_text() == "new"
        return saved["new.pt"]

    monkeypatch.setattr(learning, "torch", numpy_torch(save=save, load=load))
    parts = [Net([value], 0) for value in (1.0, 2.0, 3.0)]
    kept = tmp_path / "kept.pt"
    kept.write_text("old")
    learning.keep(learning.Work(*parts, 41), kept)
    assert [path.name for path in tmp_path.iterdir()] == ["kept.pt"]
    fresh = learning.Work(*(Net([0.0], 0) for _ in range(3)), 0)
    again = learning.resumed(fresh, kept)
    assert again.batch == 41
    assert [float(part.held["weight"][0]) for part in again[:3]] == [1.0, 2.0, 3.0]


def small_maps(loss: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Maps of 4 cells of 8 px, with NumPy."""
    library = numpy_torch()
    monkeypatch.setattr(loss, "torch", library)
    monkeypatch.setattr(loss, "functional", library.nn.functional)
    monkeypatch.setattr(loss, "CELLS", 4)
    monkeypatch.setattr(loss, "SIDE_PX", 32)


def test_a_peak_lies_between_cells_where_a_bell_through_three_has_it(
    loss: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of bells of deviation 0.8 cells beside the middle; a steep slope leads no farther off."""
    small_maps(loss, monkeypatch)
    places = np.array([-1.0, 0.0, 1.0])
    bells = np.exp(-((places - [[0.3], [-0.2]]) ** 2) / (2 * 0.8**2))
    assert loss._between(bells.view(Tensor)) == pytest.approx([0.3, -0.2], abs=1e-5)
    steep = np.array([[1e-3, 1.0, 4000.0]]).view(Tensor)
    assert float(loss._between(steep)[0]) == pytest.approx(loss.FARTHEST)


def test_the_map_of_a_joint_is_a_bell_of_three_pixels_about_it(
    loss: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    small_maps(loss, monkeypatch)
    found = loss._maps_due(tensor([[[13.0, 21.0], [4.0, 28.0]]]))[0]
    for (x, y), share in zip(((13.0, 21.0), (4.0, 28.0)), found, strict=True):
        due = np.array(
            [
                [np.exp(-((8 * c + 4 - x) ** 2 + (8 * r + 4 - y) ** 2) / 18) for c in range(4)]
                for r in range(4)
            ]
        )
        assert share == pytest.approx((due / due.sum()).ravel(), abs=1e-5)


def person(**parts: Any) -> Any:
    rng = np.random.default_rng(3)
    given = {
        "joints_px": rng.uniform(4, 28, (15, 2)).astype(np.float32),
        "inside": np.ones(15, np.bool_),
        "facing": np.array([0.6, -0.8], np.float32),
        "stature_px": 60.0,
        "nobody": False,
        "mask": np.zeros((32, 32), np.uint8),
    }
    return SimpleNamespace(**{**given, **parts})


def crossed(due: Any, logits: Any) -> float:
    return float(-(due * (logits - np.log(np.exp(logits).sum()))).sum())


def facing_loss(bins: Any, facing: tuple[float, float], count: int) -> float:
    turn = np.arctan2(*facing)
    due = np.exp(6.0 * np.cos(turn - np.arange(count) * 2 * np.pi / count))
    return crossed(due / due.sum(), bins)


def test_the_way_a_person_faces_is_taught_of_those_whose_front_is_seen(
    loss: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of three the second points less than 0.35 aside; where none does more, nothing is wrong."""
    small_maps(loss, monkeypatch)
    bins = np.random.default_rng(1).normal(0, 1, (3, loss.BINS))
    facings = [(0.6, -0.8), (0.2, 0.28), (-0.3, 0.2)]
    shown = [person(facing=np.array(facing)) for facing in facings]
    each = [facing_loss(*given, loss.BINS) for given in zip(bins, facings, strict=True)]
    found = loss._facing_loss(bins.view(Tensor), shown)
    assert float(found) == pytest.approx((each[0] + each[2]) / 2)
    assert float(loss._facing_loss(bins[1:2].view(Tensor), shown[1:2])) == 0.0


def test_the_loss_is_of_maps_facing_presence_and_sureness(
    loss: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Joint 0 is outside; joint 1 is found 1.7 px off, near for 60 px of stature, 2 is 1.9 off. The
    mask of 16 cells has the upper half; of a second person it is not known."""
    small_maps(loss, monkeypatch)
    monkeypatch.setattr(landmark_planes(), "CELLS", 4)
    rng, mask_px = np.random.default_rng(2), np.zeros((32, 32), np.uint8)
    mask_px[:16] = 255
    one = person(inside=np.arange(15) > 0, mask=mask_px)
    maps = tensor(rng.normal(0, 1, (1, 15, 4, 4)))
    told = tensor(rng.normal(0, 1, (1, loss.BINS + 16)))
    found_px = one.joints_px + 9.0
    found_px[:3] = one.joints_px[:3] + np.array([[0.0, 0.0], [1.7, 0.0], [0.0, 1.9]])
    monkeypatch.setattr(loss, "peaks", lambda _: tensor(found_px[None]))
    monkeypatch.setattr(loss, "halved", lambda _: nullcontext())
    monkeypatch.setattr(loss, "planes_of", lambda shown: shown)
    mask = tensor(rng.normal(0, 1, (1, 4, 4)))
    found = loss.loss(lambda shown: (maps, told, mask) if shown == [one] else None, [one])
    due = loss._maps_due(tensor(one.joints_px[None]))[0]
    where = np.mean([crossed(due[j], maps[0, j].ravel()) for j in range(1, 15)])
    bins, absent, sure = told[0, : loss.BINS], told[0, loss.BINS], told[0, loss.BINS + 1 :]
    wrong = np.log1p(np.exp(np.where(np.arange(15) == 1, -sure, sure))).mean()
    by_hand = where + 0.3 * facing_loss(bins, (0.6, -0.8), loss.BINS)
    by_hand += 0.2 * np.log1p(np.exp(absent)) + 0.3 * wrong
    upper = np.arange(4)[:, None] < 2
    by_hand += 0.5 * np.log1p(np.exp(np.where(upper, -mask[0], mask[0]))).mean()
    assert float(found) == pytest.approx(float(by_hand), rel=1e-4)


def test_a_mask_that_is_not_known_teaches_nothing(
    loss: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    small_maps(loss, monkeypatch)
    monkeypatch.setattr(landmark_planes(), "CELLS", 4)
    mask = tensor(np.random.default_rng(4).normal(0, 1, (2, 4, 4)))
    shown = [person(), person(mask=np.full((32, 32), 128, np.uint8))]
    due = np.log1p(np.exp(mask[0])).mean()
    assert float(loss._mask_loss(mask, shown)) == pytest.approx(float(due), rel=1e-5)
    assert float(loss._mask_loss(mask[1:], shown[1:])) == 0.0


def landmark_planes() -> Any:
    with importable():
        from lab.landmark_lessons import landmark_planes

        return landmark_planes


def test_a_cell_that_a_mask_covers_in_part_is_due_in_part() -> None:
    """Cells of 2.67 pixels of a whole mask, 128 across: exact means, and none where it is not."""
    mask = np.zeros((128, 128), np.uint8)
    mask[:, :4] = 255
    due, known = landmark_planes().masks_of([SimpleNamespace(mask=mask)])
    assert due.shape == (1, 48, 48)
    assert due[0, 7, :3] == pytest.approx([1.0, 0.5, 0.0], abs=0.01)
    assert known.tolist() == [1.0]


def test_joints_are_off_by_shares_of_the_stature_and_unknown_where_not_in_the_picture(
    loss: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    small_maps(loss, monkeypatch)
    shown = [person(), person(stature_px=30.0, inside=np.arange(15) != 4)]
    found_px = np.stack([one.joints_px for one in shown]) + np.array([3.0, -4.0])
    monkeypatch.setattr(loss, "peaks", lambda _: tensor(found_px))
    monkeypatch.setattr(loss, "halved", lambda _: nullcontext())
    monkeypatch.setattr(loss, "planes_of", lambda shown: shown)
    modes: Any = []

    def judged(_: Any) -> Any:
        modes.append("asked")
        return tensor(np.zeros((1, 15, 4, 4))), tensor([[0.0]]), tensor([[0.0]])

    network = SimpleNamespace(eval=lambda: modes.append("eval") or judged)
    monkeypatch.setattr(loss, "GROUP", 1)
    off = loss.joints_off(network, shown)
    due = np.full((2, 15), 5 / 60)
    due[1], due[1, 4] = 5 / 30, np.nan
    assert off == pytest.approx(due, rel=1e-4, nan_ok=True)
    assert modes == ["eval", "asked"] * 2
