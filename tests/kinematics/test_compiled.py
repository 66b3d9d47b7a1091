"""No call compiles anything that the warm-up has not compiled."""

import json
import subprocess
import sys

import numpy as np
from numba.core.dispatcher import Dispatcher

from kinematics.forward import fk
from kinematics.inverse import IKOptions, solve_ik, solve_ik_batch
from kinematics.inverse import compiled_solve as routine
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.lanes import targets
from kinematics.jacobian import jacobian
from kinematics.lanes import batches
from kinematics.named_singularities import factorization
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.link_geometry import link_geometry, too_near
from kinematics.redundancy.clearance.obstacles import (
    Box,
    Capsule,
    CircleObstacle,
    HalfSpace,
    Sphere,
    encoded,
)
from kinematics.redundancy.follow import followed
from kinematics.redundancy.measure import ends_of_links
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import Gains, PathOptions, PathProblem, SecondaryTask
from kinematics.task import TASKS
from kinematics.warm import warm_up
from robots.shipped import shipped_robot

WORLD = [
    Sphere((0.2, 0.2, 0.9), 0.08),
    CircleObstacle((0.0, 1.2), 0.1),
    Capsule((-0.5, 0.5, 0.0), (-0.5, 0.5, 1.0), 0.05),
    HalfSpace((0, 0, 1), -0.2),
    Box((0.5, -0.5, 0.3), (0.2, 0.1, 0.3)),
]


def signatures():
    """How many signatures of each compiled function there are."""
    return {
        f"{name}.{key}": len(function.signatures)
        for name, module in sys.modules.items()
        if name.startswith("kinematics.")
        for key, function in vars(module).items()
        if isinstance(function, Dispatcher)
    }


def solve_everything():
    for name in ("panda", "puma560", "ur5", "scara", "pa10", "planar_2r", "talos_arm"):
        robot = shipped_robot(name)
        q = np.clip(np.full((3, robot.dof), 0.3), robot.lower, robot.upper)
        poses = fk(robot, q)[robot.tip_frame]
        jacobian(robot, q)
        for task in TASKS.values():
            solve_ik(robot, poses[0], task=task, seed=q[0], options=IKOptions(max_restarts=1))
            all_solutions(robot, poses[0], task=task, options=IKOptions(max_iterations=1))
        solve_ik_batch(robot, poses, seed=q[0], threads=2)
        factorization(robot, q, TASKS["pose"])


def follow_everything():
    for name, task, obstacles in (
        ("panda", "pose", WORLD),
        ("panda", "position_direction", WORLD),
        ("planar_8r", "xy", WORLD[:2]),
        ("scara", "xyz_phi", []),
    ):
        robot, space = shipped_robot(name), TASKS[task]
        arm = Arm.of(robot, None, space)
        q = np.clip(np.linspace(0.2, 0.5, robot.dof), robot.lower, robot.upper)
        start = fk(robot, q)[robot.tip_frame]
        goal = start.copy()
        goal[:3, 3] += (0.02, 0.01, 0.0)
        path = polyline(start, [goal], space, Sampling(samples=8))
        shaped = link_geometry(arm, q, np.full(arm.K, 0.02))
        too_near(shaped, encoded(WORLD), 0.01)
        lower_task = SecondaryTask(arm, start[:3].reshape(12).copy())
        for geometry in (None, shaped):
            problem = PathProblem(arm, q, path, encoded(obstacles), d_safe=0, shaped=geometry)
            ends_of_links(problem, problem.first[None])
            for method in METHODS.values():
                if method.name == "whole_path":  # CasADi's program about the kernels of qp
                    continue
                for gains in (None, Gains(1, 1, 1, 1)):
                    options = PathOptions(
                        gains=gains, secondary=(lower_task,), obstacle_weight=1, margin=0
                    )
                    followed(problem, method, options)


def main():
    warm_up()
    before = signatures()
    solve_everything()
    follow_everything()
    after = signatures()
    more = {name: [n, after[name]] for name, n in before.items() if n != after[name]}
    sys.stdout.write(json.dumps(more))


def test_no_robot_task_or_obstacle_is_a_new_type():
    """In a process of its own: other tests call the functions in ways that no request does."""
    found = subprocess.run(
        [sys.executable, __file__], capture_output=True, text=True, check=True, timeout=600
    )
    assert json.loads(found.stdout) == {}


def test_read_only_and_scattered_arrays_are_no_new_types():
    warm_up()
    watched = (batches.forward_many, batches.jacobian_many, routine.solve_at_once, targets.advance)
    before = [len(function.signatures) for function in watched]
    robot = shipped_robot("panda")
    q = np.full((4, robot.dof), 0.3)
    poses = fk(robot, q)[robot.tip_frame]
    for array in (q, poses):
        array.flags.writeable = False
    fk(robot, q)
    jacobian(robot, q)
    fk(robot, np.asfortranarray(q))
    solve_ik(robot, poses[0], seed=q[0])
    solve_ik(robot, np.asfortranarray(poses[0]))
    solve_ik_batch(robot, poses, seed=q[0])
    assert [len(function.signatures) for function in watched] == before


if __name__ == "__main__":
    main()
