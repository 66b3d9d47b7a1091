"""An arm in a plane: snapshots of its links, its path, and what stands in the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.pictures.canvas import COLORS, INK, Canvas
from app.pictures.chart import Box
from app.pictures.plane import draw_axes, draw_border, equal_plane
from kinematics.redundancy.clearance.obstacles import BOX, CAPSULE, CIRCLE, HALF_SPACE, SPHERE
from robots.robot import FloatArray

PLANES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
OBSTACLE = "#c8c8c8"
SNAPSHOTS = 9


@dataclass(frozen=True, eq=False)
class Scene:
    """What is drawn.

    Attributes:
        links: Corners of the arm's polyline in each snapshot, shape (n, L + 1, 3), m.
        path: Where the tip should go, shape (N, 3).
        trace: Where it goes, shape (m, 3).
        obstacles: See :func:`kinematics.redundancy.clearance.obstacles.encoded`.
        radii: Of the links between them, m, shape (L,).
        shapes: Ends of the capsules of the arm's own shapes in each snapshot, shape (n, L, 2, 3),
            drawn instead; None for none.
        shape_radii: Their radii, shape (L,).
    """

    links: FloatArray
    path: FloatArray
    trace: FloatArray
    obstacles: FloatArray
    radii: FloatArray
    shapes: FloatArray | None = None
    shape_radii: FloatArray | None = None


def plane_of(scenes: Sequence[Scene]) -> str:
    """The coordinate plane that shows most of the arms."""
    points = np.concatenate([scene.links.reshape(-1, 3) for scene in scenes])
    spread = points.max(axis=0) - points.min(axis=0)
    return max(PLANES, key=lambda name: spread[PLANES[name][0]] * spread[PLANES[name][1]])


def is_flat(scenes: Sequence[Scene]) -> bool:
    """Whether all arms stay in a coordinate plane."""
    points = np.concatenate([scene.links.reshape(-1, 3) for scene in scenes])
    spread = np.ptp(points, axis=0)
    return bool(spread.min() <= 1e-6 * spread.max())


def draw_scene(
    canvas: Canvas, box: Box, scene: Scene, plane: str, name: str, reach: FloatArray
) -> None:
    """Draws a scene into a box (x, y, width, height).

    Args:
        canvas: Where to draw.
        box: Place on it.
        scene: What to draw.
        plane: xy, xz or yz.
        name: Distinguishes the scenes of a canvas.
        reach: Least and largest coordinates to show, shape (2, 3), m.
    """
    columns = list(PLANES[plane])
    shown = equal_plane(box, *reach[:, columns])
    scale = shown.scale

    def place(points: FloatArray) -> FloatArray:
        flat = np.asarray(points)
        return shown.place(flat[..., columns] if flat.shape[-1] == 3 else flat)

    draw_axes(canvas, shown, f"{plane[0]} [m]", f"{plane[1]} [m]")
    canvas.clip(name, shown.box)
    (west, south), (east, north) = shown.low, shown.high
    corners = np.array([[west, south], [east, south], [east, north], [west, north]])
    for row in scene.obstacles:
        _obstacle(canvas, row, place, scale, columns, corners)
    count = len(scene.links)
    for k, links in enumerate(scene.links):
        shade = 0.25 + 0.75 * (k + 1) / count
        last = k == count - 1
        opacity = 0.5 * shade if not last else 0.9
        if scene.shapes is not None and scene.shape_radii is not None:
            for ends, radius in zip(scene.shapes[k], scene.shape_radii, strict=True):
                wide = max(0.8, 2 * radius * scale)
                canvas.line(place(ends), COLORS[5], wide, opacity=0.35 * opacity)
            canvas.line(place(links), COLORS[0], 1.6, opacity=opacity)
        elif np.ptp(scene.radii) == 0.0:
            thick = max(1.6, 2 * scene.radii[0] * scale)
            canvas.line(place(links), COLORS[0], thick, opacity=opacity)
        else:
            for a, b, radius in zip(links[:-1], links[1:], scene.radii, strict=True):
                thick = max(1.6, 2 * radius * scale)
                canvas.line(place(np.array([a, b])), COLORS[0], thick, opacity=opacity)
        for point in place(links):
            canvas.circle(point, 2.0, "#ffffff", COLORS[0], 0.8, opacity=shade)
    canvas.line(place(scene.path), INK, 1.2, dash="4 3")
    canvas.line(place(scene.trace), COLORS[1], 1.6)
    canvas.circle(place(scene.trace[-1]), 3.0, COLORS[1], COLORS[1])
    canvas.end_clip()
    draw_border(canvas, shown)


def _obstacle(
    canvas: Canvas,
    row: FloatArray,
    place: object,
    scale: float,
    columns: list[int],
    corners: FloatArray,
) -> None:
    put = place
    assert callable(put)
    kind = row[0]
    if kind in (SPHERE, CIRCLE):
        canvas.circle(put(row[1:4]), row[4] * scale, OBSTACLE, INK, 0.8)
    elif kind == CAPSULE:
        ends = put(row[1:7].reshape(2, 3))
        canvas.line(ends, INK, 2 * row[7] * scale + 1.6)
        canvas.line(ends, OBSTACLE, 2 * row[7] * scale)
    elif kind == BOX:
        axes = row[7:16].reshape(3, 3) * row[4:7, None]
        for axis in range(3):
            a, b = (axes[k] for k in range(3) if k != axis)
            for sign in (-1.0, 1.0):
                c = row[1:4] + sign * axes[axis]
                face = np.array([c + a + b, c + a - b, c - a - b, c - a + b])
                canvas.line(put(face), OBSTACLE, 0.8, closed=True, fill=OBSTACLE)
    elif kind == HALF_SPACE:
        normal, offset = row[1:4][columns], row[4]
        if np.linalg.norm(normal) > 1 - 1e-9:
            behind = _behind(corners, normal, offset)
            if len(behind):
                canvas.line(put(behind), INK, 0.8, closed=True, fill=OBSTACLE)


def _behind(corners: FloatArray, normal: FloatArray, offset: float) -> FloatArray:
    """The part of a convex polygon with normal · p < offset (Sutherland and Hodgman)."""
    kept = []
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        a, b = float(p @ normal - offset), float(q @ normal - offset)
        if a <= 0:
            kept.append(p)
        if a * b < 0:
            kept.append(p + a / (a - b) * (q - p))
    return np.array(kept)
