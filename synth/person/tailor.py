"""Trunk, arms and legs in clothes: cloth is wider than the limb and ends in a hem."""

from typing import Final

import numpy as np

from common.body.body import Vector
from synth.person.people import Person
from synth.person.rings import Ring

SKIRT: Final = 3.2
"""Exponent of a hanging shirt's section: two thighs are behind its front."""
STEP_M: Final = 0.002
"""Length over which cloth ends: a hem is a step of the radius."""


def trunk(p: Person, at: dict[str, Vector]) -> list[Ring]:
    """From the crotch to the neck."""
    m, look = p.measures, p.look
    hip, navel = float(at["pelvis"][1]), float(at["chest"][1])
    top, tall, back = look.loose_top_m * 0.5, m["torso_m"], float(at["chest"][2])
    hem = hip - look.hem_m

    def ring(up: float, x: float, z: float, share: float, dz: float = 0.0, q: float = 2.4) -> Ring:
        y = hip + up * tall
        cloth = top if y >= hem else look.loose_legs_m * 0.5
        material = "shirt" if y >= hem - 1e-6 else "trousers"
        bones = ("pelvis", "chest")
        return Ring((0.0, y, dz), x + cloth, z + cloth, bones, share, material, q)

    hips, waist = (m["hips_halfwidth_m"], m["hips_halfdepth_m"]), m["waist_halfwidth_m"]
    depth, chest = m["waist_halfdepth_m"], (m["chest_halfwidth_m"], m["chest_halfdepth_m"])
    shoulder = 0.42 * m["shoulder_width_m"]
    neck_radius = 0.62 * m["head_halfwidth_m"] + 0.01
    bust = 0.018 if p.sex == "f" else 0.004
    rings = [
        ring(-0.16, 0.3 * hips[0], 0.4 * hips[1], 0.0),
        ring(-0.13, 0.8 * hips[0], 0.86 * hips[1], 0.0, -0.01),
        ring(-0.03, hips[0], hips[1], 0.0, -0.02),
        ring(0.06, 0.98 * hips[0], 0.97 * hips[1], 0.05, -0.02),
        ring((navel - hip) / tall, 0.5 * (hips[0] + waist), 0.97 * depth, 0.4, 0.5 * back),
        ring(0.3, waist, depth, 0.75, 0.3 * back),
        ring(0.45, 0.55 * waist + 0.45 * chest[0], 0.5 * (depth + chest[1]), 1.0),
        ring(0.64, chest[0], chest[1] + bust, 1.0, 0.006 + bust, 2.6),
        ring(0.76, 0.99 * chest[0], chest[1], 1.0, 0.0, 2.6),
        ring(0.84, 0.4 * chest[0] + 0.68 * shoulder, 0.86 * chest[1], 1.0, -0.004),
        ring(0.89, 0.98 * shoulder, 0.74 * chest[1], 1.0, -0.008, 2.2),
        ring(0.935, 0.62 * shoulder, 0.6 * chest[1], 1.0, -0.008, 2.0),
        ring(0.975, 0.3 * shoulder + 0.6 * neck_radius, 0.85 * neck_radius, 1.0, -0.008, 2.0),
        ring(1.01, 0.9 * neck_radius, 0.7 * neck_radius, 1.0, -0.005, 2.0),
    ]
    thigh_depth = 1.1 * m["thigh_radius_m"] + look.loose_legs_m
    return _hemmed(rings, hem, top, thigh_depth)


def _hemmed(rings: list[Ring], hem: float, loose: float, thigh_depth: float) -> list[Ring]:
    """Trousers below the hem, the shirt above: it hangs straight down from the widest ring,
    before the thighs."""
    widest = rings[2]
    drop = max(hem, widest.centre[1])
    heights = [ring.centre[1] for ring in rings]
    x, z, share, dz = (
        float(np.interp(drop, heights, values))
        for values in zip(*[(r.half_x, r.half_z, r.share, r.centre[2]) for r in rings], strict=True)
    )
    deep = max(z, thigh_depth - dz) + loose
    edge = Ring((0.0, hem, dz), x + loose, deep, widest.bones, share, "shirt", SKIRT)
    tucked = edge._replace(centre=(0.0, hem - STEP_M, dz), half_x=0.9 * x, half_z=0.9 * z)
    under = [ring for ring in rings if ring.centre[1] < hem - STEP_M]
    over = [ring for ring in rings if ring.centre[1] > drop]
    return [*under, tucked, edge, *over]


