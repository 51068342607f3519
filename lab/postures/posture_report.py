"""One recogniser's part of a posture report: counts, intervals, margins, the worst clips."""

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from common.npz_file import Facts
from lab.posture_models.evaluation import Outcome, confusion, table, wilson
from recognizer.postures import POSTURES

WORST: Final = 6
"""Largest number of clips shown as pictures."""


def result_of(outcomes: Sequence[Outcome], least_fit: float) -> Facts:
    """One recogniser's part of `report.json`.

    Args:
        outcomes: Results of all tested people.
        least_fit: Log-likelihood per frame below which a posture counts as unknown.
    """
    known = [one for one in outcomes if one.known]
    names = postures_of(known)
    counts = confusion(known, names)
    return {
        "all": share(known),
        "postures": _shares(known, lambda one: one.truth, names),
        "movements": _shares(known, lambda one: POSTURES.get(one.truth, "other")),
        "performers": _shares(known, lambda one: one.performer),
        "confusion": {"named": [*names, ""], "counts": counts.tolist()},
        "margins": _margins(known),
        "rejection": _rejection(outcomes, least_fit),
        "worst": [_told(one) for one in worst_of(known)],
        "table": table(counts, names),
    }


def postures_of(outcomes: Sequence[Outcome]) -> list[str]:
    """The performed postures: ours in the order of table 2, then a user's own."""
    seen = {one.truth for one in outcomes}
    return [*(name for name in POSTURES if name in seen), *sorted(seen - set(POSTURES))]


def share(outcomes: Sequence[Outcome]) -> Facts:
    """Correct of tested with Wilson's 95 % interval (P59)."""
    correct, tested = sum(one.truth == one.named for one in outcomes), len(outcomes)
    return {
        "correct": correct,
        "tested": tested,
        "share": correct / tested if tested else 0.0,
        "interval_95": wilson(correct, tested),
    }


def worst_of(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The mistakes, then the closest results: the lowest margins first, WORST at most."""
    told = [one for one in outcomes if not math.isnan(one.margin)]
    return sorted(told, key=lambda one: (one.truth == one.named, one.margin))[:WORST]


def _shares(
    outcomes: Sequence[Outcome], kind: Callable[[Outcome], str], kinds: Sequence[str] = ()
) -> Facts:
    every = kinds or sorted({kind(one) for one in outcomes})
    return {name: share([one for one in outcomes if kind(one) == name]) for name in every}


def _margins(outcomes: Sequence[Outcome]) -> Facts:
    """Of the log-likelihood per frame: how clear the decisions were."""
    margins = np.array([one.margin for one in outcomes if not math.isnan(one.margin)])
    if not len(margins):
        return {}
    low, median, high = np.percentile(margins, [5, 50, 95]).tolist()
    return {"p5": low, "median": median, "p95": high, "lowest": float(margins.min())}


def _rejection(outcomes: Sequence[Outcome], least_fit: float) -> Facts:
    """How often a trained posture gets no name, and how often each posture would get none
    without its training."""
    known = [one for one in outcomes if one.known]
    unknown = {}
    for name in postures_of(outcomes):
        fits = [one.fit_of_others for one in outcomes if one.truth == name]
        unknown[name] = {"tested": len(fits), "no_name": sum(fit < least_fit for fit in fits)}
    return {
        "least_fit": least_fit,
        "known": {"tested": len(known), "no_name": sum(one.fit < least_fit for one in known)},
        "unknown": unknown,
    }


def _told(one: Outcome) -> Facts:
    return {
        "clip": one.clip,
        "performer": one.performer,
        "truth": one.truth,
        "named": one.named,
        "margin": round(one.margin, 3),
        "fit": round(one.fit, 3),
    }
