"""Variation between performers: the range of their styles, from synthetic clips' metadata."""

import json
from collections.abc import Sequence
from pathlib import Path

from common.npz_file import Facts
from lab.posture_models.evaluation import Recording


def spread_of(given: Sequence[Recording]) -> dict[str, tuple[float, float]]:
    """Smallest and largest value of each entry of `style` in the clips' `meta.json`; empty without
    any.

    Performers of an experiment must differ in amp, speed, phase, lean and carry.
    """
    styles = [_style(Path(one.clip) / "meta.json") for one in given]
    names = dict.fromkeys(name for style in styles for name in style)
    found = {}
    for name in names:
        values = [float(style[name]) for style in styles if name in style]
        found[name] = (min(values), max(values))
    return found


def _style(path: Path) -> Facts:
    try:
        style = json.loads(path.read_text()).get("style", {})
    except (OSError, ValueError, AttributeError):
        return {}
    return {name: value for name, value in dict(style).items() if isinstance(value, int | float)}
