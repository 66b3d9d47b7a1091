"""No call compiles anything that the warm-up has not compiled."""

import numpy as np

from kinematics import kernels
from kinematics.forward import fk
from kinematics.inverse import compiled_solve as routine
from kinematics.inverse import solve_ik, solve_ik_batch
from kinematics.jacobian import jacobian
from kinematics.warm import warm_up
from robots.shipped import shipped_robot


def test_read_only_and_scattered_arrays_are_no_new_types():
    warm_up()
    watched = (kernels.forward_many, kernels.jacobian_many, routine.solve_one, routine.solve_many)
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
