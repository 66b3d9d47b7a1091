"""Closed forms. Of all their answers, the one nearest to the seed within the limits is taken."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import sys

import numpy as np

from bench.peers.arms import Arm, Unsupported
from bench.peers.peer import Solve
from robots.robot import FloatArray


def eaik(arm: Arm) -> Solve:
    from eaik.IK_Robot import EAIK

    H, P, R = _axes(arm)
    dof = len(H)
    if dof not in (6, 7):
        raise Unsupported(f"closed forms for 6 or 7 joints, not {dof}")

    def made(fixed: list[tuple[int, float]]):
        return EAIK.Robot(H.T, P.T, R, fixed, True)

    if dof == 6:
        robots = [made([])]
        if not robots[0].has_known_decomposition():
            raise Unsupported("no known decomposition")
        return _nearest(arm, robots)
    choices = []
    for k in range(7):
        robots = [made([(k, q[k])]) for q in arm.starts()]
        if all(robot.has_known_decomposition() for robot in robots):
            choices.append(_nearest(arm, robots))
    if not choices:
        raise Unsupported("no known decomposition with one joint locked")
    trial = arm.targets(20, 998)
    return max(choices, key=lambda solve: sum(arm.solved(solve(T), T) for T in trial))


def _nearest(arm: Arm, robots: list) -> Solve:
    low, high = arm.slack

    def solve(target: FloatArray) -> FloatArray | None:
        for robot in robots:
            found = robot.calculate_IK(target)
            exact = ~np.asarray(found.is_LS, dtype=bool)
            if not exact.any():
                continue
            q = arm.turned(np.asarray(found.Q)[exact])
            q = q[((q >= low) & (q <= high)).all(axis=1)]
            if len(q):
                return q[np.abs(q - arm.seed).max(axis=1).argmin()]
        return None

    return solve


def _axes(arm: Arm) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Axes and offsets at q = 0, in the base's axes, and the tip's rotation there."""
    T, H, points = np.eye(4), [], [np.zeros(3)]
    for placement in arm.placements[:-1]:
        T = T @ placement
        H.append(T[:3, 2])
        points.append(T[:3, 3])
    T = T @ arm.placements[-1]
    points.append(T[:3, 3])
    return np.array(H), np.diff(points, axis=0), T[:3, :3]


def ssik(arm: Arm) -> Solve:
    from ssik import cli

    if arm.robot.dof not in (6, 7):
        raise Unsupported(f"closed forms for 6 or 7 joints, not {arm.robot.dof}")
    module = f"{arm.name}_ik"
    path = arm.urdf.with_name(f"{module}.py")
    chain = ["--base", arm.robot.base_frame, "--ee", arm.robot.tip_frame]
    made = ["--out", str(path), "--module-name", module, "--no-validate"]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        cli.main(["build", str(arm.urdf), *chain, *made])
    spec = importlib.util.spec_from_file_location(module, path)
    if spec is None or spec.loader is None:
        raise Unsupported("nothing was built")
    built = importlib.util.module_from_spec(spec)
    sys.modules[module] = built
    spec.loader.exec_module(built)

    def solve(target: FloatArray) -> FloatArray | None:
        found = built.solve(target, max_solutions=1, q_seed=arm.seed, native=True)
        return np.asarray(found[0].q) if found else None

    return solve