def arm(p: Person, at: dict[str, Vector], side: str) -> list[Ring]:
    """From the top of the shoulder to the wrist."""
    m, look = p.measures, p.look
    x, shoulder, _ = (float(value) for value in at[f"{side}_upper_arm"])
    upper, fore = m["upper_arm_m"], m["forearm_m"]
    thick, thin = m["upper_arm_radius_m"], m["forearm_radius_m"]
    sleeve_ends = {"none": 0.04, "short": 0.62 * upper, "long": upper + 0.97 * fore}[look.sleeve]
    arm, elbow = f"{side}_upper_arm", f"{side}_forearm"
    girth = (
        (-0.92 * thick, 0.25 * thick, 0.0),
        (-0.7 * thick, 0.76 * thick, 0.0),
        (-0.3 * thick, 1.04 * thick, 0.0),
        (0.1 * upper, 1.1 * thick, 0.0),
        (0.3 * upper, 1.1 * thick, 0.0),
        (0.5 * upper, thick, 0.0),
        (0.8 * upper, 0.86 * thick, 0.06),
        (0.93 * upper, 0.84 * thick, 0.3),
        (upper, 0.84 * thick, 0.5),
        (upper + 0.07 * fore, 0.84 * thick, 0.7),
        (upper + 0.22 * fore, 0.5 * thick + 0.6 * thin, 0.95),
        (upper + 0.5 * fore, 0.3 * thick + 0.7 * thin, 1.0),
        (upper + 0.95 * fore, 0.84 * thin, 1.0),
        (upper + 1.03 * fore, 0.8 * thin, 1.0),
    )
    inside = _cut(girth, sleeve_ends, look.loose_top_m)
    return [
        Ring(
            (x, shoulder - down, 0.0),
            r,
            1.04 * r,
            (arm, elbow),
            share,
            "shirt" if cloth else "skin",
        )
        for down, r, share, cloth in inside
    ]


def _cut(
    girth: tuple[tuple[float, float, float], ...], ends: float, loose: float
) -> list[tuple[float, float, float, bool]]:
    """Sections (down, radius, weight, cloth?) of a limb with cloth down to `ends`."""
    downs, radii, shares = zip(*girth, strict=True)
    r, share = float(np.interp(ends, downs, radii)), float(np.interp(ends, downs, shares))
    wide = [
        (d, g + loose * (0.15 + 0.85 * max(0.0, min(1.0, d / max(ends, 0.01)))), s, True)
        for d, g, s in girth
        if d < ends
    ]
    hem = [(ends, r + loose, share, False), (ends + STEP_M, r, share, False)]
    return [*wide, *hem, *((d, g, s, False) for d, g, s in girth if d > ends + STEP_M)]


def leg(p: Person, at: dict[str, Vector], side: str) -> list[Ring]:
    """From the hip to the ankle; it begins inside the trunk's contour."""
    m, look = p.measures, p.look
    x, hip, _ = (float(value) for value in at[f"{side}_thigh"])
    sign = 1.0 if side == "l" else -1.0
    thigh, shin = m["thigh_m"], m["shin_m"]
    thick, calf = m["thigh_radius_m"], m["shin_radius_m"]
    knee_radius, ankle_radius = 0.35 * thick + 0.52 * calf, 0.66 * calf
    ends = 0.85 * thigh if look.shorts else thigh + 0.97 * shin
    girth = (
        (-0.1 * thigh, 0.3 * thick, 0.0),
        (-0.02 * thigh, 0.68 * thick, 0.0),
        (0.1 * thigh, 0.92 * thick, 0.0),
        (0.24 * thigh, 1.0 * thick, 0.0),
        (0.5 * thigh, 0.3 * knee_radius + 0.68 * thick, 0.0),
        (0.8 * thigh, 0.75 * knee_radius + 0.25 * thick, 0.06),
        (0.93 * thigh, knee_radius, 0.3),
        (thigh, knee_radius, 0.5),
        (thigh + 0.07 * shin, 0.98 * knee_radius, 0.7),
        (thigh + 0.18 * shin, 0.96 * knee_radius, 0.95),
        (thigh + 0.33 * shin, calf, 1.0),
        (thigh + 0.6 * shin, 0.83 * calf, 1.0),
        (thigh + 0.88 * shin, ankle_radius, 1.0),
        (thigh + 1.04 * shin, 0.95 * ankle_radius, 1.0),
    )
    bones = (f"{side}_thigh", f"{side}_shank")
    inwards = m["hip_width_m"] / 2 - (m["hips_halfwidth_m"] - 1.04 * thick)
    rings = []
    for down, r, share, cloth in _cut(girth, ends, look.loose_legs_m):
        near = max(0.0, 1.0 - max(down, 0.0) / (0.8 * thigh))
        back = -0.012 if down > thigh else 0.0
        centre = (x - sign * inwards * near, hip - down, back)
        rings.append(Ring(centre, r, 1.06 * r, bones, share, "trousers" if cloth else "skin"))
    return rings
