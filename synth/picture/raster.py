"""Compiled inner loops of the renderer: move a surface, draw it, composite it over the room."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.compiled import compiled, compiling
from synth.person.people import PATTERNS

AMBIENT: Final = 0.52
"""Share of ambient light."""
WRAP: Final = 0.35
"""How far the key light wraps around a body: cloth scatters."""
THREADS: Final = 90.0
"""Threads per metre of the coarse weave: cloth and skin are never uniform."""
HOOPS, BARS, CHECKS, PRINT = (PATTERNS.index(n) for n in ("hoops", "bars", "checks", "print"))


@compiled
def skin(
    vertices: Floats,
    origins: Floats,
    bones: NDArray[np.int64],
    shares: Vector,
    frames: Floats,
    out: Floats,
) -> None:
    """Place the vertices by linear blend skinning over two bones.

    Args:
        vertices: (v, 3) at rest.
        origins: (b, 3) of the bones at rest.
        bones: (v, 2).
        shares: (v,).
        frames: (b, 3, 4) bones to the world.
        out: (v, 3) written.
    """
    for i in range(len(vertices)):
        for row in range(3):
            out[i, row] = 0.0
        for which in range(2):
            share = shares[i] if which == 1 else 1.0 - shares[i]
            if share == 0.0:
                continue
            bone = bones[i, which]
            x = vertices[i, 0] - origins[bone, 0]
            y = vertices[i, 1] - origins[bone, 1]
            z = vertices[i, 2] - origins[bone, 2]
            for row in range(3):
                f = frames[bone, row]
                out[i, row] += share * (f[0] * x + f[1] * y + f[2] * z + f[3])


@compiled
def shade(
    places: Floats, faces: NDArray[np.int64], light: Vector, normals: Floats, out: Vector
) -> None:
    """Brightness of each vertex under a distant light and the room's scattered light, (v,)."""
    normals[:] = 0.0
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        ux, uy, uz = (
            places[b, 0] - places[a, 0],
            places[b, 1] - places[a, 1],
            places[b, 2] - places[a, 2],
        )
        wx, wy, wz = (
            places[c, 0] - places[a, 0],
            places[c, 1] - places[a, 1],
            places[c, 2] - places[a, 2],
        )
        nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        for corner in (a, b, c):
            normals[corner, 0] += nx
            normals[corner, 1] += ny
            normals[corner, 2] += nz
    for i in range(len(places)):
        nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
        size = math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-12
        towards = (nx * light[0] + ny * light[1] + nz * light[2]) / size
        key = max(0.0, (towards + WRAP) / (1.0 + WRAP))
        sky = 0.8 + 0.2 * ny / size
        out[i] = AMBIENT * sky + (1.0 - AMBIENT) * 1.25 * key


@compiled
def _between(one: float, two: float, three: float, count: int) -> tuple[int, int]:
    """First and last of `count` rows or columns whose centres lie between three places, pixels."""
    first = max(0, math.ceil(min(one, two, three) - 0.5))
    return first, min(count - 1, math.floor(max(one, two, three) - 0.5))


