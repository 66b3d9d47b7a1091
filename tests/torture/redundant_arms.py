"""Arms of seven joints: ``python -m tests.torture.redundant_arms``.

iiwa with five sets of limits: wherever the numeric solver has an answer, a solution within the
limits is listed. Panda, xArm 7 and Gen3: every answer of the numeric solver is on a self-motion
that was swept, to 1e-6 where the parameter is the same.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np

from kinematics.forward import fk
from kinematics.inverse import IKStatus, solve_ik
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.self_motion.tracing import is_on
from tests.kinematics.inverse.test_self_motion import (
    ARMS,
    IIWA,
    TIGHT,
    all_curves,
    ranges,
    robot_of,
)

SETS = {
    "tight": TIGHT,
    "tighter": [(low + 0.1, high - 0.1) for low, high in TIGHT],
    "±0.6, bent": [(-0.6, 0.6)] * 3 + [(-1.9, -0.3)] + [(-0.6, 0.6)] * 3,
    "one side": [(0.0, 1.2)] * 7,
    "maker's": [(-2.97, 2.97), (-2.09, 2.09)] * 3 + [(-3.05, 3.05)],
}
SEEDS = 4


def tight_limits(name: str, targets: int) -> tuple[int, int]:
    """Return how many targets the numeric solver reached, and of how many no solution is listed."""
    robot, rng = robot_of(*IIWA, SETS[name]), np.random.default_rng(17)
    reached = without = 0
    for number in range(targets):
        target = fk(robot, rng.uniform(robot.lower, robot.upper))[robot.tip_frame]
        if number % 4 == 3:  # also targets that only a corner of the limits may reach
            target[:3, 3] += rng.normal(scale=0.05, size=3)
        if solve_ik(robot, target).status is IKStatus.CONVERGED:
            reached += 1
            found = all_solutions(robot, target)
            if not any(one.within_limits for one in found.solutions):
                without += 1
                print(f"{name}, target {number}: none within the limits", flush=True)
    return reached, without


def on_curves(name: str, targets: int) -> tuple[int, int]:
    """Return how many answers of the numeric solver there were, and how many are on no curve."""
    robot, rng = ARMS[name](), np.random.default_rng(23)
    answers = off = 0
    for number in range(targets):
        target = fk(robot, rng.uniform(*ranges(robot)))[robot.tip_frame]
        motion, curves = all_curves(robot, target)
        for seed in rng.uniform(*ranges(robot), (SEEDS, robot.dof)):
            result = solve_ik(robot, target, seed=seed)
            if result.status is not IKStatus.CONVERGED:
                continue
            answers += 1
            # The solver stops within its tolerance of the set; the nearest point of it counts.
            if not any(is_on(motion, curve, motion.settled(result.q)) for curve in curves):
                off += 1
                print(f"{name}, target {number}: {result.q.tolist()} on no curve", flush=True)
    return answers, off


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--targets", type=int, default=500, help="of each arm; iiwa has twice")
    options = parser.parse_args()
    wrong = 0
    for name in SETS:
        reached, without = tight_limits(name, 2 * options.targets)
        wrong += without
        print(f"iiwa, {name}: {reached} of {2 * options.targets} reached, {without} without")
    for name in ARMS:
        answers, off = on_curves(name, options.targets)
        wrong += off
        print(f"{name}: {answers} answers at {options.targets} targets, {off} on no curve")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
