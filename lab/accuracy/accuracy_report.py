"""The page of a tracking report: tables, plots and the worst frames, usable offline."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

from common.npz_file import Facts
from common.templates import rendered
from runtime.terminal import counted

IDENTITIES: Final = ("IDF1", "AssA", "MOTA")
"""Measures of how well people are kept apart."""


def headline(report: Facts) -> Facts:
    """The main figures."""
    return {
        **report["all"],
        "silhouettes_iou": report["silhouettes"]["mean"],
        "confidence_auc": report["confidence"]["auc"]["all"],
        "confidence_gap": report["confidence"]["gap"],
        "body_lengths_mm": report["lengths"]["body"]["all"]["off_mm"],
        "median_lengths_mm": report["lengths"]["medians"]["all"]["off_mm"],
        **({"identities": report["identities"]["all"]} if "identities" in report else {}),
    }


def line(report: Facts) -> str:
    """The headline in words."""
    told = report["all"]
    return (
        f"{counted(told['clips'], 'clip')}, {told['frames']} frames: "
        f"mean {_number(told['abs_mm']['mean'])} mm{_between(told['between']['abs_mm'], 'mean')}, "
        f"median {_number(told['abs_mm']['median'])}, inner angles "
        f"{_number(told['angle_deg']['all'])} degrees, lost {_share(told['lost'])}, silhouettes "
        f"{_number(report['silhouettes']['mean'], 3)}{_apart(report)}"
    )


def _apart(report: Facts) -> str:
    """How well people are kept apart, in words; "" where each clip has one person."""
    if "identities" not in report:
        return ""
    told = report["identities"]["all"]
    figures = ", ".join(f"{name} {_number(told[name.lower()], 3)}" for name in IDENTITIES)
    return f"; {figures}, {counted(told['switches'], 'switch', 'switches')}"


def page_of(report: Facts) -> str:
    """The report as a page; its pictures are beside it."""
    given = {"identities": {}, **report, "number": _number, "percent": _share, "between": _between}
    return rendered(__package__, "accuracy_report.html", given)


def _number(value: float, places: int = 1) -> str:
    return "-" if math.isnan(value) else f"{value:.{places}f}"


def _between(told: Mapping[str, Sequence[float]], name: str) -> str:
    """The interval of a figure, in brackets; "" without one."""
    if name not in told:
        return ""
    low, high = told[name]
    return f" ({_number(low)} to {_number(high)})"


def _share(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.1%}"
