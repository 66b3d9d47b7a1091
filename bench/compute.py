"""FK and Jacobians against a bare Pinocchio loop."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from bench.pairs import Row, paired
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from robots.shipped import shipped_robot

POSES = 10_000


def run() -> list[Row]:
    return [row for name in ("puma560", "panda", "planar_8r") for row in rows_of(name)]


def rows_of(name: str) -> list[Row]:
    robot = shipped_robot(name)
    q = np.random.default_rng(0).uniform(-1, 1, (POSES, robot.dof))
    configurations = np.array([robot.configuration(one) for one in q])
    model, data = robot.model, robot.model.createData()
    tip = robot.frame_id(robot.tip_frame)

    def loop_fk() -> None:
        out = np.empty((POSES, 4, 4))
        for k, configuration in enumerate(configurations):
            pin.forwardKinematics(model, data, configuration)
            out[k] = pin.updateFramePlacement(model, data, tip).homogeneous

    def loop_jacobian() -> None:
        out = np.empty((POSES, 6, model.nv))
        frame = pin.LOCAL_WORLD_ALIGNED
        for k, configuration in enumerate(configurations):
            out[k] = pin.computeFrameJacobian(model, data, configuration, tip, frame)

    def one_fk() -> None:
        pin.forwardKinematics(model, data, configurations[0])
        pin.updateFramePlacement(model, data, tip).homogeneous.copy()

    many, one = "a pose of a batch | a bare Pinocchio loop", "one FK, q checked | bare Pinocchio"
    return [
        paired(f"{name}: FK, {many}", lambda: fk(robot, q), loop_fk, per=POSES),
        paired(f"{name}: Jacobian, {many}", lambda: jacobian(robot, q), loop_jacobian, per=POSES),
        paired(f"{name}: {one}", lambda: fk(robot, q[0]), one_fk, repeat=500),
    ]
