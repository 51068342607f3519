"""The page of a tracking report: tables, plots and the worst frames, readable without network."""

import html
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

STYLE: Final = (
    "body{font:14px sans-serif;margin:2em;max-width:85em}table{border-collapse:collapse}"
    "td,th{border:1px solid #ccc;padding:3px 8px;text-align:right}th:first-child{text-align:left}"
    "figure{display:inline-block;margin:1em 1em 0 0}img{max-width:100%}figcaption{margin:.3em 0}"
)
HEAD: Final = (
    "frames",
    "mean mm",
    "median",
    "p95",
    "root-aligned mm",
    "similarity-aligned mm",
    "inner angles deg",
    "lost",
    "coverage",
    "ghost",
)


def headline(report: Mapping[str, Any]) -> dict[str, Any]:
    """The figures that are looked at first."""
    return {
        **report["all"],
        "silhouettes_iou": report["silhouettes"]["mean"],
        "confidence_auc": report["confidence"]["auc"]["all"],
        "confidence_gap": report["confidence"]["gap"],
        "body_lengths_mm": report["lengths"]["body"]["all"]["off_mm"],
        "median_lengths_mm": report["lengths"]["medians"]["all"]["off_mm"],
    }


def line(report: Mapping[str, Any]) -> str:
    """The headline in words."""
    told = report["all"]
    return (
        f"{told['clips']} clips, {told['frames']} frames: mean {_number(told['abs_mm']['mean'])} "
        f"mm, median {_number(told['abs_mm']['median'])}, inner angles "
        f"{_number(told['angle_deg']['all'])} degrees, lost {_share(told['lost'])}, silhouettes "
        f"{_number(report['silhouettes']['mean'], 3)}"
    )


def page_of(report: Mapping[str, Any]) -> str:
    """The report as a page; its pictures stand beside it."""
    title = f"Tracking: {', '.join(report['mode'])}, {', '.join(report['size'])}"
    parts = [
        _errors("", {"all": report["all"]}),
        _plots(report["plots"]),
        _errors("Performers", report["per_performer"]),
        _errors("Postures", report["per_posture"]),
        _joints(report),
        _silhouettes(report["silhouettes"]),
        _lengths(report["lengths"]),
        _reliability(report["confidence"]),
        _worst(report["worst"]),
        _errors("Clips", report["per_clip"]),
    ]
    return (
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style><h1>{html.escape(title)}</h1>{''.join(parts)}</html>\n"
    )


def _errors(title: str, groups: Mapping[str, Mapping[str, Any]]) -> str:
    rows = [
        (
            name or "unnamed",
            str(told["frames"]),
            *(_number(told["abs_mm"][kind]) for kind in ("mean", "median", "p95")),
            _number(told["root_mm"]["mean"]),
            _number(told["pa_mm"]["mean"]),
            _number(told["angle_deg"]["all"]),
            *(_share(told[kind]) for kind in ("lost", "coverage", "ghost")),
        )
        for name, told in groups.items()
    ]
    return _table(title, ("", *HEAD), rows)


def _joints(report: Mapping[str, Any]) -> str:
    area = report["confidence"]["auc"]
    rows = [
        (name, *(_number(off[kind]) for kind in ("mean", "median", "p95")), _number(area[name], 2))
        for name, off in report["per_joint"].items()
    ]
    head = ("", "mean mm", "median", "p95", "area under ROC of confidence")
    return _table("Joints", head, rows)


def _silhouettes(told: Mapping[str, Any]) -> str:
    means = {"all": told["mean"], "worst view of a clip": told["worst"], **told["per_performer"]}
    rows = [(name or "unnamed", _number(value, 3)) for name, value in means.items()]
    each = [
        (name, *(_number(views.get(kind, math.nan), 3) for kind in ("cam1", "cam2", "both")))
        for name, views in told["per_clip"].items()
    ]
    title = f"Silhouettes: intersection over union; ghosts {_share(told['ghost'])}"
    return _table(title, ("", "mean"), rows) + _folded(
        "of each clip", _table("", ("", "camera 1", "camera 2", "both"), each)
    )


def _lengths(told: Mapping[str, Any]) -> str:
    rows = [
        (
            name,
            *(_number(told[what][name][kind]) for what in told for kind in ("off_mm", "bias_mm")),
        )
        for name in told["body"]
    ]
    told_of = ("measured body", "published joints", "their medians")
    head = ("", *(cell for what in told_of for cell in (f"{what}, mm off", "bias")))
    return _table("Lengths", head, rows)


def _reliability(told: Mapping[str, Any]) -> str:
    rows = [
        (
            f"{one['from']:.1f} to {one['to']:.1f}",
            str(one["count"]),
            _number(one["confidence"], 2),
            _number(one["near"], 2),
        )
        for one in told["bins"]
    ]
    title = (
        f"Confidence: area under ROC {_number(told['auc']['all'], 2)}, "
        f"furthest bin {_number(told['gap'], 2)} off"
    )
    return _table(title, ("", "joints", "mean", f"within {told['near_mm']:g} mm"), rows)


def _plots(told: Mapping[str, str]) -> str:
    return "".join(_figure(name, title) for title, name in told.items())


def _worst(told: Sequence[Mapping[str, Any]]) -> str:
    figures = [
        _figure(
            one["picture"],
            f"{one['clip']}, frame {one['frame']}: {one['mean_mm']:.0f} mm, "
            f"{one['joint']} {one['joint_mm']:.0f} mm",
        )
        for one in told
    ]
    return (
        "<h2>Worst frames</h2><p>True stick: left side light green, right side dark green; "
        f"tracked: left blue, right red.</p>{''.join(figures)}"
    )


def _figure(name: str, caption: str) -> str:
    return (
        f'<figure><img src="{html.escape(name)}" alt="{html.escape(caption)}">'
        f"<figcaption>{html.escape(caption)}</figcaption></figure>"
    )


def _table(title: str, head: Iterable[str], rows: Iterable[Sequence[str]]) -> str:
    top = "".join(f"<th>{html.escape(name)}" for name in head)
    body = "".join(
        f"<tr><th>{html.escape(name)}{''.join(f'<td>{html.escape(cell)}' for cell in cells)}"
        for name, *cells in rows
    )
    return f"{f'<h2>{html.escape(title)}</h2>' if title else ''}<table><tr>{top}{body}</table>"


def _folded(title: str, inside: str) -> str:
    return f"<details><summary>{html.escape(title)}</summary>{inside}</details>"


def _number(value: float, places: int = 1) -> str:
    return "-" if math.isnan(value) else f"{value:.{places}f}"


def _share(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.1%}"
