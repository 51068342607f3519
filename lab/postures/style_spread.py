"""How differently performers move: the spread of their styles, as synthetic clips note them."""

import json
from collections.abc import Sequence
from pathlib import Path

from common.npz_file import Facts
from lab.posture_models.evaluation import Recording


def spread_of(given: Sequence[Recording]) -> dict[str, tuple[float, float]]:
    """Least and largest of each entry of `style` in the clips' `meta.json`; empty where none says.

    amp, speed, phase, lean and carry are what the performers of an experiment must differ in.
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
