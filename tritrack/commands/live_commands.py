"""The live commands: a whole run on this machine, or one process of a rig spread over hosts."""

from pathlib import Path
from typing import Annotated, Final, Literal

import msgspec
import typer

from common.bus.messages import MOST_PEOPLE, MOST_VIEWS
from common.config import config_file
from common.config.part_settings import BusSettings, SettingsError
from common.config.settings import Settings
from common.npz_file import Facts
from runtime.overrides import overridden
from runtime.terminal import counted
from tritrack.commands.command_output import JsonWanted, console, tell
from tritrack.commands.options import (
    Force,
    LandmarkSource,
    ModeName,
    Offset,
    Out,
    People,
    Record,
    Size,
)
from tritrack.extras import refuse_without

Wait = Annotated[
    bool, typer.Option(help="A clip begins when the page is opened, or half a minute later.")
]
LAST: Final = Path("runs/live")
"""Default folder of the last live run, of any source."""
ConfigPath = Annotated[Path, typer.Argument(help="A settings file (TOML), or a clip folder.")]


def demo(
    out: Out = Path("runs/demo"),
    page: Annotated[bool, typer.Option(help="Show it on the live page too.")] = True,
    wait: Wait = True,
    cameras: Annotated[
        int, typer.Option(min=1, max=MOST_VIEWS, help="How many cameras look at the people.")
    ] = 2,
    people: Annotated[
        int, typer.Option(min=1, max=MOST_PEOPLE, help="How many, who perform different postures.")
    ] = 1,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Run the whole system on synthetic people.

    Viewers, integrator, recognizer and page work as in a live run. More than one person are
    followed as by --people all.

    Example: tritrack demo --people 2 --cameras 3
    """
    if page:
        refuse_without("page", "websockets")
    from tritrack.demo import refuse_other_than_demo, run_demo

    if not force:
        refuse_other_than_demo(out)
    facts = run_demo(out, page, console, wait, cameras, people)
    tell(facts, json_wanted, f"{_named(facts)}; written to {out}")


def live(
    settings_file: ConfigPath,
    out: Out = LAST,
    mode: ModeName = None,
    size: Size = None,
    landmarks: LandmarkSource = None,
    people: People = None,
    offset: Offset = None,
    record: Record = False,
    record_pictures: Annotated[
        bool, typer.Option(help="Keep what each camera shows, as a clip in the run's folder.")
    ] = False,
    wait: Wait = True,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Track live, on cameras or recorded clips. Ctrl-C ends it.

    Clips run at their own pace.

    Example: tritrack live configs/live.toml --out runs/monday
    """
    from common.video.clip_sources import refuse_no_source
    from runtime.live.session import live as run_live

    own = config_file.load(settings_file)
    refuse_no_source(own, settings_file)
    given = overridden(own, mode, size, landmarks, offset, people=people)
    settings = waiting(given, wait)
    if not force:
        _refuse_other_than_last(out, settings)
    name = settings_file.stem if settings_file.is_file() else ""
    facts = run_live(settings, out, console, name, record, pictures=record_pictures)
    tell(facts, json_wanted, f"{_named(facts)}; written to {out}")


def _named(facts: Facts) -> str:
    """The posture that was named last, of several people each one's."""
    if several := facts.get("postures"):
        return "postures: " + ", ".join(f"{name} by {who}" for who, name in several.items())
    return f"posture: {facts['posture'] or 'none'}"


def _refuse_other_than_last(out: Path, settings: Settings) -> None:
    """Refuse to overwrite a run other than the last one, and report that one's replacement."""
    from common.video.clip_sources import sources_of
    from runtime.live.run_folder import refuse_kept_pictures
    from runtime.store.other_run import other_than, refuse_other, run_of

    refuse_kept_pictures(out)
    now = run_of("live", [view.source for view in sources_of(settings)])
    if out != LAST:
        refuse_other(out, now)
        return
    other = other_than(out, now)
    if other is not None:
        line = f"{out} holds another run ({other.told}): this one replaces it"
        console.print(line, markup=False, highlight=False, soft_wrap=True)


def serve(
    sites_file: Annotated[Path, typer.Argument(help="The sites (TOML): names and settings.")],
) -> None:
    """Track live in several rooms, until stopped.

    Each has its own settings. SIGHUP reads the file of sites anew.

    Example: tritrack serve configs/sites.toml
    """
    from runtime.serving.serve import serve as serve_sites

    serve_sites(sites_file, console)


def view(
    settings_file: ConfigPath,
    viewer: Annotated[int, typer.Option(min=1, max=MOST_VIEWS, help="The camera's number.")],
) -> None:
    """Run one viewer alone, of a rig spread over hosts.

    Example: tritrack view configs/live.toml --viewer 1
    """
    from common.video.clip_sources import refuse_no_source
    from viewer.__main__ import main as viewer_main

    settings = live_settings(settings_file)
    refuse_no_source(settings, settings_file)  # before the integrator answers
    viewer_main(settings, viewer)


def integrate(settings_file: ConfigPath) -> None:
    """Run the integrator alone: the others connect to it.

    Example: tritrack integrate configs/live.toml
    """
    from integrator.__main__ import main as integrator_main
    from runtime.live.elsewhere import whole_clip
    from runtime.offline.lockstep import measured_before

    settings = live_settings(settings_file)
    clip = whole_clip(settings)
    integrator_main(settings, msgspec.structs.replace(clip, body=measured_before(settings)))


def recognize(settings_file: ConfigPath) -> None:
    """Run the recognizer alone.

    Example: tritrack recognize configs/live.toml
    """
    from recognizer.__main__ import main as recognizer_main
    from runtime.live.elsewhere import whole_clip

    settings = live_settings(settings_file)
    clip = whole_clip(settings)
    recognizer_main(settings, clip.every / clip.views[0].fps)


def metrics(settings_file: ConfigPath) -> None:
    """Serve figures and health alone: /metrics, /healthz.

    It runs on the integrator's host.

    Example: tritrack metrics configs/live.toml
    """
    from runtime.live.elsewhere import whole_clip
    from runtime.live.free_ports import refuse_held_metrics
    from runtime.live.process_table import names_of

    settings = live_settings(settings_file)
    if not settings.metrics:
        raise SettingsError(f'{settings_file} has no metrics: add metrics = "127.0.0.1:9464"')
    refuse_held_metrics(settings.metrics)
    from runtime.outside.metrics_process import main as metrics_main

    metrics_main(settings, names_of(whole_clip(settings)))


def animate(settings_file: ConfigPath) -> None:
    """Run the live page alone.

    Example: tritrack animate configs/live.toml
    """
    from animator.__main__ import main as animator_main
    from runtime.live.free_ports import refuse_held_page

    settings = live_settings(settings_file)
    refuse_held_page(settings)
    animator_main(settings)


def waiting(settings: Settings, wait: bool) -> Settings:
    """The settings of a run that waits for its page only where settings and command agree."""
    page = msgspec.structs.replace(settings.page, wait=settings.page.wait and wait)
    return msgspec.structs.replace(settings, page=page)


def bridge(
    protocol: Annotated[
        Literal["osc", "vmc", "lsl", "websocket"], typer.Argument(help="Protocol to send by.")
    ],
    to: Annotated[
        str,
        typer.Option(
            help="HOST:PORT to send to, of a WebSocket to listen at; else this machine, 9000, "
            "of VMC 39539, of a WebSocket 8765."
        ),
    ] = "",
    endpoint: Annotated[str, typer.Option(help="Bus address of the run.")] = BusSettings().endpoint,
    room: Annotated[str, typer.Option(help="Room name of the run.")] = Settings().room,
    keys: Annotated[str, typer.Option(help="Folder of a client's keys, for a tls endpoint.")] = "",
    json_wanted: JsonWanted = False,
) -> None:
    """Send poses and postures by OSC, VMC, LSL or WebSocket.

    It waits for the run, a minute at most, and ends with it. LSL is the Lab Streaming Layer.

    Example: tritrack bridge vmc --to 127.0.0.1:39539
    """
    from runtime.bridges.bridging import bridge as run_bridge

    port = {"vmc": 39539, "websocket": 8765}.get(protocol, 9000)
    there = to or f"127.0.0.1:{port}"
    sent = run_bridge(protocol, endpoint, room, there, console, keys)
    tell({"bodies": sent}, json_wanted, f"{counted(sent, 'body', 'bodies')} sent")


def live_settings(path: Path) -> Settings:
    """The settings for one process of a live run."""
    from runtime.live.admission import refuse_mode

    settings = config_file.load(path)
    refuse_mode(settings)
    return settings
