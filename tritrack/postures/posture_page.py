"""A posture report as a page that needs nothing but itself."""

import html
from base64 import b64encode
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

STYLE: Final = (
    "body{font:14px sans-serif;margin:2em}table{border-collapse:collapse;margin:1em 0}"
    "td,th{border:1px solid #ccc;padding:3px 8px;text-align:right}"
    "th:first-child{text-align:left}img{max-width:100%}"
)

PAPERS: Final = {"correct": 332, "tested": 360, "share": 332 / 360, "interval_95": (0.890, 0.946)}
"""Table 2 of the paper, all postures."""

Result = dict[str, Any]


def page_of(report: dict[str, Any], folder: Path) -> str:
    """The whole page.

    Args:
        report: What `report.json` holds.
        folder: Where the pictures that it names are; they become part of the page.

    Raises:
        OSError: When a picture cannot be read.
    """
    results: dict[str, Result] = report["recognizers"]
    title = f"Postures: {report['split']}"
    parts = [
        f"<h1>{html.escape(title)}</h1>{_people(report['people'])}",
        _side_by_side(results, "postures"),
        _beside(results),
        *(_side_by_side(results, kind) for kind in ("movements", "performers")),
        _sweep(report.get("sweep")),
        *(_details(name, result, folder) for name, result in results.items()),
        _styles(report["people"]),
    ]
    return (
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style>{''.join(parts)}</html>\n"
    )


def _people(groups: dict[str, Any]) -> str:
    lines = [
        f"{group['clips']} clips of {len(group['performers'])} performers {name}: "
        f"{', '.join(group['performers'])}"
        for name, group in groups.items()
    ]
    return "".join(f"<p>{html.escape(line)}.</p>" for line in lines)


def _side_by_side(results: dict[str, Result], kind: str) -> str:
    """A line for each posture, movement or performer, the recognisers beside each other."""
    kinds = list(dict.fromkeys(name for result in results.values() for name in result[kind]))
    heads = "".join(
        f"<th>{html.escape(name)} recogniser, {html.escape(result['mode'])} mode"
        "<th>share<th>95 % interval"
        for name, result in results.items()
    )
    lines = [_line(name, (result[kind].get(name) for result in results.values())) for name in kinds]
    lines.append(_line("all", (result["all"] for result in results.values())))
    if kind == "postures":
        lines.append(_line("the paper's table 2", [PAPERS] * len(results)))
    return f"<h2>{kind.capitalize()}</h2><table><tr><th>{kind[:-1]}{heads}{''.join(lines)}</table>"


def _beside(results: dict[str, Result]) -> str:
    """Leave-one-performer-out within the test set, where it was done."""
    within = {name: result["within_test"] for name, result in results.items()}
    if not all(within.values()):
        return ""
    heads = "".join(f"<th>{html.escape(name)}<th>share<th>95 % interval" for name in within)
    return (
        "<h2>Beside it: each of the tested named by a model of the other tested</h2>"
        f"<table><tr><th>{heads}{_line('all', (each['all'] for each in within.values()))}</table>"
    )


def _line(name: str, shares: Iterable[dict[str, Any] | None]) -> str:
    return f"<tr><th>{html.escape(name)}{''.join(map(_share, shares))}"


def _share(share: dict[str, Any] | None) -> str:
    if share is None:
        return "<td><td><td>"
    low, high = share["interval_95"]
    return (
        f"<td>{share['correct']}/{share['tested']}"
        f"<td>{share['share']:.1%}<td>{low:.1%} to {high:.1%}"
    )


def _sweep(sweep: dict[str, Any] | None) -> str:
    if sweep is None:
        return ""
    heads = "".join(f"<th>{states} states" for states in sweep["states"])
    lines = "".join(
        f"<tr><th>{symbols} symbols"
        + "".join(f"<td>{one['correct']}/{one['tested']}" for one in shares)
        for symbols, shares in zip(sweep["symbols"], sweep["shares"], strict=True)
    )
    return f"<h2>The paper's recogniser in other sizes</h2><table><tr><th>{heads}{lines}</table>"


def _details(name: str, result: Result, folder: Path) -> str:
    """Confusion, margins and worst clips of one recogniser."""
    told = html.escape(name)
    margins = "".join(f"<tr><th>{key}<td>{value:.2f}" for key, value in result["margins"].items())
    return (
        f"<h2>{told} recogniser: shown and named</h2>"
        f"{_picture(result['picture'], folder, f'confusion matrix of the {name} recogniser')}"
        "<h3>Margins: log-likelihood of a frame above the next posture's</h3>"
        f"<table>{margins}</table>{_rejection(result)}<h3>Worst clips</h3>"
        f"{''.join(_worst(one, folder) for one in result['worst'])}"
    )


def _rejection(result: Result) -> str:
    """What gets no name, taught or not."""
    told = result["rejection"]
    lines = "".join(
        f"<tr><th>{html.escape(name)}<td>{count['no_name']}/{count['tested']}"
        for name, count in told["unknown"].items()
    )
    return (
        "<h3>Rejection</h3><p>A motion whose frames have a log-likelihood below "
        f"{told['least_fit']} on average is none that was taught. Rejected so: "
        f"{told['known']['no_name']} of {told['known']['tested']} that were taught; and of a "
        f"posture that nobody taught:<table><tr><th>posture<th>no name{lines}</table>"
    )


def _worst(one: dict[str, Any], folder: Path) -> str:
    told = (
        f"{one['clip'] or one['performer']}: {one['truth']} named {one['named']}, "
        f"margin {one['margin']:.2f}"
    )
    picture = _picture(one["picture"], folder, told) if "picture" in one else ""
    return f"<p>{html.escape(told)}<br>{picture}</p>"


def _picture(name: str, folder: Path, told: str) -> str:
    data = b64encode((folder / name).read_bytes()).decode()
    return f'<img alt="{html.escape(told)}" src="data:image/png;base64,{data}">'


def _styles(groups: dict[str, Any]) -> str:
    """How widely each group's styles are spread."""
    names = dict.fromkeys(name for group in groups.values() for name in group["styles"])
    if not names:
        return ""
    heads = "".join(f"<th>{html.escape(name)}: least<th>largest" for name in groups)
    lines = "".join(
        f"<tr><th>{html.escape(name)}"
        + "".join(_ends(group["styles"].get(name)) for group in groups.values())
        for name in names
    )
    return f"<h2>How differently they move</h2><table><tr><th>{heads}{lines}</table>"


def _ends(ends: tuple[float, float] | None) -> str:
    return "<td><td>" if ends is None else f"<td>{ends[0]:.2f}<td>{ends[1]:.2f}"
