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

from lab.posture_models.learning import train
from recognizer import model_file
from recognizer.model_file import ModelError, load, save
from recognizer.postures import POSTURES, PostureModel, Recognizer, log_likelihoods

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


def test_why_a_file_cannot_be_read_is_said_in_the_systems_words_or_its_own(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    gone = tmp_path / "gone.npz"
    assert refusal(gone).startswith(f"cannot read the model {gone}: No such file or directory; ")

    def odd(*_: object) -> None:
        raise OSError("the disk is odd")

    monkeypatch.setattr(model_file, "read_arrays", odd)
    assert refusal(gone).startswith(f"cannot read the model {gone}: the disk is odd; ")


def test_a_fault_without_words_is_named_by_its_kind_and_one_of_many_lines_by_its_first(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for fault, said in (
        (RecursionError(), "RecursionError"),
        (ValueError("one\ntwo"), "one"),
    ):

        def broken(*_: object, fault: Exception = fault) -> None:
            raise fault

        monkeypatch.setattr(model_file, "read_arrays", broken)
        path = tmp_path / "odd.npz"
        assert refusal(path).startswith(f"no usable posture model in {path}: {said}; ")


def changed(saved_of: dict[Recognizer, Path], of: Recognizer, target: Path, **parts: Any) -> str:
    """The refusal of a model some of whose arrays are made other ones."""
    held = parts_of(saved_of[of])
    for name, change in parts.items():
        held[name] = change(held[name].copy())
    np.savez(target, **held)
    return refusal(target)


def first(value: float) -> Any:
    """A change of an array's first number."""

    def change(array: np.ndarray) -> np.ndarray:
        array.flat[0] = value
        return array

    return change


@pytest.mark.parametrize(
    ("of", "name", "change", "said"),
    [
        ("default", "mean", lambda a: a.astype(np.float32), "mean is float32"),
        ("default", "mean", lambda a: a[:-1], "mean is float64"),
        ("default", "mean", first(np.inf), "mean holds a number that is not finite"),
        ("default", "start", lambda a: a + 1e-8, "the rows of start are no probabilities"),
        ("default", "transition", first(-0.1), "the rows of transition are no probabilities"),
        ("default", "variance", first(0.0), "variance holds a number that is not positive"),
        ("default", "rest_variance", first(-1.0), "variance holds a number that is not positive"),
        ("paper", "codebook", first(np.nan), "codebook holds a number that is not finite"),
    ],
)
def test_an_array_that_no_model_has_is_named(
    saved_of: dict[Recognizer, Path],
    tmp_path: Path,
    of: Recognizer,
    name: str,
    change: Any,
    said: str,
) -> None:
    assert said in changed(saved_of, of, tmp_path / "false.npz", **{name: change})


def test_a_symbol_is_never_impossible(saved_of: dict[Recognizer, Path], tmp_path: Path) -> None:
    def moved(emission: np.ndarray) -> np.ndarray:
        row = emission[0, 0]
        row[1] += row[0]
        row[0] = 0.0
        return emission

    text = changed(saved_of, "paper", tmp_path / "never.npz", emission=moved)
    assert "emission calls a symbol impossible" in text


def test_probabilities_may_be_rounded(saved_of: dict[Recognizer, Path], tmp_path: Path) -> None:
    held = parts_of(saved_of["default"])
    held["start"] = held["start"] + 1e-11
    np.savez(tmp_path / "rounded.npz", **held)
    load(tmp_path / "rounded.npz")


@pytest.mark.parametrize(("off", "well"), [(0.9e-9, True), (1.1e-9, False)])
def test_probabilities_sum_to_one_within_a_billionth(
    saved_of: dict[Recognizer, Path], tmp_path: Path, off: float, well: bool
) -> None:
    held = parts_of(saved_of["default"])
    held["start"][0, 0] += off
    np.savez(tmp_path / "off.npz", **held)
    if well:
        load(tmp_path / "off.npz")
    else:
        assert "the rows of start are no probabilities" in refusal(tmp_path / "off.npz")
