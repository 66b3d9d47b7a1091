"""Targets of an arm: random ones, singular ones, and those of round joint values."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from bench.all_solutions.arms import Arm
from robots.robot import FloatArray

ROUND = np.pi / 4
"""Joint values of which special targets are made are multiples of it."""


def targets(arm: Arm, count: int, seed: int) -> list[tuple[str, FloatArray]]:
    """Return kinds of targets and the q they are made of: two in four random, one singular."""
    rng = np.random.default_rng(seed)
    made: list[tuple[str, FloatArray]] = []
    for number in range(count):
        kind = ("random", "singular", "random", "round")[number % 4]
        q = arm.random(rng)
        if kind == "singular":
            q = _singular(arm, rng)
        elif kind == "round":
            q = np.round(q / ROUND) * ROUND
        made.append((kind, q))
    return made


def _singular(arm: Arm, rng: np.random.Generator) -> FloatArray:
    """Where the determinant of the Jacobian changes its sign between two random q."""
    while True:
        start, end = arm.random(rng), arm.random(rng)

        def determinant(t: float, start: FloatArray = start, end: FloatArray = end) -> float:
            return float(np.linalg.det(arm.jacobian(start + t * (end - start))))

        if determinant(0.0) * determinant(1.0) < 0:
            t = brentq(determinant, 0.0, 1.0, xtol=1e-15)
            return start + float(t) * (end - start)
