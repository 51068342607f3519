"""What the page says beside the room: posture, views, body and processes, as pieces of HTML."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from animator.scene import LEFT, RIGHT, TRUNK, Colour
from common.bus.control_messages import Pulse
from common.bus.messages import Body, Facing, Performance, Posture, Report, Status
from common.templates import rendered

ACCENT: Final[Colour] = (62, 142, 126)

STATUS_WORDS: Final[dict[Status, tuple[str, Colour]]] = {
    "empty": ("nobody in view", (150, 157, 166)),
    "measuring": ("measuring the body", RIGHT),
    "tracking": ("tracking", ACCENT),
    "predicted": ("predicted, not seen", LEFT),
    "lost": ("lost, searching", (192, 80, 70)),
}
FACING_WORDS: Final[dict[Facing, str]] = {"facade": "front or back", "flank": "side"}


def posture_headline(posture: Posture | None) -> str:
    """The posture's name, large; pale while nobody performs it: the nearest of the names then."""
    if posture is None or not posture.doing:
        name = posture.name if posture else ""
        return piece("posture.html", {"name": name, "times": 1, "colour": "inherit;opacity:.62"})
    given = {"name": posture.doing, "times": posture.times, "colour": _rgb(ACCENT)}
    return piece("posture.html", given)


def events_list(performances: Sequence[Performance]) -> str:
    """The last performances that are over, the newest first."""
    return piece("events.html", {"performances": performances}) if performances else ""


def likelihood_bars(posture: Posture | None) -> str:
    """log P of every posture as bars, the likeliest first.

    The likeliest fills its bar, the middle one half of it: so the scale needs no tuning.
    """
    values = posture.log_likelihoods if posture else {}
    names = sorted(values, key=values.__getitem__, reverse=True)
    ranked = [values[name] for name in names]
    rows = list(zip(names, ranked, bar_shares(ranked), strict=True))
    segment = posture.segment if posture else None
    return piece("likelihoods.html", {"rows": rows, "segment": segment, "colour": _rgb(ACCENT)})


def bar_shares(ranked: Sequence[float]) -> list[float]:
    """How far each bar is filled, in [0, 1], for log-likelihoods sorted from the best down."""
    if not ranked:
        return []
    span = 2.0 * (ranked[0] - ranked[len(ranked) // 2])
    return [
        1.0 if value == ranked[0] else max(0.0, 1.0 - (ranked[0] - value) / span) if span else 0.0
        for value in ranked
    ]


def views_table(body: Body | None, reports: Mapping[int, Report], cameras: int) -> str:
    """What each camera sees of the body, how well the model covers it, and what is in the way."""
    posed = body if body and body.pose else None
    views = [
        (
            FACING_WORDS[posed.facing[n]] if posed else "–",
            posed.score[n] if posed else 0.0,
            _hint(body, reports.get(n + 1)),
        )
        for n in range(cameras)
    ]
    return piece("views.html", {"views": views, "colour": _rgb(ACCENT)})


def status_line(body: Body | None, pulses: Iterable[Pulse]) -> str:
    """State of the tracking, frame, rate of the slowest process and latency of the latest."""
    words, colour = STATUS_WORDS[body.status if body else "empty"]
    running = [pulse for pulse in pulses if pulse.state == "running"]
    facts = [f"frame {body.frame}", f"{body.captured_s:.1f} s"] if body else []
    if running:
        facts.append(f"{min(pulse.fps for pulse in running):.1f} fps")
        facts.append(f"{max(pulse.latency_p50_ms for pulse in running):.0f} ms latency")
    return piece("status.html", {"words": words, "colour": _rgb(colour), "facts": facts})


def pulse_table(pulses: Iterable[Pulse]) -> str:
    """How each process is doing."""
    by_name = sorted(pulses, key=lambda each: each.process)
    return piece("processes.html", {"pulses": by_name})


def legend() -> str:
    """Which colour means what."""
    sides = {"left": _rgb(LEFT), "right": _rgb(RIGHT), "trunk": _rgb(TRUNK)}
    return piece("legend.html", {"sides": sides})


def piece(name: str, given: Mapping[str, Any]) -> str:
    """A template of the page filled in."""
    return rendered("animator.page", name, given)


def _hint(body: Body | None, report: Report | None) -> str:
    """What the person could do about what this camera sees."""
    if report is None:
        return "nothing heard from it"
    if report.cut:
        return "the person is partly outside the picture"
    return report.refusal if body and body.status == "measuring" else ""


def _rgb(colour: Colour) -> str:
    return "rgb({},{},{})".format(*colour)
