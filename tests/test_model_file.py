"""Models on disk: what was saved comes back, and everything else is refused in one line."""

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from acting import perform, performances
from hypothesis import given
from hypothesis import strategies as st

from recognizer.model_file import ModelError, load, save
from recognizer.postures import POSTURES, PostureModel, Recognizer, log_likelihoods
from recognizer.training.learning import train

RECOGNIZERS: list[Recognizer] = ["default", "paper"]


@pytest.fixture(scope="module", params=RECOGNIZERS)
def model(request: pytest.FixtureRequest) -> PostureModel:
    return train(performances(range(1)), request.param, performers=["p0"])


@pytest.fixture(scope="module")
def saved(model: PostureModel, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("models") / "postures.npz"
    save(model, path)
    return path


@pytest.fixture(scope="module")
def saved_of(tmp_path_factory: pytest.TempPathFactory) -> dict[Recognizer, Path]:
    folder = tmp_path_factory.mktemp("both")
    for recognizer in RECOGNIZERS:
        save(train(performances(range(1)), recognizer), folder / f"{recognizer}.npz")
    return {recognizer: folder / f"{recognizer}.npz" for recognizer in RECOGNIZERS}


def parts_of(path: Path) -> dict[str, Any]:
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def with_header(path: Path, target: Path, **changes: object) -> Path:
    """A copy of a model whose header says something else."""
    parts = parts_of(path)
    header = json.loads(parts["header"].tobytes()) | changes
    parts["header"] = np.frombuffer(json.dumps(header).encode(), np.uint8)
    np.savez(target, **parts)
    return target


def refusal(path: Path) -> str:
    """The text of the refusal: one line that names the file and the cure."""
    with pytest.raises(ModelError) as refused:
        load(path)
    text = str(refused.value)
    assert "\n" not in text
    assert str(path) in text
    assert "tritrack train" in text
    return text


def test_a_saved_model_scores_identically(model: PostureModel, saved: Path) -> None:
    again = load(saved, list(POSTURES))
    assert again.card == model.card
    for posture in POSTURES:
        angles_deg = perform(posture, performer=9)
        assert log_likelihoods(again, angles_deg) == log_likelihoods(model, angles_deg)


def test_the_same_model_gives_the_same_bytes(
    model: PostureModel, saved: Path, tmp_path: Path
) -> None:
    save(model, tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == saved.read_bytes()


@pytest.mark.parametrize("version", [2, 4])
def test_a_model_of_another_version_is_refused(saved: Path, tmp_path: Path, version: int) -> None:
    other = with_header(saved, tmp_path / "other.npz", version=version, another_field=1)
    assert f"version {version}, this tritrack reads 3" in refusal(other)


def test_a_model_of_other_features_is_refused(saved: Path, tmp_path: Path) -> None:
    header = json.loads(parts_of(saved)["header"].tobytes())
    turned = with_header(saved, tmp_path / "turned.npz", features=header["features"][::-1])
    assert "other features" in refusal(turned)


def test_a_model_of_other_postures_than_asked_for_is_refused(saved: Path) -> None:
    with pytest.raises(ModelError, match=r"not those asked for \(differing: bow, squat\)"):
        load(saved, [*(set(POSTURES) - {"squat"}), "bow"])


def test_postures_of_one_name_are_refused(saved: Path, tmp_path: Path) -> None:
    twice = with_header(saved, tmp_path / "twice.npz", postures=["squat"] * 15)
    assert "15 postures with 1 names" in refusal(twice)


class Trap:
    """Would leave a mark if a pickle of it were ever read."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[object, tuple[Path]]:
        return Path.touch, (self.mark,)


def test_pickles_are_refused_unread(saved: Path, tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    inside = parts_of(saved) | {"start": np.array([Trap(mark)], dtype=object)}
    np.savez(tmp_path / "inside.npz", allow_pickle=True, **inside)
    (tmp_path / "plain.npz").write_bytes(pickle.dumps(Trap(mark)))
    refusal(tmp_path / "inside.npz")
    refusal(tmp_path / "plain.npz")
    assert not mark.exists()


@pytest.mark.parametrize(
    ("recognizer", "name", "spoil", "reason"),
    [
        ("paper", "codebook", lambda a: a[:63], "codebook is float64 (63, 16)"),
        ("paper", "codebook", lambda a: a.astype(np.float32), "codebook is float32"),
        ("paper", "codebook", lambda a: a * np.nan, "codebook holds a number that is not finite"),
        ("default", "start", lambda a: a * 0.9, "rows of start are no probabilities"),
        (
            "default",
            "transition",
            lambda a: a * [1, 1, 1, 1, -1],
            "rows of transition are no probabilities",
        ),
        (
            "paper",
            "emission",
            lambda a: np.eye(64)[:5] + 0 * a,
            "emission calls a symbol impossible",
        ),
        ("default", "mean", lambda a: a[:, :, :9], "mean is float64 (15, 5, 9)"),
        ("default", "mean", lambda a: a * np.inf, "mean holds a number that is not finite"),
        ("default", "variance", lambda a: 0 * a, "variance holds a number that is not positive"),
    ],
)
def test_numbers_that_are_no_model_are_refused(
    saved_of: dict[Recognizer, Path],
    tmp_path: Path,
    recognizer: Recognizer,
    name: str,
    spoil: Any,
    reason: str,
) -> None:
    parts = parts_of(saved_of[recognizer])
    parts[name] = spoil(parts[name])
    np.savez(tmp_path / "spoilt.npz", **parts)
    assert reason in refusal(tmp_path / "spoilt.npz")


def test_foreign_and_missing_files_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "foreign.npz", numbers=np.arange(3))
    (tmp_path / "text.npz").write_text("no archive")
    (tmp_path / "empty.npz").write_bytes(b"")
    (tmp_path / "folder.npz").mkdir()
    for name in ("foreign", "text", "empty", "folder", "missing"):
        refusal(tmp_path / f"{name}.npz")


def test_a_file_that_would_unpack_to_too_much_is_refused(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "bomb.npz", header=np.zeros(20_000_000, np.uint8))
    assert "at most" in refusal(tmp_path / "bomb.npz")


@given(data=st.data())
def test_damage_is_refused_or_harmless(saved: Path, data: st.DataObject) -> None:
    """Cut short or with one byte changed, a file is refused, or gives the same model."""
    whole = saved.read_bytes()
    at = data.draw(st.integers(0, len(whole) - 1))
    flip = data.draw(st.integers(0, 255))
    damaged = saved.with_name("damaged.npz")
    damaged.write_bytes(whole[:at] + (bytes([whole[at] ^ flip]) + whole[at + 1 :] if flip else b""))
    try:
        model = load(damaged)
    except ModelError:
        return
    assert model.transition.tobytes() == load(saved).transition.tobytes()
    assert model.names == load(saved).names


def test_a_place_that_cannot_be_written_is_named(model: PostureModel, tmp_path: Path) -> None:
    (tmp_path / "no folder").write_text("")
    with pytest.raises(ModelError, match="cannot write the model"):
        save(model, tmp_path / "no folder" / "postures.npz")
