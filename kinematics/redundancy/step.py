"""The differential step ``Δθ = J† ΔX + (I − J†J) Z`` and all its parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.bounds import MAX_VALUE, Bounds
from kinematics.chain import chain_of
from kinematics.configuration import configuration
from kinematics.errors import InvalidOption, RankDeficient, WrongConfiguration
from kinematics.jacobian import task_jacobian
from kinematics.redundancy.priority import prioritized_step
from kinematics.singularity import rank_of
from kinematics.task import TASKS, Task
from robots.robot import FloatArray, Robot

DAMPING = Bounds(0.0, 1e3)
"""Bounds of λ, in the units of the Jacobian; 0: the pseudo-inverse."""


@dataclass(frozen=True)
class StepTask:
    """A wanted motion of a frame.

    Attributes:
        delta_x: Wanted displacement, one value per task row, m and rad, shape (m,).
        task: The task space.
        frame: Frame name; None: the tip.
    """

    delta_x: FloatArray
    task: Task
    frame: str | None = None


@dataclass(frozen=True, eq=False)
class DifferentialStep:
    """A step and its parts.

    Attributes:
        delta_q: Δθ, rad and m, shape (dof,).
        J: Task Jacobian, shape (m, dof).
        J_pinv: J† = Jᵀ(JJᵀ)⁻¹, with damping λ Jᵀ(JJᵀ + λ²I)⁻¹; shape (dof, m).
        N: Projector onto the null space of J, I − J⁺J; shape (dof, dof).
        rank: Rank of J.
        singular_values: Singular values of J, the largest first.
        task_motion: J† ΔX, shape (dof,).
        null_motion: N Z, shape (dof,); with secondary tasks their contribution.
        achieved: J Δθ, shape (m,).
        residuals: ΔX − J Δθ of the task and of each secondary one.
    """

    delta_q: FloatArray
    J: FloatArray
    J_pinv: FloatArray
    N: FloatArray
    rank: int
    singular_values: FloatArray
    task_motion: FloatArray
    null_motion: FloatArray
    achieved: FloatArray
    residuals: tuple[FloatArray, ...]


def differential_step(
    robot: Robot,
    q: FloatArray,
    first: StepTask,
    *,
    z: FloatArray | None = None,
    secondary: Sequence[StepTask] = (),
    damping: float = 0.0,
) -> DifferentialStep:
    """Return the step of the linear model.

    Args:
        robot: The robot.
        q: Shape (dof,), rad and m.
        first: The task of highest priority.
        z: Wanted joint motion, shape (dof,), rad and m; its part in the null space is added.
        secondary: Tasks of lower priority, in strict order, instead of z.
        damping: λ of damped least squares; 0: the pseudo-inverse.

    Raises:
        RankDeficient: J lacks full row rank, and there is no damping.
        WrongConfiguration: q, z or a delta_x does not fit.
        InvalidOption: damping is out of range, or both z and secondary tasks are given.
    """
    if damping not in DAMPING:
        raise DAMPING.refusal(
            say("damping is {damping:g}; give 0 (none) to 1e3", damping=damping), damping, "damping"
        )
    if z is not None and secondary:
        raise InvalidOption(say("give z or secondary tasks, not both"), argument="secondary")
    q = configuration(robot, q)
    _check_moved(robot, first, "frame")
    for k, task in enumerate(secondary):
        _check_moved(robot, task, "secondary", (k, "frame"))
    J = task_jacobian(robot, q, first.task, first.frame)
    dx = _checked(first, "delta_x")
    U, sigma, Vt = np.linalg.svd(J)
    m, rank = len(J), int(rank_of(sigma))
    if rank < m and damping == 0.0:
        raise _refusal(robot, first, rank, m)
    V1, used = Vt[:rank].T, sigma[:rank]
    N = np.eye(robot.dof) - V1 @ V1.T
    inverse = used / (used * used + damping * damping)
    J_pinv = (V1 * inverse) @ U[:, :rank].T
    task_motion = J_pinv @ dx
    if secondary:
        others = [
            (
                task_jacobian(robot, q, one.task, one.frame),
                _checked(one, "secondary", (k, "delta_x")),
            )
            for k, one in enumerate(secondary)
        ]
        free = Vt[rank:].T
        reduced = [(Jk @ free, ek - Jk @ task_motion) for Jk, ek in others]
        y, _ = prioritized_step(reduced, free.shape[1])
        null_motion = free @ y
    else:
        others = []
        wanted = np.zeros(robot.dof) if z is None else configuration(robot, z, "z")
        null_motion = N @ wanted
    delta = task_motion + null_motion
    return DifferentialStep(
        delta,
        J,
        J_pinv,
        N,
        rank,
        sigma,
        task_motion,
        null_motion,
        J @ delta,
        tuple(e - Jk @ delta for Jk, e in [(J, dx), *others]),
    )


def _checked(one: StepTask, argument: str, index: Location = ()) -> FloatArray:
    dx = np.asarray(one.delta_x, dtype=np.float64)
    rows = one.task.row_names
    if dx.shape != (len(rows),):
        raise WrongConfiguration(
            say(
                "delta_x has {size} values, but task {task} has {count} rows ({rows});"
                " give one a row",
                size=dx.size,
                task=one.task.name,
                count=len(rows),
                rows=", ".join(rows),
            ),
            argument=argument,
            index=index,
            expected=len(rows),
            known=rows,
        )
    if not (np.abs(dx) <= MAX_VALUE).all():
        raise WrongConfiguration(
            say("delta_x has a value that is not finite or beyond ±1e6"),
            argument=argument,
            index=index,
            lower=-MAX_VALUE,
            upper=MAX_VALUE,
        )
    return dx


def _check_moved(robot: Robot, one: StepTask, argument: str, index: Location = ()) -> None:
    frame = robot.tip_frame if one.frame is None else one.frame
    robot.frame_id(frame, argument, index)
    if chain_of(robot, frame).length == 0:
        raise InvalidOption(
            say(
                "no joint moves frame {frame} against {base_frame}; give a frame further out",
                frame=quoted(frame),
                base_frame=robot.base_frame,
            ),
            argument=argument,
            index=index,
            value=frame,
        )


def _refusal(robot: Robot, one: StepTask, rank: int, m: int) -> RankDeficient:
    text = say("rank(J) = {rank} < {m} here: J† = Jᵀ(JJᵀ)⁻¹ does not exist", rank=rank, m=m)
    others: tuple[str, ...] = ()
    if _possible(robot, one.task, one.frame):
        text += say("; give damping, such as 0.01, for damped least squares, or another q")
    else:
        others = tuple(name for name, task in TASKS.items() if _possible(robot, task, one.frame))
        choice = say(", choose another ({others})", others=", ".join(others[:4])) if others else ""
        text += say(
            "; the task {task} asks more than this arm can move{choice}",
            task=one.task.name,
            choice=choice,
        )
        text += say(", or give damping")
    return RankDeficient(text, rank=rank, wanted=m, argument="q", known=others)


def _possible(robot: Robot, task: Task, frame: str | None) -> bool:
    """Return whether the task's rows are independent at a generic q."""
    sample = 0.3 * np.sin(1.0 + 2.0 * np.arange(robot.dof))
    return int(np.linalg.matrix_rank(task_jacobian(robot, sample, task, frame))) == len(task.rows)
