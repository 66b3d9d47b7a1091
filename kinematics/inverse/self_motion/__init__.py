"""Self-motions: the curves of joint values that an arm with one joint more than needed moves along.

For one target such an arm has, instead of single solutions, curves of them. Each is followed to its
ends (:mod:`tracing`; arms with a spherical shoulder and wrist by their swivel angle,
:mod:`swivel_curves`), and cut where a joint meets its limits (:mod:`pieces`).

J. Burdick, On the inverse kinematics of redundant manipulators: characterization of the self-motion
manifolds, IEEE International Conference on Robotics and Automation, 1989; M. Shimizu et al.,
Analytical inverse kinematic computation for 7-DOF redundant manipulators with joint limits, IEEE
Transactions on Robotics 24(5), 2008.
"""