@compiled
def cover(pixels: Floats, faces: NDArray[np.int64], mask: NDArray[np.uint8]) -> None:
    """Set every pixel of `mask` (h, w) whose centre lies in a face; pixels (v, 2)."""
    height, width = mask.shape
    for f in range(len(faces)):
        x0, y0 = pixels[faces[f, 0], 0], pixels[faces[f, 0], 1]
        x1, y1 = pixels[faces[f, 1], 0], pixels[faces[f, 1], 1]
        x2, y2 = pixels[faces[f, 2], 0], pixels[faces[f, 2], 1]
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if area == 0.0 or not math.isfinite(area):
            continue
        sign = 1.0 if area > 0.0 else -1.0
        top, bottom = _between(y0, y1, y2, height)
        left, right = _between(x0, x1, x2, width)
        for row in range(top, bottom + 1):
            y = row + 0.5
            for column in range(left, right + 1):
                x = column + 0.5
                if (
                    sign * ((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) >= 0.0
                    and sign * ((x2 - x1) * (y - y1) - (y2 - y1) * (x - x1)) >= 0.0
                    and sign * ((x0 - x2) * (y - y2) - (y0 - y2) * (x - x2)) >= 0.0
                ):
                    mask[row, column] = 1


@compiling(error_model="numpy")
def draw(
    pixels: Floats,
    depths: Vector,
    light: Vector,
    rest: Floats,
    faces: NDArray[np.int64],
    materials: NDArray[np.int64],
    palette: Floats,
    pattern: tuple[float, float, float],
    nearest: Floats,
    colours: NDArray[np.float32],
) -> None:
    """Draw a surface with a depth buffer.

    Args:
        pixels: (v, 2) pixels of the vertices; NaN behind the camera.
        depths: (v,) metres.
        light: (v,) brightness.
        rest: (v, 3) at rest: patterns are defined there, so cloth carries them along.
        faces: (f, 3), front ones clockwise in the picture (y down).
        materials: (f,).
        palette: (materials + 1, 3) colours; the last one is the shirt's second colour.
        pattern: (kind, pitch in metres, material that has it).
        nearest: (h, w) inverse depth, 0 where nothing was drawn; updated.
        colours: (h, w, 3) updated.
    """
    height, width = nearest.shape
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        x0, y0, x1, y1 = pixels[a, 0], pixels[a, 1], pixels[b, 0], pixels[b, 1]
        x2, y2 = pixels[c, 0], pixels[c, 1]
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if not area < 0.0:
            continue
        top, bottom = _between(y0, y1, y2, height)
        left, right = _between(x0, x1, x2, width)
        material, scale = materials[f], 1.0 / area
        near_a, near_b, near_c = 1.0 / depths[a], 1.0 / depths[b], 1.0 / depths[c]
        p_x, p_y = (y1 - y2) * scale, (x2 - x1) * scale
        q_x, q_y = (y2 - y0) * scale, (x0 - x2) * scale
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                p = p_y * (row + 0.5 - y1) + p_x * (column + 0.5 - x1)
                q = q_y * (row + 0.5 - y2) + q_x * (column + 0.5 - x2)
                r = 1.0 - p - q
                if p < 0.0 or q < 0.0 or r < 0.0:
                    continue
                near = p * near_a + q * near_b + r * near_c
                if near <= nearest[row, column]:
                    continue
                nearest[row, column] = near
                bright = p * light[a] + q * light[b] + r * light[c]
                u = p * rest[a, 0] + q * rest[b, 0] + r * rest[c, 0]
                v = p * rest[a, 1] + q * rest[b, 1] + r * rest[c, 1]
                w = p * rest[a, 2] + q * rest[b, 2] + r * rest[c, 2]
                accent, weave = _woven(material, pattern, u, v, w)
                colour = len(palette) - 1 if accent else material
                for k in range(3):
                    colours[row, column, k] = palette[colour, k] * bright * weave


@compiled
def _woven(
    material: int, pattern: tuple[float, float, float], x: float, y: float, z: float
) -> tuple[bool, float]:
    """Whether cloth has its second colour at a point at rest, and the brightness of a thread
    there."""
    accent = material == pattern[2] and _second(pattern[0], pattern[1], x, y, z)
    thread = math.floor(x * THREADS) ^ math.floor((y + z) * THREADS)
    return accent, 0.98 + 0.04 * (thread & 1)


@compiled
def _second(kind: float, pitch: float, x: float, y: float, z: float) -> bool:
    """Whether the pattern shows its second colour at a point of the resting shirt."""
    if kind == HOOPS:
        return math.floor(y / pitch) % 2 == 0
    if kind == BARS:
        return math.floor((x + z) / pitch) % 2 == 0
    if kind == CHECKS:
        return (math.floor(y / pitch) + math.floor((x + z) / pitch)) % 2 == 0
    if kind == PRINT:
        across, up = x / (3.5 * pitch), (y - 1.28) / (1.6 * pitch)
        return z > 0.0 and across * across + up * up < 1.0
    return False


@compiled
def gather(
    drawn: NDArray[np.bool_],
    colours: NDArray[np.float32],
    scale: int,
    body: NDArray[np.float32],
    weight: float,
) -> None:
    """Average `scale` x `scale` samples into pixels.

    Args:
        drawn: (h scale, w scale), True where something was drawn.
        colours: (h scale, w scale, 3).
        scale: Samples per pixel, each way.
        body: (h, w, 4) colours times coverage, and coverage; `weight` times this drawing is added.
        weight: Share of the exposure.
    """
    height, width = body.shape[:2]
    share = 1.0 / (scale * scale)
    for row in range(height):
        for column in range(width):
            count = 0
            red, green, blue = 0.0, 0.0, 0.0
            for i in range(row * scale, (row + 1) * scale):
                for j in range(column * scale, (column + 1) * scale):
                    if drawn[i, j]:
                        count += 1
                        blue += colours[i, j, 0]
                        green += colours[i, j, 1]
                        red += colours[i, j, 2]
            if count:
                body[row, column, 0] += weight * share * blue
                body[row, column, 1] += weight * share * green
                body[row, column, 2] += weight * share * red
                body[row, column, 3] += weight * share * count


@compiled
def expose(
    room: NDArray[np.float32],
    shadow: NDArray[np.float32],
    body: NDArray[np.float32],
    gain: float,
    grain: NDArray[np.float32],
    out: NDArray[np.uint8],
) -> None:
    """The picture: room in its shadow, body over it, gain, sensor noise, 8 bits.

    Args:
        room: (h, w, 3) float32 of the empty room.
        shadow: (h, w) share of the light that arrives.
        body: (h, w, 4) from `gather`.
        gain: Exposure.
        grain: (h, w, 3) noise of a dark pixel, grey levels; bright ones have more.
        out: (h, w, 3) uint8, written.
    """
    height, width, _ = room.shape
    for row in range(height):
        for column in range(width):
            seen = 1.0 - body[row, column, 3]
            lit = seen * shadow[row, column]
            for k in range(3):
                value = gain * (room[row, column, k] * lit + body[row, column, k])
                value += grain[row, column, k] * (0.6 + 0.004 * value)
                out[row, column, k] = np.uint8(min(255.0, max(0.0, value + 0.5)))
