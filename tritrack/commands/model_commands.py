"""The commands for models and figures: training, and evaluation of tracking and recognition."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import typer

from common.atomic_file import refuse_to_replace
from common.config import config_file
from lab.landmark_lessons import work_of
from runtime.terminal import counted
from tritrack.commands.command_output import JsonWanted, console, tell
from tritrack.commands.options import (
    CACHE,
    MODES,
    Cache,
    Forced,
    ModeName,
    Out,
    OwnMode,
    Size,
    writable,
    writable_file,
)
from tritrack.extras import refuse_without

if TYPE_CHECKING:
    from lab.training.training import Plan

LEARN: Final = ("learn", "sklearn")
"""The extra for training, and a module that it installs."""
RecognizerName = Annotated[
    Literal["default", "paper"], typer.Option(help=f"Which models. {MODES}.")
]

evaluate_app = typer.Typer(help="Measure how well people are tracked and recognised.")


def train(
    out: Annotated[Path, typer.Option(help="The model file to write.", callback=writable_file)],
    runs: Annotated[
        list[Path] | None,
        typer.Argument(help="Clips that name their posture, or their run folders."),
    ] = None,
    what: Annotated[
        Literal["postures", "proposals", "lifting", "silhouettes", "landmarks"],
        typer.Option(help="What is learnt; only postures need clips."),
    ] = "postures",
    film: Annotated[
        list[Path] | None,
        typer.Option(help="Of landmarks: a video to train the shipped network on; again for more."),
    ] = None,
    teacher: Annotated[
        str, typer.Option(help="Source of the joints in videos: mediapipe, or keypoint files.")
    ] = "mediapipe",
    recognizer: RecognizerName = "default",
    mode: OwnMode = None,
    cache: Cache = CACHE,
    force: Forced = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Learn postures from clips or runs.

    With --what, a network is trained on synthetic people instead. It is one of four: proposals
    (poses from silhouettes), lifting (poses from landmarks), silhouettes, landmarks. The last one
    can be trained on your own videos too: give --film VIDEO for each.

    To add one posture to a model, use tritrack teach.

    Example: tritrack train clips/*/ --out postures.npz
    """
    goes_on = what == "landmarks" and work_of(out).is_dir()
    refuse_to_replace(out, force or goes_on)
    if film:
        if what != "landmarks":
            raise typer.BadParameter("only landmarks are learnt from videos: add --what landmarks")
        _teach_on_videos(film, teacher, out, json_wanted)
        return
    if what != "postures":
        _train_network(what, out, json_wanted)
        return
    if not runs:
        raise typer.BadParameter("name clips or run folders to learn postures from")
    refuse_without(*LEARN)
    from lab.training.training import Plan

    _train_postures(runs, out, Plan(mode, recognizer, cache), json_wanted)


def _train_postures(runs: list[Path], out: Path, plan: "Plan", json_wanted: bool) -> None:
    """Train postures, and report how many."""
    from lab.training.training import train_postures

    facts = train_postures(runs, out, plan, console)
    line = (
        f"{counted(len(facts['sequences']), 'posture')} learnt, {len(facts['knows'])} known; "
        f"written to {out}"
    )
    tell(facts, json_wanted, line)


def _train_network(
    what: Literal["proposals", "lifting", "silhouettes", "landmarks"], out: Path, json_wanted: bool
) -> None:
    """Train one of the package's networks on synthetic people."""
    if what == "proposals":
        from lab.training.proposal_training import train_proposals

        facts = train_proposals(out, 0, console)
        tell(facts, json_wanted, f"{facts['instants']} instants learnt, written to {out}")
        return
    if what == "lifting":
        from lab.training.lifting_training import train_lifting

        facts = train_lifting(out, 0, console)
        tell(facts, json_wanted, f"{facts['instants']} instants learnt, written to {out}")
        return
    if what == "silhouettes":
        refuse_without(*LEARN)
        from lab.training.silhouette_training import train_silhouettes

        facts = train_silhouettes(out, 0, console)
        tell(facts, json_wanted, f"{facts['pixels']} pixels learnt, written to {out}")
        return
    if what == "landmarks":
        refuse_without("train", "torch", "onnx", "onnxscript", "anny")
        from lab.landmark_lessons.landmark_training import train_landmarks

        facts = train_landmarks(out, 0, console)
        tell(facts, json_wanted, f"{facts['pictures']} pictures learnt, written to {out}")


def _teach_on_videos(films: list[Path], teacher: str, out: Path, json_wanted: bool) -> None:
    """Train the packaged landmark network on another pose estimator's output for videos."""
    refuse_without("train", "torch", "onnx", "onnxscript", "anny")
    from lab.video_lessons.video_training import teach_on_videos

    facts = teach_on_videos(films, teacher, out, console)
    line = f"better: {facts['verdict']}; written to {out}: name it in the settings, landmarks = ..."
    tell(facts, json_wanted, line)


