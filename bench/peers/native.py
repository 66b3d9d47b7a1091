"""Compiled numeric solvers that read the URDF."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from bench.peers.arms import RESTARTS, Arm
from bench.peers.peer import Solve
from robots.robot import FloatArray

SECONDS = 0.1
"""For those that restart until their time is over."""


def optik(arm: Arm) -> Solve:
    from optik import Robot, SolverConfig

    robot = Robot.from_urdf_file(str(arm.bounded), arm.robot.base_frame, arm.robot.tip_frame)
    robot.set_parallelism(1)
    # It takes a fixed joint at the base the wrong way round; a constant shift makes up for it.
    shift = np.array(robot.fk(arm.seed)) @ np.linalg.inv(arm.pose(arm.seed))
    config = SolverConfig("speed", max_time=SECONDS, tol_f=1e-13)

    def solve(target: FloatArray) -> FloatArray | None:
        found = robot.ik(config, shift @ target, arm.seed)
        return None if found is None else np.array(found[0])

    return solve


def pytracik(arm: Arm) -> Solve:
    import pytracik as trac

    urdf, base, tip = arm.urdf.read_text("utf-8"), arm.robot.base_frame, arm.robot.tip_frame
    solver = trac.TRAC_IK(base, tip, urdf, SECONDS, 1e-7, trac.SolveType.Speed)
    if np.isfinite(arm.robot.lower).all():  # it keeps those of the URDF in single precision
        trac.set_joint_limits(solver, list(arm.robot.lower), list(arm.robot.upper))

    def solve(target: FloatArray) -> FloatArray | None:
        x, y, z, w = pin.Quaternion(target[:3, :3]).coeffs()
        status, *q = trac.ik(solver, arm.seed, *target[:3, 3], x, y, z, w)
        return np.array(q) if status >= 0 else None

    return solve


def cartan_race(arm: Arm) -> Solve:
    import cartan

    return _cartan(arm, cartan.solve_ik)


def cartan_speed(arm: Arm) -> Solve:
    import cartan

    return _cartan(arm, cartan.solve_ik_speed)


def _cartan(arm: Arm, call) -> Solve:
    import cartan

    chain = cartan.load_urdf(str(arm.urdf)).chain
    config = cartan.IkConfig(
        position_tol=1e-7,
        orientation_tol=1e-7,
        max_total_iterations=100 * (RESTARTS + 1),
        max_total_work_units=100 * (RESTARTS + 1),
    )

    def solve(target: FloatArray) -> FloatArray:
        return call(chain, cartan.SE3.from_matrix(target), arm.seed, config).q

    return solve


def dynibo(arm: Arm) -> Solve:
    from dynibo import DyniboError, IkOptions, Pose, Robot

    robot = Robot.from_urdf(str(arm.urdf))
    tip = robot.link_id(arm.robot.tip_frame)
    options = IkOptions(translation_tolerance=1e-7, rotation_tolerance=1e-7)
    starts = arm.starts()

    def solve(target: FloatArray) -> FloatArray | None:
        pose = Pose(target[:3, 3], pin.Quaternion(target[:3, :3]).coeffs())
        for start in starts:
            try:
                q = np.asarray(robot.inverse_kinematics(start, tip, pose, options))
            except DyniboError:
                continue
            if arm.within(q) or arm.within(q := arm.turned(q)):
                return q
        return None

    return solve
