"""The charts of a followed path, or of several methods on one path."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from app.http.units import Units
from app.pictures.canvas import COLORS
from app.pictures.chart import Chart
from app.pictures.curves import Curve, Level
from kinematics.redundancy.follow import PathResult
from kinematics.redundancy.measure import manipulability_at
from kinematics.redundancy.problem import PathProblem
from kinematics.redundancy.timing.result import Retimed
from robots.robot import FloatArray

TIME = "t [s]"
EachCurve = Callable[[Sequence[FloatArray]], list[Curve]]
MOST_POINTS = 600
"""Of a curve; more are not seen."""


def path_charts(results: Sequence[tuple[str, PathResult]], units: Units) -> list[Chart]:
    """Return the charts of results: joints of one, then what they share.

    Args:
        results: Labels and followed paths of one problem.
        units: Of angles.
    """
    problem = results[0][1].problem
    single = len(results) == 1
    angle = units.named["angle"]
    degree = float(units.angles_out(np.array(1.0)))
    made = _joint_charts(results[0][1], units) if single else []

    def each(values: Sequence[FloatArray]) -> list[Curve]:
        return [
            Curve("" if single else label, _times(result), thinned(value), _color(k))
            for k, ((label, result), value) in enumerate(zip(results, values, strict=True))
        ]

    every = [result for _, result in results]
    if len(problem.obstacles):
        levels = [Level(problem.d_safe, "d_safe")] if problem.d_safe else []
        levels.append(Level(0.0, "contact"))
        clearance = each([result.measures.clearance for result in every])
        made.append(Chart(clearance, "clearance [m]", TIME, levels=levels))
    task, tolerance = problem.arm.task, problem.tolerance
    if task.positions or not task.rotations:
        error = each([result.measures.position_error for result in every])
        levels = [Level(tolerance.position, "tolerance")]
        made.append(Chart(error, "position error [m]", TIME, log=True, levels=levels))
    if task.rotations:
        error = each([degree * result.measures.orientation_error for result in every])
        levels = [Level(degree * tolerance.orientation, "tolerance")]
        made.append(Chart(error, f"orientation error [{angle}]", TIME, log=True, levels=levels))
    w = each([manipulability_at(problem, result.q) for result in every])
    made.append(Chart(w, f"manipulability, {task.name}", TIME))
    return made if single else [*made, *_step_charts(every, each, units)]


def _step_charts(results: Sequence[PathResult], each: EachCurve, units: Units) -> list[Chart]:
    """Return the charts of steps and of distances to limits, over all joints of the arm."""
    chain = results[0].problem.arm.chain
    turning, sliding = bool(chain.is_angle.any()), bool((~chain.is_angle).any())
    angle = units.named["angle"]
    # Of joints that turn and slide the numbers are mixed: they stay in rad and m.
    unit = "rad, m" if turning and sliding else angle if turning else "m"
    factor = 1.0 if sliding else float(units.angles_out(np.array(1.0)))
    steps = [factor * np.concatenate(([0.0], result.measures.step)) for result in results]
    made = [Chart(each(steps), f"‖Δq‖ of a sample [{unit}]", TIME)]
    if np.isfinite(chain.lower).any() or np.isfinite(chain.upper).any():
        margins = each([factor * result.measures.limit_margin for result in results])
        name = f"distance to the nearest joint limit [{unit}]"
        made.append(Chart(margins, name, TIME, levels=[Level(0.0, "limit")]))
    return made


def _joint_charts(result: PathResult, units: Units) -> list[Chart]:
    """Return q(t), turning joints and slides apart."""
    arm = result.problem.arm
    made = []
    for turns, unit in ((True, units.named["angle"]), (False, "m")):
        joints = [
            Curve(
                name,
                _times(result),
                thinned(units.angles_out(q) if turns else q),
                _color(k),
            )
            for k, (name, column) in enumerate(zip(arm.names, arm.chain.columns, strict=True))
            if bool(arm.chain.is_angle[k]) is turns
            for q in (result.q[:, column],)
        ]
        if joints:
            made.append(Chart(joints, f"joints [{unit}]", TIME))
    return made


def motion_charts(problem: PathProblem, motion: Retimed) -> list[Chart]:
    """Speeds and accelerations of the motion in the shortest time, as parts of their limits."""
    made: list[Chart] = []
    for name, values, limits in (
        ("speeds", motion.velocity, motion.velocity_limits),
        ("accelerations", motion.acceleration, motion.acceleration_limits),
    ):
        curves = [
            Curve(joint, thinned(motion.t), thinned(values[:, column] / limits[column]), _color(k))
            for k, (joint, column) in enumerate(
                zip(problem.arm.names, problem.arm.chain.columns, strict=True)
            )
            if np.isfinite(limits[column])
        ]
        if curves:
            levels = [Level(1.0, "limit"), Level(-1.0, "")]
            title = f"in the shortest time: {name} / limit"
            made.append(Chart(curves, title, TIME, levels=levels))
    return made


def _color(k: int) -> str:
    return COLORS[k % len(COLORS)]


def _times(result: PathResult) -> FloatArray:
    return thinned(result.problem.path.t[: len(result.q)])


def thinned(values: FloatArray) -> FloatArray:
    """At most ``MOST_POINTS`` of the rows, first and last among them."""
    if len(values) <= MOST_POINTS:
        return values
    return np.asarray(values[np.linspace(0, len(values) - 1, MOST_POINTS).round().astype(int)])
