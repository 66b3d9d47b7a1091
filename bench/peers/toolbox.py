"""roboticstoolbox-python: Levenberg-Marquardt in C++ on its own elementary transforms."""

from __future__ import annotations

from bench.peers.arms import Arm
from bench.peers.peer import Solve
from robots.robot import FloatArray


def toolbox(arm: Arm) -> Solve:
    from roboticstoolbox import ET, ETS

    low, high = arm.ranges
    parts = [ET.SE3(arm.placements[0])]
    for k, placement in enumerate(arm.placements[1:]):
        parts += [ET.Rz(qlim=[low[k], high[k]]), ET.SE3(placement)]
    ets = ETS(parts)
    mask = [float(row in arm.task.rows) for row in range(6)]

    def solve(target: FloatArray) -> FloatArray:
        return ets.ik_LM(target, q0=arm.seed, tol=1e-13, mask=mask).q

    return solve
