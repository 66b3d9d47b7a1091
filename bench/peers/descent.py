"""Differential and optimizing solvers; the loop of steps and restarts is what their users write."""

from __future__ import annotations

import warnings
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from bench.peers.arms import Arm
from bench.peers.peer import Solve
from robots.robot import FloatArray

STEPS = 100
"""Steps of one start."""
ENOUGH = 1e-7
DAMPING = 1e-2


def pink(arm: Arm) -> Solve:
    import pink as lib
    from pink.limits import ConfigurationLimit

    model = pin.buildModelFromUrdf(str(arm.bounded))
    task = lib.FrameTask(arm.robot.tip_frame, 1.0, 1.0, lm_damping=DAMPING)
    limits, starts = [ConfigurationLimit(model, config_limit_gain=1.0)], arm.starts()
    configuration = lib.Configuration(model, model.createData(), starts[0], copy_data=False)

    def solve(target: FloatArray) -> FloatArray | None:
        task.set_target(pin.SE3(target))
        for start in starts:
            configuration.update(start)
            for _ in range(STEPS):
                if np.linalg.norm(task.compute_error(configuration)) < ENOUGH:
                    return arm.clipped(configuration.q)
                v = lib.solve_ik(
                    configuration, [task], 1.0, "daqp", limits=limits, safety_break=False
                )
                configuration.integrate_inplace(v, 1.0)
        return None

    return solve


def mink(arm: Arm) -> Solve:
    import mink as lib
    import mujoco

    root = ET.fromstring(arm.urdf.read_text("utf-8"))
    extension = ET.SubElement(root, "mujoco")
    ET.SubElement(extension, "compiler", fusestatic="false", discardvisual="true")
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    task = lib.FrameTask(arm.robot.tip_frame, "body", 1.0, 1.0, lm_damping=DAMPING)
    limits, starts = [lib.ConfigurationLimit(model, gain=1.0)], arm.starts()
    configuration = lib.Configuration(model)

    def solve(target: FloatArray) -> FloatArray | None:
        task.set_target(lib.SE3.from_matrix(target))
        for start in starts:
            configuration.update(start)
            for _ in range(STEPS):
                if np.linalg.norm(task.compute_error(configuration)) < ENOUGH:
                    return arm.clipped(configuration.q)
                v = lib.solve_ik(configuration, [task], 1.0, "daqp", limits=limits)
                configuration.integrate_inplace(v, 1.0)
        return None

    return solve


def ikpy(arm: Arm) -> Solve:
    from ikpy.chain import Chain

    path = str(arm.bounded)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        chain = Chain.from_urdf_file(path, base_elements=[arm.robot.base_frame])
    active = np.array([link.joint_type not in ("fixed", None) for link in chain.links])
    chain.active_links_mask = active
    starts = []
    for start in arm.starts():
        starts.append(np.zeros(len(active)))
        starts[-1][active] = start

    def solve(target: FloatArray) -> FloatArray | None:
        for start in starts:
            q = chain.inverse_kinematics_frame(
                target, initial_position=start, orientation_mode="all", tol=1e-13
            )
            if np.abs(chain.forward_kinematics(q) - target).max() < ENOUGH:
                return np.asarray(q)[active]
        return None

    return solve
