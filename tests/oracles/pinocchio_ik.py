"""The oracle of the compiled inverse kinematics: the same method in plain Python on Pinocchio.

Poses and Jacobians are Pinocchio's, linear equations NumPy's. Levenberg-Marquardt for any chain,
frame and task, damped by the error (Chan and Lawrence 1988; Sugihara, IEEE T-RO 27(5), 2011): with
the residual ``E = ½ eᵀe``, ``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e`` and ``λ = 0.03 E + 1e-10``. Joints that
span a turn wrap; others are held at a limit as long as the step would push them through it. A start
that stalls is given up for the next one. Every answer is measured by forward kinematics.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from kinematics.chain import chain_of
from kinematics.deadline import current
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.criteria import (
    DAMPING,
    FLOOR,
    MAX_DAMPING,
    SETTLED,
    STALL_RATIO,
    STALLS,
    UNREACHABLE_RESTARTS,
)
from kinematics.inverse.result import IKOptions, IKResult, IKStatus
from kinematics.inverse.starts import starts
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot


@dataclass
class _Best:
    """The best q so far: one that converged, else the one of the least residual energy."""

    q: FloatArray
    energy: float = np.inf
    converged: bool = False

    def offer(self, q: FloatArray, energy: float, converged: bool) -> None:
        """Keeps q where it is better."""
        if converged or energy < self.energy:
            self.q, self.energy, self.converged = q.copy(), energy, converged


class _Problem:
    """One target for one frame of one robot: error and Jacobian at q."""

    def __init__(self, robot: Robot, target: FloatArray, frame: str, task: Task) -> None:
        self.robot = robot
        self.model, self.data = robot.model, robot.data()
        self.tip = robot.frame_id(frame)
        self.base = robot.frame_id(robot.base_frame)
        self.task = task
        self.rows = list(task.rows)
        self.linear, self.angular = list(task.positions), list(task.rotations)
        self.moving = chain_of(robot, frame).columns
        self.columns = robot.velocity_columns[self.moving]
        self.R, self.p = target[:3, :3], target[:3, 3]
        self.fixed_base = bool(
            pin.SE3(self.model.frames[self.base].placement).isIdentity(0.0)
        ) and (self.model.frames[self.base].parentJoint == 0)

    def residual(self, q: FloatArray) -> tuple[FloatArray, float, float]:
        """Task error (rows), and the norms of its position and rotation parts."""
        pin.computeJointJacobians(self.model, self.data, self.robot.configuration(q))
        pin.updateFramePlacement(self.model, self.data, self.tip)
        pose = self.data.oMf[self.tip]
        if not self.fixed_base:
            pin.updateFramePlacement(self.model, self.data, self.base)
            pose = self.data.oMf[self.base].actInv(pose)
        twist = np.empty(6)
        twist[:3] = self.p - pose.translation
        twist[3:] = pin.log3(self.R @ pose.rotation.T)
        if self.task.own_axes:
            twist[3:] = pose.rotation.T @ _across(pose.rotation, self.R[:, 2])
        self.rotation = pose.rotation.copy()
        position = float(np.linalg.norm(twist[self.linear])) if self.linear else 0.0
        orientation = float(np.linalg.norm(twist[3:][self.angular])) if self.angular else 0.0
        return twist[self.rows], position, orientation

    def jacobian(self) -> FloatArray:
        """Task Jacobian at the q of the last residual; shape (rows, moving joints)."""
        aligned = pin.LOCAL_WORLD_ALIGNED
        J = pin.getFrameJacobian(self.model, self.data, self.tip, aligned).reshape(6, -1)
        if not self.fixed_base:
            base, tip = self.data.oMf[self.base], self.data.oMf[self.tip]
            J_base = pin.getFrameJacobian(self.model, self.data, self.base, aligned).reshape(6, -1)
            J = J - J_base
            J[:3] -= np.cross(J_base[3:], tip.translation - base.translation, axis=0)
            J = np.concatenate((base.rotation.T @ J[:3], base.rotation.T @ J[3:]))
        return self.task.of(J[:, self.columns], self.rotation)


def _across(R: FloatArray, z: FloatArray) -> FloatArray:
    """Rotation vector that turns the z axis of R to z, in base axes; perpendicular to both."""
    axis = np.cross(R[:, 2], z)
    sine, cosine = float(np.linalg.norm(axis)), float(R[:, 2] @ z)
    if sine < 1e-9:
        return np.asarray(np.pi * R[:, 0] if cosine < 0 else axis)
    return np.asarray(np.arctan2(sine, cosine) / sine * axis)


def solve_on_pinocchio(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    options: IKOptions | None = None,
) -> IKResult:
    """Finds a q within the limits that brings a frame to a target.

    Only the joints between the base and the frame move; the others stay at the seed.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4; rows outside the task do not
            count.
        frame: Frame name; default the tip.
        task: The task space, in base axes. The rotation error is the rotation vector of
            ``R_target Rᵀ``.
        seed: First start, shape (dof,), rad and m; default mid-range. Beyond a limit it is
            brought inside.
        options: Tolerance, restarts, time; see :class:`IKOptions`.

    Returns:
        The result; ``status`` is ``converged`` only where the measured error says so.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    options = options or IKOptions()
    frame = frame or robot.tip_frame
    started = time.perf_counter()
    deadline = started + options.time_budget
    bounds = JointBounds.of(robot)
    start = bounds.inside(bounds.middle() if seed is None else np.asarray(seed, dtype=np.float64))
    problem = _Problem(robot, target, frame, task)
    chain = chain_of(robot, frame)
    centre, reach = chain.placements[0, [3, 7, 11]], chain.reach
    unreachable = _beyond(target, centre, reach, task, options)
    max_restarts = (
        min(options.max_restarts, UNREACHABLE_RESTARTS) if unreachable else options.max_restarts
    )
    low, high = bounds.ranges(reach if np.isfinite(reach) else 1.0)
    sequence = starts(options.random_seed, low[problem.moving], high[problem.moving])
    best, q = _Best(start), start
    iterations = restarts = 0
    wanted = current()
    while True:
        wanted.check_wanted()
        iterations += _descend(problem, bounds, q, options, deadline, best)
        if best.converged or restarts >= max_restarts or time.perf_counter() >= deadline:
            break
        restarts += 1
        offset, ratio, lowest, span = sequence
        q = start.copy()
        q[problem.moving] = lowest + (offset + restarts * ratio) % 1.0 * span
    if not best.converged:
        iterations += _settle(problem, bounds, options, deadline, best)
    answer = best.q.copy()
    answer[problem.moving] = bounds.nearest(best.q, start)[problem.moving]
    _, position, orientation = problem.residual(answer)
    within = bool(((answer >= robot.lower) & (answer <= robot.upper)).all())
    if within and _reached(position, orientation, options):
        status = IKStatus.CONVERGED
    elif unreachable:
        status = IKStatus.UNREACHABLE
    elif time.perf_counter() >= deadline:
        status = IKStatus.TIMEOUT
    else:
        status = IKStatus.NOT_CONVERGED
    elapsed = time.perf_counter() - started
    return IKResult(status, answer, start, position, orientation, iterations, restarts, elapsed)


