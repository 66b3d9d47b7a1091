"""A followed path, or several methods side by side, as one figure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.http.units import Units
from app.pictures.canvas import Canvas
from app.pictures.chart import Box, Chart, draw_chart
from app.pictures.lettering import fitted, width_of
from app.pictures.path_charts import motion_charts, path_charts, thinned
from app.pictures.scene import SNAPSHOTS, Scene, draw_scene, is_flat, plane_of
from app.pictures.space import bounds_of, draw_space
from kinematics.named_singularities.posture import posture
from kinematics.redundancy.clearance.link_points import RADIUS
from kinematics.redundancy.clearance.links import skeleton
from kinematics.redundancy.follow import PathResult
from kinematics.redundancy.measure import segment_ends
from kinematics.redundancy.timing.result import Retimed
from robots.robot import FloatArray

SCENE, CHART_WIDTH, CHART_HEIGHT = 330.0, 400.0, 200.0
RADIANS = Units()


def path_figure(
    results: Sequence[tuple[str, PathResult]],
    title: str,
    units: Units = RADIANS,
    plane: str | None = None,
    motion: Retimed | None = None,
) -> str:
    """The arm among obstacles for each method, and curves of joints, clearance and error.

    Args:
        results: Labels and followed paths of one problem.
        title: Of the figure.
        units: Of angles.
        plane: xy, xz or yz; None for the one in which the arm moves, else a view from aside.
        motion: The one path in the shortest time, with curves of its own.

    Returns:
        SVG text.
    """
    scenes = [_scene(result) for _, result in results]
    spatial = plane is None and not is_flat(scenes)
    plane = plane or plane_of(scenes)
    across = {1: 1, 2: 2, 4: 2}.get(len(results), 3)
    rows = -(-len(results) // across)
    single = len(results) == 1
    charts = path_charts(results, units)
    if motion is not None and motion.duration:
        charts += motion_charts(results[0][1].problem, motion)
    width = SCENE + CHART_WIDTH + 30 if single else max(across * SCENE, 2 * CHART_WIDTH) + 20
    above = 34.0 if single else 40.0 + rows * (SCENE + 24)
    left = SCENE + 20 if single else 10.0
    boxes, below = _boxes(charts, left, above, 1 if single else 2)
    canvas = Canvas(width, max(below, SCENE + 74 if single else 0.0) + 6, title)
    canvas.text((14, 22), fitted(title, width - 28, 15, bold=True), 15, bold=True)
    reach = _with_obstacles(_reach(scenes), scenes) if spatial else _reach(scenes)
    for k, ((label, result), scene) in enumerate(zip(results, scenes, strict=True)):
        x, y = 10 + (k % across) * SCENE, 34 + (k // across) * (SCENE + 24)
        word = f": {_word(result)}"
        room = SCENE - 44 - width_of(word, 12, bold=True)
        text = f"{fitted(label, room, 12, bold=True)}{word}"
        canvas.text((x + 40, y + 12), text, 12, bold=True)
        box = (x, y + 16, SCENE, SCENE)
        if spatial:
            draw_space(canvas, box, scene, f"scene{k}", reach)
        else:
            draw_scene(canvas, box, scene, plane, f"scene{k}", reach)
    for chart, box in zip(charts, boxes, strict=True):
        draw_chart(canvas, box, chart)
    return canvas.render()


def _boxes(
    charts: Sequence[Chart], left: float, top: float, across: int
) -> tuple[list[Box], float]:
    """Return the place of each chart, in rows as high as their legends need, and their end."""
    found: list[Box] = []
    for start in range(0, len(charts), across):
        row = charts[start : start + across]
        height = max(chart.height(CHART_WIDTH, CHART_HEIGHT) for chart in row)
        found += [(left + k * CHART_WIDTH, top, CHART_WIDTH, height) for k in range(len(row))]
        top += height
    return found, top


def _word(result: PathResult) -> str:
    verdict = result.verdict
    return "success" if verdict.success else str(verdict.reason).replace("_", " ")


def _scene(result: PathResult) -> Scene:
    problem = result.problem
    chosen = np.unique(np.linspace(0, len(result.q) - 1, SNAPSHOTS).round().astype(int))
    arm, shaped = problem.arm, problem.shaped is not None
    bones, q = skeleton(arm, problem.link_radius), arm.reduced(result.q[chosen])
    ends = segment_ends(arm, bones, q)
    return Scene(
        np.concatenate((ends[:, :1, 0], ends[:, :, 1]), axis=1),
        thinned(problem.path.targets)[:, [3, 7, 11]],
        posture(arm.chain, thinned(result.q)).p,
        problem.obstacles,
        bones.rows[:, RADIUS],
        segment_ends(arm, problem.links, q) if shaped else None,
        problem.links.rows[:, RADIUS] if shaped else None,
    )


def _reach(scenes: Sequence[Scene]) -> FloatArray:
    """Least and largest coordinates of all scenes with a margin, a cube in shape; (2, 3)."""
    drawn = [s.links for s in scenes] + [s.shapes for s in scenes if s.shapes is not None]
    points = np.concatenate([d.reshape(-1, 3) for d in drawn] + [s.path for s in scenes])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2, max(0.55 * float((high - low).max()), 1e-6)
    return np.array([middle - half, middle + half])


def _with_obstacles(reach: FloatArray, scenes: Sequence[Scene]) -> FloatArray:
    """The same with the base's origin, and with obstacles as far as they are near."""
    near = 0.35 * (reach[1] - reach[0])
    bounds = [b for b in map(bounds_of, scenes[0].obstacles) if b is not None]
    shown = [np.clip(b, reach[0] - near, reach[1] + near) for b in bounds]
    every = np.concatenate([reach, np.zeros((1, 3)), *shown])
    low, high = every.min(axis=0), every.max(axis=0)
    return np.array([low, high])
