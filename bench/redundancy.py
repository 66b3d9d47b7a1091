"""A sample of a path of the 8R arm past two discs, method by method, measured in turns.

The other column is a prototype's, in plain Python on the same kind of machine.
"""

from __future__ import annotations

import statistics

import numpy as np

from bench.pairs import Row
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.obstacles import CircleObstacle, encoded
from kinematics.redundancy.follow import followed
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.task import task_from
from robots.shipped import shipped_robot

ROUNDS = 9
PROTOTYPES = {"pseudo_inverse": 0.14, "null_space": 1.2, "sqp": 8.3, "qp": 1.8}
"""Milliseconds a sample."""


def problem() -> PathProblem:
    robot, task = shipped_robot("planar_8r"), task_from("xy")
    q = np.deg2rad([110.0, -15, -25, -30, -30, -20, 0, 10])
    start = fk(robot, q)[robot.tip_frame]
    goal = start.copy()
    goal[:2, 3] = 1.15, -0.15
    discs = encoded([CircleObstacle((0.73, 0.22), 0.08), CircleObstacle((0.91, -0.04), 0.08)])
    path = polyline(start, [goal], task, Sampling())
    return PathProblem(Arm.of(robot, None, task), q, path, discs, 0.02, 0.02)


def run() -> list[Row]:
    what, options = problem(), PathOptions()
    times: dict[str, list[float]] = {name: [] for name in PROTOTYPES}
    for k in range(ROUNDS + 1):
        for name, taken in times.items():
            found = followed(what, METHODS[name], options)
            if k:  # the first round warms up
                taken.append(found.elapsed * 1e3 / (len(found.q) - 1))
    median = {name: statistics.median(taken) for name, taken in times.items()}
    rows = [
        Row(
            f"8R past two discs: {name}, a sample | prototype",
            f"{median[name]:.4f} ms",
            f"{other:.2f} ms",
            median[name] / other,
        )
        for name, other in PROTOTYPES.items()
    ]
    ratio = statistics.median(a / b for a, b in zip(times["qp"], times["sqp"], strict=True))
    qp, sqp = median["qp"], median["sqp"]
    return [*rows, Row("8R past two discs: qp | sqp", f"{qp:.4f} ms", f"{sqp:.4f} ms", ratio)]


if __name__ == "__main__":
    for row in run():
        print(f"{row.what:50}  {row.ours:>12}  {row.other:>12}  ratio {row.ratio:.3f}")