def _beyond(
    target: FloatArray, centre: FloatArray, reach: float, task: Task, options: IKOptions
) -> bool:
    """True where the target is provably out of reach."""
    rows = list(task.positions)
    distance = float(np.linalg.norm((target[:3, 3] - centre)[rows])) if rows else 0.0
    return distance > reach * (1 + 1e-9) + options.tolerance.position


def _descend(
    problem: _Problem,
    bounds: JointBounds,
    q: FloatArray,
    options: IKOptions,
    deadline: float,
    best: _Best,
) -> int:
    """One start: steps until converged, stalled or out of time; returns their number."""
    stalls, lowest = 0, np.inf
    for iteration in range(options.max_iterations + 1):
        error, position, orientation = problem.residual(q)
        energy = 0.5 * float(error @ error)
        converged = _reached(position, orientation, options)
        best.offer(q, energy, converged)
        stalls = 0 if energy < STALL_RATIO * lowest else stalls + 1
        lowest = min(lowest, energy)
        finished = converged or stalls >= STALLS or iteration == options.max_iterations
        if finished or time.perf_counter() >= deadline:
            return iteration
        q = _step(problem, bounds, q, error, DAMPING * energy + FLOOR)
    return options.max_iterations


def _settle(
    problem: _Problem, bounds: JointBounds, options: IKOptions, deadline: float, best: _Best
) -> int:
    """Where no start converged: down from the best q to the nearest pose, every step a descent.

    Marquardt's rule: more damping after a step that does not descend, less after one that does.
    """
    damping, q, energy = DAMPING * best.energy + FLOOR, best.q, best.energy
    error, _, _ = problem.residual(q)
    for iteration in range(options.max_iterations):
        if time.perf_counter() >= deadline or damping > MAX_DAMPING:
            return iteration
        problem.residual(q)
        candidate = _step(problem, bounds, q, error, damping)
        new_error, position, orientation = problem.residual(candidate)
        new_energy = 0.5 * float(new_error @ new_error)
        converged = _reached(position, orientation, options)
        best.offer(candidate, new_energy, converged)
        if converged:
            return iteration + 1
        if new_energy < energy:
            settled = new_energy > SETTLED * energy
            q, error, energy = candidate, new_error, new_energy
            damping /= 5
            if settled:
                return iteration + 1
        else:
            damping *= 4
    return options.max_iterations


def _reached(position: float, orientation: float, options: IKOptions) -> bool:
    tolerance = options.tolerance
    return position <= tolerance.position and orientation <= tolerance.orientation


def _step(
    problem: _Problem, bounds: JointBounds, q: FloatArray, error: FloatArray, damping: float
) -> FloatArray:
    """A damped step; joints at a limit that would be pushed through it are held."""
    J = problem.jacobian()
    moving = problem.moving
    at, lower, upper = q[moving], bounds.lower[moving], bounds.upper[moving]
    held = np.zeros(len(moving), dtype=bool)
    identity = damping * np.eye(len(error))
    delta = np.zeros(len(moving))
    for _ in range(len(moving)):
        free = np.where(held, 0.0, J)
        delta = free.T @ np.linalg.solve(free @ free.T + identity, error)
        stopped = (
            ~held
            & ~bounds.wraps[moving]
            & (((at <= lower) & (delta < 0)) | ((at >= upper) & (delta > 0)))
        )
        if not stopped.any():
            break
        held |= stopped
    moved = q.copy()
    moved[moving] = at + delta
    return bounds.inside(moved)
