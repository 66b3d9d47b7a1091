"""An arm with a task: the robot data that every method takes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.chain import Chain, chain_of
from kinematics.errors import InvalidOption
from kinematics.inverse.task_error import task_chain
from kinematics.redundancy.kernel import ArmConstants, task_at, workspace
from kinematics.task import Task
from robots.robot import FloatArray, Robot


@dataclass(frozen=True, eq=False)
class Arm:
    """The chain from a robot's base to a frame, and the task space of that frame.

    Attributes:
        robot: The robot.
        frame: Name of the frame.
        task: The task space.
        chain: The chain, moved by K entries of q; the robot's others are fixed.
    """

    robot: Robot
    frame: str
    task: Task
    chain: Chain

    @classmethod
    def of(
        cls,
        robot: Robot,
        frame: str | None,
        task: Task,
        argument: str = "frame",
        index: Location = (),
    ) -> Arm:
        """Return the arm from a robot's base to a frame.

        Args:
            robot: The robot.
            frame: Name of the frame; None for the tip.
            task: The task space.
            argument: Name of the argument that holds the frame's name, for errors.
            index: Place of the name within that argument, for errors.

        Raises:
            UnknownFrame: The robot has no such frame.
            InvalidOption: No joint moves it.
        """
        frame = robot.tip_frame if frame is None else frame
        robot.frame_id(frame, argument, index)
        chain = chain_of(robot, frame)
        if chain.length == 0:
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
        return cls(robot, frame, task, chain)

    @property
    def K(self) -> int:  # noqa: N802
        """Number of entries of q that move the frame."""
        return self.chain.dof

    @property
    def m(self) -> int:
        """Number of task rows."""
        return len(self.task.rows)

    @cached_property
    def velocity(self) -> FloatArray:
        """Speed limits of the joints, rad/s or m/s, inf where unknown; shape (K,)."""
        speeds = [joint.velocity for joint in self.robot.joints]
        every = np.array([np.inf if v is None or v <= 0 else v for v in speeds])
        return every[self.chain.columns]

    @cached_property
    def acceleration(self) -> FloatArray:
        """Acceleration limits of the joints, rad/s² or m/s², inf where unknown; shape (K,)."""
        limits = [joint.acceleration for joint in self.robot.joints]
        return np.array([np.inf if a is None else a for a in limits])[self.chain.columns]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the entries of q."""
        return tuple(self.robot.joints[k].name for k in self.chain.columns)

    def reduced(self, q: FloatArray) -> FloatArray:
        """Return the chain's entries of q, shape (..., dof) -> (..., K)."""
        return np.ascontiguousarray(q[..., self.chain.columns])

    def expanded(self, q: FloatArray, start: FloatArray) -> FloatArray:
        """Return configurations of all joints; shape (n, K) -> (n, dof)."""
        whole = np.repeat(start[None], len(q), axis=0)
        whole[:, self.chain.columns] = q
        return whole

    def task_at(self, q: FloatArray, G: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return error to a pose (m,), Jacobian (m, K) and pose (12,) at q of shape (K,)."""
        W, e, J = workspace(self.chain.length), np.empty(self.m), np.empty((self.m, self.K))
        task_at(self.constants, G, q, W, e, J)
        return e, J, W[self.chain.length].copy()

    @cached_property
    def constants(self) -> ArmConstants:
        """First argument of compiled functions."""
        rows = np.array(self.task.rows, dtype=np.int64)
        return ArmConstants(task_chain(self.chain, self.task), rows, self.task.own_axes)
