"""A body with the bones of the Anny model, for where that is not installed."""

from typing import Final

import numpy as np

from common.body.body import Vector
from synth.anny_people.anatomy import Anatomy
from synth.anny_people.figures import Figure

TRUNK: Final = {
    "root": (0.0, 0.95, 0.0),
    "spine05": (0.0, 1.0, 0.01),
    "spine04": (0.0, 1.08, 0.0),
    "spine03": (0.0, 1.16, -0.01),
    "spine02": (0.0, 1.25, -0.01),
    "spine01": (0.0, 1.34, 0.0),
    "neck01": (0.0, 1.42, -0.02),
    "neck02": (0.0, 1.46, -0.01),
    "neck03": (0.0, 1.5, 0.0),
    "head": (0.0, 1.54, 0.0),
}
LEG: Final = {
    "pelvis": (0.05, 0.93, 0.0),
    "upperleg01": (0.09, 0.92, 0.0),
    "upperleg02": (0.095, 0.7, 0.005),
    "lowerleg01": (0.1, 0.48, 0.01),
    "lowerleg02": (0.105, 0.27, -0.01),
    "foot": (0.11, 0.07, -0.03),
    "toe3-1": (0.13, 0.03, 0.1),
}
ARM: Final = {
    "clavicle": (0.03, 1.4, 0.01),
    "shoulder01": (0.1, 1.41, 0.0),
    "upperarm01": (0.17, 1.38, -0.01),
    "upperarm02": (0.26, 1.265, -0.005),
    "lowerarm01": (0.35, 1.15, 0.0),
    "lowerarm02": (0.425, 1.05, 0.05),
    "wrist": (0.5, 0.95, 0.1),
}
FINGERS: Final = tuple((finger, joint) for finger in (2, 3, 4, 5) for joint in (1, 2, 3))
RIGHT: Final = (-1.06, 1.0, 1.0)
"""Its right side is wider than its left."""


def heads() -> dict[str, Vector]:
    """Where its bones begin, at rest; the order is the model's: what is above comes first."""
    found = {name: np.array(at) for name, at in TRUNK.items()}
    for side in "LR":
        turn = np.ones(3) if side == "L" else np.array(RIGHT)
        found[f"eye.{side}"] = turn * [0.03, 1.62, 0.09]
        found |= {f"{name}.{side}": turn * at for name, at in {**LEG, **ARM}.items()}
        wrist, elbow = np.array(ARM["wrist"]), np.array(ARM["lowerarm01"])
        along = (wrist - elbow) / np.linalg.norm(wrist - elbow)
        for finger, joint in FINGERS:
            at = wrist + (0.06 + 0.03 * joint) * along + [0.0, 0.0, 0.03 - 0.02 * (finger - 2)]
            found[f"finger{finger}-{joint}.{side}"] = turn * at
    return found


def above(name: str) -> str:
    """The bone that another one hangs on; "" for the first."""
    bone, _, side = name.partition(".")
    chain = [*({"L": LEG, "R": LEG}.get(side, TRUNK))]
    if bone.startswith("finger"):
        finger, joint = bone.removeprefix("finger").split("-")
        up = "wrist" if joint == "1" else f"finger{finger}-{int(joint) - 1}"
    elif bone in ARM:
        chain = [*ARM]
        up = chain[chain.index(bone) - 1] if bone != "clavicle" else "spine01"
    elif bone == "eye":
        up = "head"
    elif bone == "pelvis":
        up = "root"
    else:
        place = chain.index(bone)
        up = chain[place - 1] if place else ""
    return up if up in TRUNK or not up else f"{up}.{side}"


BONES: Final = tuple(heads())
PARENTS: Final = tuple(BONES.index(above(name)) if above(name) else -1 for name in BONES)


def hanging_on(named: list[tuple[str, tuple[float, float, float]]]) -> tuple[Anatomy, Figure]:
    """A puppet of some vertices, each wholly on one bone; three in a row are a face."""
    places = np.array([at for _, at in named])
    weights = np.zeros((len(named), len(BONES)))
    weights[np.arange(len(named)), [BONES.index(name) for name, _ in named]] = 1.0
    faces = np.arange(3)[None] + np.arange(len(named) - 2)[:, None]
    kept = np.arange(len(named))
    return Anatomy(None, kept, faces, weights, BONES, PARENTS), Figure(places, heads())


def puppet() -> tuple[Anatomy, Figure]:
    """One with a dozen vertices about each bone, a crown at 1.74 m and soles at 0."""
    rng, named = np.random.default_rng(5), []
    for name, at in heads().items():
        named += [(name, tuple((at + rng.normal(0.0, 0.02, 3)).tolist())) for _ in range(12)]
    named += [("head", (0.0, 1.74, -0.01)), ("foot.L", (0.1, 0.0, 0.0))]
    known, figure = hanging_on(named)
    return known, Figure(figure.vertices_m.clip(min=[-9.0, 0.0, -9.0]), figure.heads_m)
