"""The front door: every command of tritrack."""

import gc
import os

from tritrack.stopping import (
    STOPS,
    WORD,
    Terminated,
    code_of_stop,
    end_with_starter,
    heed_at_once,
    heed_in_order,
)

heed_at_once()

# What is loaded stays: a collection every 700 objects would take a tenth of the start.
gc.set_threshold(20_000)
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import logging
import sys
import warnings
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Final, Literal, TextIO

import typer

from common.config.renamed_settings import RenamedSetting
from runtime.faults import code_of, told
from runtime.terminal import complain, json_text, warn
from tritrack.commands.clip_commands import replay, retouch, single, synth, track
from tritrack.commands.command_output import JsonWanted, console, results
from tritrack.commands.export_command import export
from tritrack.commands.key_commands import examined_keys, keys
from tritrack.commands.live_commands import (
    animate,
    bridge,
    demo,
    integrate,
    live,
    metrics,
    recognize,
    serve,
    view,
)
from tritrack.commands.model_commands import evaluate_app, teach, train
from tritrack.commands.options import Out
from tritrack.commands.record_command import record
from tritrack.commands.report_commands import compare, report
from tritrack.commands.rig_commands import calibrate_app
from tritrack.commands.start_command import start

app = typer.Typer(
    name="tritrack",
    help="Body tracking and posture recognition from two ordinary cameras, or one, in real time.",
    epilog="Start: doctor, demo, single, track, live; or tritrack alone, which opens a page.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

PLAIN: Final = {
    "Value error, ": "",
    "Input should be less than or equal to": "it must be at most",
    "Input should be greater than or equal to": "it must be at least",
}
"""The command-line library's messages, and our wording of each."""

log = logging.getLogger(__name__)


def tell_version(wanted: bool) -> None:
    """Print the version and end."""
    if wanted:
        print(f"tritrack {version('tritrack')}")
        raise typer.Exit


@app.callback()
def every_command(
    log_level: Annotated[
        Literal["debug", "info", "warning", "error"],
        typer.Option(help="How much of the log is written."),
    ] = "warning",
    _version: Annotated[
        bool,
        typer.Option("--version", callback=tell_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Options of all commands."""
    os.environ["TRITRACK_LOG"] = "info" if log_level == "warning" else log_level
    logging.basicConfig(level=log_level.upper(), format="%(levelname)s %(name)s: %(message)s")


def doctor(
    settings_file: Annotated[
        Path | None,
        typer.Argument(help="Settings or a clip folder: is all there that a live run needs?"),
    ] = None,
    out: Out = Path("runs/live"),
    keys_folder: Annotated[
        Path | None, typer.Option("--keys", help="Look at the keys in this folder too.")
    ] = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Check the installation and what a live run needs.

    That is ports, cameras, disk, clock and keys.

    Example: tritrack doctor configs/cameras.toml
    """
    from tritrack.doctor.installation import examine, table_of

    findings = examine()
    if settings_file is not None:
        from common.config import config_file
        from tritrack.doctor.run_needs import examine_run

        settings = config_file.load(settings_file)
        findings += examine_run(settings, out)
        keys_folder = keys_folder or (Path(settings.bus.keys) if settings.bus.keys else None)
    findings += [] if keys_folder is None else examined_keys(keys_folder)
    if json_wanted:
        print(json_text([finding._asdict() for finding in findings]))
    else:
        results.print(table_of(findings))
    if any(not finding.ok and finding.needed for finding in findings):
        raise typer.Exit(2)


def bench(
    quick: Annotated[bool, typer.Option(help="Fewer repetitions.")] = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Measure this machine: matching, tracking, memory.

    Example: tritrack bench
    """
    from lab.bench.bench import main as bench_main

    bench_main(json_wanted, quick)


COMMANDS: Final = (
    *(start, single, track, live, export),
    *(record, demo, replay, retouch, report, compare, synth, train, teach, doctor, bench),
    *(serve, view, integrate, recognize, animate, metrics, bridge, keys),
)
"""In the order of the help: the five main uses first, the parts of a rig over hosts last."""
for command in COMMANDS:
    app.command()(command)
app.add_typer(calibrate_app, name="calibrate")
app.add_typer(evaluate_app, name="evaluate")


def main() -> None:
    """Run a command; a user's mistake is one line and exit code 2, a fault of ours 1.

    Without a word on a terminal it is `start`.
    """
    heed_in_order()
    end_with_starter()
    if len(sys.argv) == 1 and sys.stdin.isatty() and sys.stdout.isatty():
        sys.argv.append("start")
    warnings.filterwarnings("default", category=RenamedSetting)
    warnings.showwarning = tell_warning
    try:
        code = app(standalone_mode=False)
    except typer.TyperException as error:
        code = refuse_usage(error)
    except (typer.Abort, KeyboardInterrupt, Terminated) as error:
        code = code_of_stop(error)
    except Exception as error:
        log.debug("refused", exc_info=error)
        complain(console, told(error))
        code = code_of(error)
    if code in STOPS:  # typer may have made a code of Ctrl-C
        complain(console, WORD)
    sys.exit(code or 0)


def tell_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """A renamed setting is reported in one line; libraries' warnings in Python's form."""
    if issubclass(category, RenamedSetting):
        warn(console, str(message))
    else:
        print(
            warnings.formatwarning(message, category, filename, lineno, line),
            file=file or sys.stderr,
            end="",
        )


def refuse_usage(error: typer.TyperException) -> int:
    """Report an invalid command line in one line; a command without arguments shows its help."""
    text = error.format_message()
    if text.startswith("Usage:"):
        print(text, file=sys.stderr)
        return 2
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "tritrack"
    for theirs, ours in PLAIN.items():
        text = text.replace(theirs, ours)
    text = text.rstrip(".")
    complain(console, f"{text}; see: {command} --help")
    return 2


if __name__ == "__main__":
    main()
