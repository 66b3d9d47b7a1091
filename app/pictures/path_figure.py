"""A followed path, or several methods side by side, as one figure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.pictures.canvas import COLORS, Canvas
from app.pictures.chart import Curve, Level, chart
from app.pictures.scene import SNAPSHOTS, Scene, draw_scene, is_flat, plane_of
from app.pictures.space import bounds_of, draw_space
from kinematics.named_singularities.posture import posture
from kinematics.redundancy.clearance.link_points import RADIUS
from kinematics.redundancy.clearance.links import skeleton
from kinematics.redundancy.follow import PathResult
from kinematics.redundancy.measure import segment_ends
from kinematics.redundancy.problem import PathProblem
from kinematics.redundancy.timing.result import Retimed
from robots.robot import FloatArray

SCENE, CHART_WIDTH, CHART_HEIGHT = 330.0, 400.0, 200.0
MOST_POINTS = 600
"""Of a curve; more are not seen."""


def path_figure(
    results: Sequence[tuple[str, PathResult]],
    title: str,
    plane: str | None = None,
    motion: Retimed | None = None,
) -> str:
    """The arm among obstacles for each method, and curves of joints, clearance and error.

    Args:
        results: Labels and followed paths of one problem.
        title: Of the figure.
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
    charts = _charts(results)
    if motion is not None and motion.duration:
        charts += _motion_charts(results[0][1].problem, motion)
    width = SCENE + CHART_WIDTH + 30 if single else max(across * SCENE, 2 * CHART_WIDTH) + 20
    below = 0.0 if single else rows * (SCENE + 24)
    height = 40 + (
        max(SCENE + 40, len(charts) * CHART_HEIGHT)
        if single
        else below + -(-len(charts) // 2) * CHART_HEIGHT
    )
    canvas = Canvas(width, height, title)
    canvas.text((14, 22), title, 15, bold=True)
    reach = _with_obstacles(_reach(scenes), scenes) if spatial else _reach(scenes)
    for k, ((label, result), scene) in enumerate(zip(results, scenes, strict=True)):
        x, y = 10 + (k % across) * SCENE, 34 + (k // across) * (SCENE + 24)
        canvas.text((x + 40, y + 12), f"{label}: {_word(result)}", 12, bold=True)
        box = (x, y + 16, SCENE, SCENE)
        if spatial:
            draw_space(canvas, box, scene, f"scene{k}", reach)
        else:
            draw_scene(canvas, box, scene, plane, f"scene{k}", reach)
    for k, (curves, name, log, levels) in enumerate(charts):
        if single:
            box = (SCENE + 20, 34 + k * CHART_HEIGHT, CHART_WIDTH, CHART_HEIGHT)
        else:
            box = (
                10 + (k % 2) * CHART_WIDTH,
                40 + below + (k // 2) * CHART_HEIGHT,
                CHART_WIDTH,
                CHART_HEIGHT,
            )
        chart(canvas, box, curves, name, "t [s]", log=log, levels=levels)
    return canvas.render()


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
        _thinned(problem.path.targets)[:, [3, 7, 11]],
        posture(arm.chain, _thinned(result.q)).p,
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


def _charts(
    results: Sequence[tuple[str, PathResult]],
) -> list[tuple[list[Curve], str, bool, list[Level]]]:
    """Curves, title, whether logarithmic, and levels of each chart."""
    made: list[tuple[list[Curve], str, bool, list[Level]]] = []
    problem = results[0][1].problem
    if len(results) == 1:
        result = results[0][1]
        for is_revolute, unit in ((True, "rad"), (False, "m")):
            joints = [
                Curve(name, _times(result), _thinned(result.q[:, column]), COLORS[k % len(COLORS)])
                for k, (name, column) in enumerate(
                    zip(problem.arm.names, problem.arm.chain.columns, strict=True)
                )
                if bool(problem.arm.chain.is_angle[k]) is is_revolute
            ]
            if joints:
                made.append((joints, f"joints [{unit}]", False, []))
    labels = [("" if len(results) == 1 else label, result) for label, result in results]

    def each(values: Sequence[FloatArray]) -> list[Curve]:
        return [
            Curve(label, _times(result), _thinned(value), COLORS[k % len(COLORS)])
            for k, ((label, result), value) in enumerate(zip(labels, values, strict=True))
        ]

    if len(problem.obstacles):
        levels = [Level(problem.d_safe, "d_safe")] if problem.d_safe else []
        levels.append(Level(0.0, "contact"))
        clearance = each([result.measures.clearance for _, result in results])
        made.append((clearance, "clearance [m]", False, levels))
    tolerance = [Level(problem.tolerance.position, "tolerance")]
    error = each([result.measures.position_error for _, result in results])
    made.append((error, "position error [m]", True, tolerance))
    if len(results) > 1:
        steps = [np.concatenate(([0.0], result.measures.step)) for _, result in results]
        made.append((each(steps), "‖Δq‖ of a sample", False, []))
        if np.isfinite(problem.arm.chain.lower).any() or np.isfinite(problem.arm.chain.upper).any():
            margins = each([result.measures.limit_margin for _, result in results])
            name = "distance to the nearest joint limit"
            made.append((margins, name, False, [Level(0.0, "limit")]))
    return made


def _motion_charts(
    problem: PathProblem, motion: Retimed
) -> list[tuple[list[Curve], str, bool, list[Level]]]:
    """Speeds and accelerations of the motion in the shortest time, as parts of their limits."""
    made: list[tuple[list[Curve], str, bool, list[Level]]] = []
    for name, values, limits in (
        ("speeds", motion.velocity, motion.velocity_limits),
        ("accelerations", motion.acceleration, motion.acceleration_limits),
    ):
        curves = [
            Curve(
                joint,
                _thinned(motion.t),
                _thinned(values[:, column] / limits[column]),
                COLORS[k % len(COLORS)],
            )
            for k, (joint, column) in enumerate(
                zip(problem.arm.names, problem.arm.chain.columns, strict=True)
            )
            if np.isfinite(limits[column])
        ]
        if curves:
            levels = [Level(1.0, "limit"), Level(-1.0, "")]
            made.append((curves, f"in the shortest time: {name} / limit", False, levels))
    return made


def _times(result: PathResult) -> FloatArray:
    return _thinned(result.problem.path.t[: len(result.q)])


def _thinned(values: FloatArray) -> FloatArray:
    """At most ``MOST_POINTS`` of the rows, first and last among them."""
    if len(values) <= MOST_POINTS:
        return values
    return np.asarray(values[np.linspace(0, len(values) - 1, MOST_POINTS).round().astype(int)])
