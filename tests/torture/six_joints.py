"""All solutions of random arms of six revolute joints: ``python -m tests.torture.six_joints``.

Each arm has random lengths and angles. Its solutions are compared with those that Newton's method
finds from random starts, until several rounds of starts find nothing new; forward kinematics,
Jacobian and steps are written here, of the textbook's matrices, and share nothing with the library.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dh_to_urdf import read_mapping
from kinematics.inverse.all_solutions import all_solutions
from robots.robot import FloatArray, Robot, robot_from_table

STARTS = 96
STEPS = 40
IDLE_ROUNDS, MOST_ROUNDS = 3, 40
SAME = 1e-5
REACHED = 1e-10


@dataclass(frozen=True)
class Table:
    """A standard D-H table of revolute joints: lengths in m, angles in rad, shape (K,) each."""

    a: FloatArray
    alpha: FloatArray
    d: FloatArray

    def robot(self) -> Robot:
        """Return the library's robot."""
        names = ("a", "alpha", "d")
        rows = zip(self.a, self.alpha, self.d, strict=True)
        joints = [
            {"name": f"j{k}", "type": "R", **dict(zip(names, map(float, row), strict=True))}
            for k, row in enumerate(rows)
        ]
        return robot_from_table(
            read_mapping({"name": "arm", "convention": "standard", "joints": joints})
        )

    def frames(self, q: FloatArray) -> FloatArray:
        """Return the frames before each joint, and the last, (N, K) -> (N, K + 1, 4, 4)."""
        count, joints = q.shape
        frames = np.empty((count, joints + 1, 4, 4))
        frames[:, 0] = np.eye(4)
        for k in range(joints):
            c, s = np.cos(q[:, k]), np.sin(q[:, k])
            ca, sa, zero = np.cos(self.alpha[k]), np.sin(self.alpha[k]), np.zeros(count)
            A = np.array(
                [
                    [c, -s * ca, s * sa, self.a[k] * c],
                    [s, c * ca, -c * sa, self.a[k] * s],
                    [zero, zero + sa, zero + ca, zero + self.d[k]],
                    [zero, zero, zero, zero + 1.0],
                ]
            )
            frames[:, k + 1] = frames[:, k] @ np.moveaxis(A, 2, 0)
        return frames

    def pose(self, q: FloatArray) -> FloatArray:
        """Return the pose at q, shape (4, 4)."""
        return np.asarray(self.frames(q[None])[0, -1])


def brute_force(table: Table, target: FloatArray, rng: np.random.Generator) -> Iterator[FloatArray]:
    """Give solutions as rounds of random starts find them: an array a round, (n, K)."""
    while True:
        q = rng.uniform(-np.pi, np.pi, (STARTS, len(table.d)))
        damping = np.full(STARTS, 1e-2)
        error, J = _linear(table, target, q)
        for _ in range(STEPS):
            size = np.linalg.norm(error, axis=1)
            H = J @ J.transpose(0, 2, 1) + damping[:, None, None] * np.eye(6)
            step = (J.transpose(0, 2, 1) @ np.linalg.solve(H, error[..., None]))[..., 0]
            trial = q + step
            next_error, next_J = _linear(table, target, trial)
            better = np.linalg.norm(next_error, axis=1) < size
            q[better], error[better], J[better] = trial[better], next_error[better], next_J[better]
            damping = np.where(better, damping * 0.1, damping * 4.0).clip(1e-16, 1e3)
        yield q[np.linalg.norm(error, axis=1) < REACHED]


def _linear(table: Table, target: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the errors, (N, 6), and the Jacobians, (N, 6, K), of position and rotation."""
    frames = table.frames(q)
    tip = frames[:, -1]
    z, origins = frames[:, :-1, :3, 2], frames[:, :-1, :3, 3]
    J = np.concatenate((np.cross(z, tip[:, None, :3, 3] - origins), z), axis=2)
    R = target[:3, :3] @ tip[:, :3, :3].transpose(0, 2, 1)
    half = 0.5 * np.stack(
        (R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]), axis=1
    )
    sine, cosine = np.linalg.norm(half, axis=1), 0.5 * (np.trace(R, axis1=1, axis2=2) - 1.0)
    angle = np.arctan2(sine, cosine) / np.maximum(sine, 1e-12)
    error = np.concatenate((target[:3, 3] - tip[:, :3, 3], half * angle[:, None]), axis=1)
    return error, J.transpose(0, 2, 1)


def apart(q: FloatArray, other: FloatArray) -> float:
    """Return the largest difference on the circle."""
    return float(np.abs((q - other + np.pi) % (2 * np.pi) - np.pi).max())


@dataclass(frozen=True)
class Comparison:
    """What a target's solutions are.

    Attributes:
        ours: Number of ours.
        complete: Whether ours say that they are all.
        missing: Those that only random starts found.
        unconfirmed: Ours that no random start found, though they reach the target.
        false: Ours that do not.
    """

    ours: int
    complete: bool
    missing: int
    unconfirmed: int
    false: int


def compared(table: Table, q: FloatArray, rng: np.random.Generator) -> Comparison:
    """Compare all solutions of the pose at q with those of random starts."""
    target = table.pose(q)
    answer = all_solutions(table.robot(), target)
    ours = [one.q for one in answer.solutions]
    known: list[FloatArray] = [q]
    idle = 0
    for number, found in enumerate(brute_force(table, target, rng)):
        before = len(known)
        for one in found:
            if all(apart(one, other) > SAME for other in known):
                known.append(one)
        idle = 0 if len(known) > before else idle + 1
        short = sum(all(apart(one, other) > SAME for other in known) for one in ours)
        if (idle >= IDLE_ROUNDS and short == 0) or number >= MOST_ROUNDS:
            break
    return Comparison(
        len(ours),
        answer.complete,
        sum(all(apart(one, other) > SAME for other in ours) for one in known),
        short,
        sum(float(np.abs(table.pose(one) - target).max()) > 1e-9 for one in ours),
    )


def random_case(number: int, seed: int) -> tuple[Table, FloatArray]:
    """Return an arm in general position and a q."""
    rng = np.random.default_rng((seed, number))
    table = Table(rng.uniform(-1, 1, 6), rng.uniform(-np.pi, np.pi, 6), rng.uniform(-1, 1, 6))
    return table, rng.uniform(-np.pi, np.pi, 6)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arms", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    total = missing = unconfirmed = false = complete = wrong = 0
    for number in range(options.first, options.first + options.arms):
        table, q = random_case(number, options.seed)
        one = compared(table, q, np.random.default_rng((options.seed, number, 1)))
        total, complete = total + one.ours, complete + one.complete
        missing, false = missing + one.missing, false + one.false
        unconfirmed += one.unconfirmed
        wrong += one.complete and one.missing > 0
        if one.missing or one.false or not one.complete:
            print(f"arm {number}: {one}", flush=True)
        if (number + 1) % 20 == 0:
            print(f"{number + 1}: {total} solutions, {missing} missing", flush=True)
    print(
        f"{options.arms} arms, {total} solutions: {missing} missing, {false} false,"
        f" {unconfirmed} that no start found; {complete} answers complete, {wrong} wrongly"
    )
    sys.exit(missing + false + wrong > 0)


if __name__ == "__main__":
    main()
