"""What the page says beside the room: posture, views, body and processes, as pieces of HTML."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Final

from animator.scene import LEFT, RIGHT, TRUNK, Colour
from common.bus.control_messages import Pulse
from common.bus.messages import Body, Facing, Performance, Posture, Report, Status

ACCENT: Final[Colour] = (62, 142, 126)
QUIET: Final = "opacity:.62;font-size:.85em"

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
    name = spoken(posture.name) if posture else ""
    if posture and posture.doing:
        times = f" × {posture.times}" if posture.times > 1 else ""
        name = f"{spoken(posture.doing)}{times}"
    colour = _rgb(ACCENT) if posture and posture.doing else "inherit;opacity:.62"
    shown = escape(name) or '<span style="opacity:.4">no posture yet</span>'
    style = f"font-size:1.65em;line-height:1.2;font-weight:650;color:{colour}"
    return block(f'<div style="{style}">{shown}</div>')


def events_list(performances: Sequence[Performance]) -> str:
    """The last performances that are over, the newest first."""
    rows = "".join(
        f"<div>{escape(spoken(one.name))}"
        f"{f' × {one.times}' if one.times > 1 else ''}"
        f' <span style="{QUIET}">{one.onset_s:.1f} to {one.end_s:.1f} s</span></div>'
        for one in reversed(performances)
    )
    title = f'<div style="{QUIET}">seen from beginning to end</div>'
    return block(title + rows) if rows else ""


def likelihood_bars(posture: Posture | None) -> str:
    """log P of every posture as bars, the likeliest first.

    The likeliest fills its bar, the middle one half of it: so the scale needs no tuning.
    """
    if posture is None or not posture.log_likelihoods:
        return block(f'<div style="{QUIET}">no log-likelihoods yet</div>')
    ranked = sorted(posture.log_likelihoods.items(), key=lambda item: -item[1])
    shares = bar_shares([value for _, value in ranked])
    rows = [
        _bar(escape(spoken(name)), share, f"{value:.1f}", strong=i == 0)
        for i, ((name, value), share) in enumerate(zip(ranked, shares, strict=True))
    ]
    first, last = posture.segment
    title = f'<div style="{QUIET}">log-likelihood of frames {first} to {last}</div>'
    return block(title + "".join(rows))


def bar_shares(ranked: list[float]) -> list[float]:
    """How far each bar is filled, in [0, 1], for log-likelihoods sorted from the best down."""
    span = 2.0 * (ranked[0] - ranked[len(ranked) // 2])
    return [
        1.0 if value == ranked[0] else max(0.0, 1.0 - (ranked[0] - value) / span) if span else 0.0
        for value in ranked
    ]


def views_table(body: Body | None, reports: Mapping[int, Report], cameras: int) -> str:
    """What each camera sees of the body, how well the model covers it, and what is in the way."""
    rows = []
    for n in range(1, cameras + 1):
        facing = FACING_WORDS[body.facing[n - 1]] if body and body.pose else "–"
        score = body.score[n - 1] if body and body.pose else 0.0
        rows.append(_bar(f"camera {n}: {facing}", score, f"{score:.2f}"))
        hint = _hint(body, reports.get(n))
        if hint:
            rows.append(f'<div style="{QUIET}">{escape(hint)}</div>')
    title = f'<div style="{QUIET}">what each camera sees, and its score</div>'
    return block(title + "".join(rows))


def status_line(body: Body | None, pulses: Iterable[Pulse]) -> str:
    """State of the tracking, frame, rate of the slowest process and latency of the latest."""
    words, colour = STATUS_WORDS[body.status if body else "empty"]
    running = [pulse for pulse in pulses if pulse.state == "running"]
    facts = [f"frame {body.frame}", f"{body.captured_s:.1f} s"] if body else []
    if running:
        facts.append(f"{min(pulse.fps for pulse in running):.1f} fps")
        facts.append(f"{max(pulse.latency_p50_ms for pulse in running):.0f} ms latency")
    return block(
        f'<div><span style="color:{_rgb(colour)}">●</span> <b>{words}</b></div>'
        f'<div style="{QUIET}">{" · ".join(facts)}</div>'
    )


def pulse_table(pulses: Iterable[Pulse]) -> str:
    """How each process is doing."""
    head = "".join(
        f'<th style="text-align:{side};font-weight:500;{QUIET}">{title}</th>'
        for title, side in (
            ("process", "left"),
            ("state", "left"),
            ("fps", "right"),
            ("ms p50 / p99", "right"),
            ("missed", "right"),
        )
    )
    rows = "".join(_pulse_row(pulse) for pulse in sorted(pulses, key=lambda each: each.process))
    return block(f'<table style="width:100%;font-size:.85em"><tr>{head}</tr>{rows}</table>')


def legend() -> str:
    """Which colour means what."""
    named = ((LEFT, "left"), (RIGHT, "right"), (TRUNK, "trunk"))
    marks = "  ".join(
        f'<span style="color:{_rgb(colour)}">■</span> {name}' for colour, name in named
    )
    return block(f'<div style="{QUIET}">{marks} · pale: not sure</div>')


def spoken(name: str) -> str:
    """A posture's name as one says it."""
    return name.replace("_", " ")


def _hint(body: Body | None, report: Report | None) -> str:
    """What the person could do about what this camera sees."""
    if report is None:
        return "nothing heard from it"
    if report.cut:
        return "the person is partly outside the picture"
    return report.refusal if body and body.status == "measuring" else ""


def _pulse_row(pulse: Pulse) -> str:
    missed = pulse.deadline_misses + pulse.dropped + pulse.late
    cells = (
        ("left", pulse.process),
        ("left", pulse.state),
        ("right", f"{pulse.fps:.1f}"),
        ("right", f"{pulse.latency_p50_ms:.0f} / {pulse.latency_p99_ms:.0f}"),
        ("right", str(missed)),
    )
    return (
        f'<tr title="{escape(pulse.detail)}">'
        + "".join(f'<td style="text-align:{side}">{escape(text)}</td>' for side, text in cells)
        + "</tr>"
    )


def _bar(name: str, share: float, number: str, strong: bool = False) -> str:
    weight, opacity = ("600", "1") if strong else ("400", ".45")
    return (
        f'<div style="display:flex;align-items:center;gap:.5em;font-weight:{weight};'
        f'font-size:.85em;line-height:1.5">'
        f'<div style="flex:0 0 54%;white-space:nowrap;overflow:hidden;text-overflow:ellipsis">'
        f"{name}</div>"
        f'<div style="flex:1;height:.6em;border-radius:.3em;background:rgba(128,138,150,.18)">'
        f'<div style="width:{100 * min(1.0, max(0.0, share)):.0f}%;height:100%;'
        f'border-radius:.3em;background:{_rgb(ACCENT)};opacity:{opacity}"></div></div>'
        f'<div style="flex:0 0 3.6em;text-align:right;font-variant-numeric:tabular-nums">'
        f"{number}</div></div>"
    )


def block(inside: str) -> str:
    """A piece of the panel, with its margins."""
    return f'<div style="padding:.15em .9em">{inside}</div>'


def _rgb(colour: Colour) -> str:
    return "rgb({},{},{})".format(*colour)
