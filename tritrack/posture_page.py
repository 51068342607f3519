"""A posture report as a page that needs nothing but itself."""

import html
from collections.abc import Iterable
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

STYLE: Final = (
    "body{font:14px sans-serif;margin:2em}table{border-collapse:collapse;margin:1em 0}"
    "td,th{border:1px solid #ccc;padding:3px 8px;text-align:right}"
    "th:first-child{text-align:left}table.counts thead th"
    "{writing-mode:vertical-rl;text-align:left}"
)

Result = dict[str, Any]


def page_of(report: dict[str, Any]) -> str:
    """The whole page."""
    results: dict[str, Result] = report["recognizers"]
    title = f"Postures: {report['split']}"
    return (
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style><h1>{html.escape(title)}</h1>"
        f"<p>{report['clips']} clips.</p>"
        f"{_side_by_side(results, 'postures')}"
        f"{_beside(results)}"
        f"{_side_by_side(results, 'movements')}{_side_by_side(results, 'performers')}"
        f"{''.join(_matrix(name, result) for name, result in results.items())}</html>\n"
    )


def _side_by_side(results: dict[str, Result], kind: str) -> str:
    """A line for each posture, movement or performer, the recognisers beside each other."""
    kinds = list(dict.fromkeys(name for result in results.values() for name in result[kind]))
    heads = "".join(
        f"<th>{html.escape(name)} recogniser, {result['mode']} mode<th>share<th>95 % interval"
        for name, result in results.items()
    )
    lines = [_line(name, (result[kind].get(name) for result in results.values())) for name in kinds]
    lines.append(_line("all", (result["all"] for result in results.values())))
    return f"<h2>{kind.capitalize()}</h2><table><tr><th>{kind[:-1]}{heads}{''.join(lines)}</table>"


def _beside(results: dict[str, Result]) -> str:
    """Leave-one-performer-out within the test set, where it was done."""
    within = {name: result["within_test"] for name, result in results.items()}
    if not all(within.values()):
        return ""
    line = _line("all", (result["all"] for result in within.values()))
    heads = "".join(f"<th>{html.escape(name)}<th>share<th>95 % interval" for name in within)
    return (
        "<h2>Beside it: each of the tested named by a model of the other tested</h2>"
        f"<table><tr><th>{heads}{line}</table>"
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


def _matrix(name: str, result: Result) -> str:
    """Shown and named, as counts."""
    named = [each or "no name" for each in result["confusion"]["named"]]
    counts = np.array(result["confusion"]["counts"])
    head = "".join(f"<th>{html.escape(each)}</th>" for each in named)
    lines = "".join(
        f"<tr><th>{html.escape(posture)}</th>{_cells(row)}</tr>"
        for posture, row in zip(result["postures"], counts, strict=True)
    )
    return (
        f"<h2>Shown (row), named (column): {html.escape(name)}</h2>"
        f"<table class=counts><thead><tr><th></th>{head}</tr></thead>{lines}</table>"
    )


def _cells(row: NDArray[np.int64]) -> str:
    """Cells the darker the larger their share of the row."""
    shares = row / max(int(row.sum()), 1)
    return "".join(
        f'<td style="background:rgba(40,90,200,{0.7 * share:.2f})">{count or ""}</td>'
        for count, share in zip(row.tolist(), shares.tolist(), strict=True)
    )
