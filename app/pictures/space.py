"""A spatial arm among obstacles, seen from aside, on a floor with coordinates."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

import numpy as np
from scipy.spatial import ConvexHull

from app.pictures.camera import Camera, camera_for
from app.pictures.canvas import COLORS, GRID, INK, Canvas
from app.pictures.chart import Box, ticks
from app.pictures.plane import BELOW, LEFT, RIGHT, TOP
from app.pictures.scene import OBSTACLE, Scene
from kinematics.redundancy.clearance.obstacles import BOX, CAPSULE, CIRCLE, SPHERE
from robots.robot import FloatArray

SHOWN = 4
"""Snapshots, so that what is behind them can be seen."""
SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
"""Of the corners of a box; those that differ in one bit of their number share an edge."""
Part: TypeAlias = tuple[float, Callable[[], None]]
"""How near it is, and what draws it."""


def draw_space(canvas: Canvas, box: Box, scene: Scene, name: str, reach: FloatArray) -> None:
    """Draws a scene into a box (x, y, width, height).

    What is farther away is drawn first: obstacles and links by the depth of their middle.
    Half-spaces are not drawn.

    Args:
        canvas: Where to draw.
        box: Place on it.
        scene: What to draw.
        name: Distinguishes the scenes of a canvas.
        reach: Least and largest coordinates to show, shape (2, 3), m.
    """
    area = (box[0] + LEFT, box[1] + TOP, box[2] - LEFT - RIGHT, box[3] - TOP - BELOW)
    low, high = reach
    corners = np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
    inner = (area[0] + 26, area[1] + 8, area[2] - 52, area[3] - 30)
    camera = camera_for("iso", corners, inner)
    canvas.clip(name, area)
    _floor(canvas, camera, low, high)
    for _, draw in sorted(
        [*_obstacles(canvas, camera, scene, low, high), *_arms(canvas, camera, scene)],
        key=lambda part: part[0],
    ):
        draw()
    canvas.line(camera.place(scene.path), INK, 1.2, dash="4 3")
    canvas.line(camera.place(scene.trace), COLORS[1], 1.6)
    canvas.circle(camera.place(scene.trace[-1]), 3.0, COLORS[1], COLORS[1])
    canvas.end_clip()
    x, y, width, height = area
    frame = np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])
    canvas.line(frame, INK, 0.8, closed=True)


def bounds_of(obstacle: FloatArray) -> FloatArray | None:
    """Least and largest coordinates of an obstacle, shape (2, 3); None where it has no end."""
    kind = obstacle[0]
    if kind == SPHERE:
        return np.array([obstacle[1:4] - obstacle[4], obstacle[1:4] + obstacle[4]])
    if kind == CAPSULE:
        ends = obstacle[1:7].reshape(2, 3)
        return np.array([ends.min(axis=0) - obstacle[7], ends.max(axis=0) + obstacle[7]])
    if kind == BOX:
        half = np.abs(obstacle[7:16].reshape(3, 3) * obstacle[4:7, None]).sum(axis=0)
        return np.array([obstacle[1:4] - half, obstacle[1:4] + half])
    return None


def _floor(canvas: Canvas, camera: Camera, low: FloatArray, high: FloatArray) -> None:
    """The grid of the lowest level shown, the axis upwards, and their numbers."""
    floor = low[2]
    for along, other in ((0, 1), (1, 0)):
        values = ticks(float(low[along]), float(high[along]), 5)
        for value in values:
            ends = np.zeros((2, 3))
            ends[:, along], ends[:, 2] = value, floor
            ends[:, other] = low[other], high[other]
            placed = camera.place(ends)
            canvas.line(placed, GRID, 0.7)
            near = int(np.argmax(placed[:, 1]))
            text = f"{value + 0.0:.6g}"
            anchor = "end" if placed[near, 0] < placed[1 - near, 0] else "start"
            shift = -4 if anchor == "end" else 4
            canvas.text((placed[near, 0] + shift, placed[near, 1] + 9), text, 9, anchor=anchor)
        middle = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, floor])
        ends = np.array([middle, middle])
        ends[:, other] = low[other], high[other]
        placed = camera.place(ends)
        near = int(np.argmax(placed[:, 1]))
        side = -1 if placed[near, 0] < placed[1 - near, 0] else 1
        at = placed[near] + (22 * side, 22)
        canvas.text((at[0], at[1]), f"{'xy'[along]} [m]", 10, anchor="middle")
    corners = np.array([[x, y, floor] for x in (low[0], high[0]) for y in (low[1], high[1])])
    left = corners[int(np.argmin(camera.place(corners)[:, 0]))]
    post = np.array([left, [left[0], left[1], high[2]]])
    canvas.line(camera.place(post), GRID, 0.7)
    for value in ticks(float(low[2]), float(high[2]), 5):
        at = camera.place(np.array([left[0], left[1], value]))
        canvas.line(np.array([at, at + np.array([4.0, 0.0])]), INK, 0.7)
        canvas.text((at[0] + 7, at[1] + 3), f"{value + 0.0:.6g}", 9)
    top = camera.place(post[1])
    canvas.text((top[0] + 7, top[1] + 14), "z [m]", 10)


def _arms(canvas: Canvas, camera: Camera, scene: Scene) -> list[Part]:
    """Links of some snapshots, the first fainter than the last; in grey what stands still."""
    base = np.array([np.zeros(3), scene.links[-1, 0]])
    parts: list[Part] = [_line(canvas, camera, base, COLORS[6], 4.0, 1.0)]
    chosen = np.unique(np.linspace(0, len(scene.links) - 1, SHOWN).round().astype(int))
    for k in chosen.tolist():
        opacity = 0.9 if k == chosen[-1] else 0.15 + 0.25 * (k + 1) / len(scene.links)
        links = scene.links[k]
        if scene.shapes is not None and scene.shape_radii is not None:
            for ends, radius in zip(scene.shapes[k], scene.shape_radii, strict=True):
                wide = max(0.8, 2 * radius * camera.scale)
                parts.append(_line(canvas, camera, ends, COLORS[5], wide, 0.4 * opacity))
        for a, b, radius in zip(links[:-1], links[1:], scene.radii, strict=True):
            wide = 1.6 if scene.shapes is not None else max(1.6, 2 * radius * camera.scale)
            parts.append(_line(canvas, camera, np.array([a, b]), COLORS[0], wide, opacity))
        for point in links:
            mark = partial(
                canvas.circle, camera.place(point), 2.0, "#ffffff", COLORS[0], 0.8, opacity=opacity
            )
            parts.append((float(camera.depth(point)) + 1e-6, mark))
    return parts


def _line(
    canvas: Canvas, camera: Camera, ends: FloatArray, color: str, width: float, opacity: float
) -> Part:
    draw = partial(canvas.line, camera.place(ends), color, width, opacity=opacity)
    return float(camera.depth(ends).mean()), draw


def _obstacles(
    canvas: Canvas, camera: Camera, scene: Scene, low: FloatArray, high: FloatArray
) -> list[Part]:
    parts: list[Part] = []
    for row in scene.obstacles:
        kind = row[0]
        if kind == SPHERE:
            draw = partial(
                canvas.circle, camera.place(row[1:4]), row[4] * camera.scale, OBSTACLE, INK, 0.8
            )
            parts.append((float(camera.depth(row[1:4])), draw))
        elif kind == CAPSULE:
            ends, wide = row[1:7].reshape(2, 3), 2 * row[7] * camera.scale
            depth = float(camera.depth(ends).mean())
            parts.append((depth, partial(canvas.line, camera.place(ends), INK, wide + 1.6)))
            parts.append((depth + 1e-9, partial(canvas.line, camera.place(ends), OBSTACLE, wide)))
        elif kind == BOX:
            axes = row[7:16].reshape(3, 3) * row[4:7, None]
            corners = row[1:4] + SIGNS @ axes
            parts.append((float(camera.depth(row[1:4])), partial(_box, canvas, camera, corners)))
        elif kind == CIRCLE:
            turn = np.linspace(0, 2 * np.pi, 49)
            ring = row[4] * np.column_stack((np.cos(turn), np.sin(turn), 0 * turn))
            rings = [ring + np.array([row[1], row[2], z]) for z in (low[2], high[2])]
            middle = np.array([row[1], row[2], (low[2] + high[2]) / 2])
            draw = partial(_hull, canvas, camera.place(np.concatenate(rings)))
            parts.append((float(camera.depth(middle)), draw))
    return parts


def _box(canvas: Canvas, camera: Camera, corners: FloatArray) -> None:
    """The outline, and the three edges that meet in the nearest corner."""
    placed = camera.place(corners)
    _hull(canvas, placed)
    nearest = int(np.argmax(camera.depth(corners)))
    for other in (nearest ^ 1, nearest ^ 2, nearest ^ 4):
        canvas.line(placed[[nearest, other]], INK, 0.8)


def _hull(canvas: Canvas, placed: FloatArray) -> None:
    """A filled convex outline about points of the picture; of points in line, the line."""
    if np.linalg.matrix_rank(placed - placed.mean(axis=0), 1e-6) < 2:
        canvas.line(placed, INK, 0.8)
        return
    canvas.line(placed[ConvexHull(placed).vertices], INK, 0.8, closed=True, fill=OBSTACLE)