def teach(
    posture: Annotated[str, typer.Argument(help="The posture's name, as star_jump.")],
    out: Annotated[Path, typer.Option(help="The model file to write.", callback=writable_file)],
    takes: Annotated[
        list[Path] | None, typer.Argument(help="Clips of it or their runs, one a take.")
    ] = None,
    live: Annotated[
        Path | None, typer.Option(help="Settings of cameras: it counts you in and takes three.")
    ] = None,
    count_in: Annotated[
        float, typer.Option(min=0.0, max=60.0, help="Seconds that are counted before a take.")
    ] = 3.0,
    add_to: Annotated[
        Path, typer.Option(help="A model file, or shipped: what it knows is kept in --out.")
    ] = Path("shipped"),
    again: Annotated[
        bool,
        typer.Option("--again", help="Learn a posture that it knows anew, by these takes alone."),
    ] = False,
    recognizer: RecognizerName = "default",
    cache: Cache = CACHE,
    json_wanted: JsonWanted = False,
) -> None:
    """Teach a model one more posture by three takes or more.

    The takes are recordings, or are performed before cameras (--live). Says whether the takes
    agree, and which other posture is most similar. With --again the posture is one of the model's:
    give new takes alone to replace it, or old and new ones to extend it.

    Example: tritrack teach star_jump take1/ take2/ take3/ --out mine.npz
    """
    refuse_without(*LEARN)
    if bool(takes) == (live is not None):
        raise typer.BadParameter("name takes of it, or --live CONFIG")
    from lab.training import teaching
    from lab.training.training import Plan

    plan = Plan(None, recognizer, cache, add_to, again)
    if live is not None:
        from lab.training.live_teaching import teach_live

        facts = teach_live(posture, config_file.load(live), out, plan, console, count_in)
    else:
        facts = teaching.teach(posture, takes or [], out, plan, console)
    tell(facts, json_wanted, teaching.line(facts))


@evaluate_app.command("postures")
def evaluate_postures(
    clips: Annotated[
        list[Path], typer.Argument(help="Clips that name their posture, or their run folders.")
    ],
    out: Out,
    split: Annotated[
        str, typer.Option(help="Or whom to learn from and test on: anna,ben:cleo, s1*:s2*")
    ] = "leave-one-performer-out",
    recognizer: Annotated[
        Literal["both", "default", "paper"], typer.Option(help="Which models, side by side.")
    ] = "both",
    mode: OwnMode = None,
    model: Annotated[
        Path | None, typer.Option(help="A file, or shipped: it names all clips, nothing is learnt.")
    ] = None,
    sweep: Annotated[
        bool, typer.Option(help="The paper's with 16 to 256 symbols and 3 to 8 states too.")
    ] = False,
    cache: Cache = CACHE,
    dask: Annotated[
        str, typer.Option(help="Address of a Dask scheduler to work on instead, tcp://host:8786.")
    ] = "",
    json_wanted: JsonWanted = False,
) -> None:
    """Recognise postures of people not learnt from (table 2).

    All cores track clips, with about 450 MB each. Tracking results are kept, so that a stopped
    evaluation resumes.

    Example: tritrack evaluate postures clips/*/ --split 's1*:s2*' --out report
    """
    refuse_without("report", "matplotlib")
    if model is None:
        refuse_without(*LEARN)
    from lab.postures import posture_evaluation

    plan = posture_evaluation.Plan(
        split, posture_evaluation.KINDS[recognizer], mode, model, sweep, cache, dask
    )
    report = posture_evaluation.evaluate_postures(clips, out, plan, console)
    tables = [
        f"{name} recogniser:\n{result['table']}" for name, result in report["recognizers"].items()
    ]
    tell(report, json_wanted, "\n\n".join(tables))


@evaluate_app.command("spotting")
def evaluate_spotting(
    runs: Annotated[
        list[Path],
        typer.Argument(help="Streams, or clips of one posture each, or their run folders."),
    ],
    out: Out,
    model: Annotated[
        Path | None, typer.Option(help="A model file, instead of the one in the package.")
    ] = None,
    mode: ModeName = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Find performances in uncut streams.

    Reports how many are found, after how long, and how many events are false.

    Example: tritrack evaluate spotting runs/*_stream --out report
    """
    from lab.postures import spotting_report

    report = spotting_report.evaluate_spotting(runs, out, model, mode, console)
    tell(report, json_wanted, report["table"])


@evaluate_app.command("tracking")
def evaluate_tracking(
    clips: Annotated[list[Path], typer.Argument(help="Clips with a truth, or their run folders.")],
    out: Out,
    runs: Annotated[
        Path | None,
        typer.Option(
            help="Where runs stand; clips without one are tracked into it.", callback=writable
        ),
    ] = None,
    mode: ModeName = None,
    size: Size = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Track clips and compare them with their ground truth.

    Joints, silhouettes, lengths and confidence are measured.

    Example: tritrack evaluate tracking clips/*/ --out report
    """
    refuse_without("report", "matplotlib")
    from lab.accuracy import accuracy_report, tracking_evaluation

    report = tracking_evaluation.evaluate_tracking(clips, out, runs, mode, size, console)
    facts = accuracy_report.headline(report)
    tell(facts, json_wanted, f"{accuracy_report.line(report)}; written to {out}")
