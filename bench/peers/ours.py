"""Denavit itself, and its plain Python loop on Pinocchio."""

from __future__ import annotations

from bench.peers.arms import Arm
from bench.peers.peer import Solve
from kinematics.inverse.api import solve_ik
from robots.robot import FloatArray
from tests.oracles.pinocchio_ik import solve_on_pinocchio


def denavit(arm: Arm) -> Solve:
    def solve(target: FloatArray) -> FloatArray:
        return solve_ik(arm.robot, target, task=arm.task).q

    return solve


def plain(arm: Arm) -> Solve:
    tip = arm.robot.tip_frame

    def solve(target: FloatArray) -> FloatArray:
        return solve_on_pinocchio(arm.robot, target, frame=tip, task=arm.task).q

    return solve
