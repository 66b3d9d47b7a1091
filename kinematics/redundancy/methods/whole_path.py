"""All samples at once: ``min Σ ‖θ_k − θ_{k−1}‖²`` over the whole path, one sparse program.

Subject to ``f(θ_k) = P(t_k)``, limits, speeds and ``d ≥ d_safe + margin`` at every sample, by
IPOPT through CasADi (an optional extra), from the samples of ``qp``. It looks ahead, where the
methods that go sample by sample do not: smoother, and free where they get stuck.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np

from kinematics.deadline import Deadline, current
from kinematics.errors import InvalidOption, MethodUnavailable
from kinematics.redundancy.link_points import OFFSET, RADIUS, WHOLE
from kinematics.redundancy.measure import Measures, measure
from kinematics.redundancy.methods import qp
from kinematics.redundancy.methods.stop import Stop
from kinematics.redundancy.obstacles import BOX, CAPSULE, CIRCLE, HALF_SPACE, SPHERE
from kinematics.redundancy.problem import PathOptions, Problem, departure
from robots.robot import FloatArray

MOST = 60_000
"""Most samples times (joints + links times obstacles) of one program."""
HALVINGS = 18
"""Of the link where it is nearest to a box or capsule is sought."""
NEGLIGIBLE = 1e-7
"""A fault, m or rad, that does not speak against the program's path."""
TRIES = 3
"""Programs, each with more margin where the arm was swept too near between samples."""


def follow(
    problem: Problem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """See :class:`kinematics.redundancy.methods.Method`."""
    try:
        import casadi
    except ImportError:
        raise MethodUnavailable(
            "whole_path needs CasADi, which is not installed; pip install 'denavit[whole-path]',"
            " or use qp",
            "/method",
        ) from None
    arm = problem.arm
    size = len(Q) * (arm.K + len(problem.links) * len(problem.obstacles))
    if size > MOST:
        raise InvalidOption(
            f"{len(Q)} samples are too many for one program with {arm.K} joints and"
            f" {len(problem.obstacles)} obstacles; give at most"
            f" {MOST // (size // len(Q))}, or use qp",
            "/samples",
        )
    for _ in qp.follow(problem, options, Q):
        pass
    program = _Program(casadi, problem, options, len(Q), current())
    need = problem.d_safe + options.margin
    before = _fault(problem, measure(problem, Q))
    for _ in range(TRIES):
        solved = program.solve(Q, need)
        current().check_wanted()
        measures = measure(problem, solved)
        if measures.min_swept >= problem.d_safe:
            break
        need += 1.5 * (problem.d_safe - measures.min_swept) + 1e-5
    if _fault(problem, measures) <= max(before, NEGLIGIBLE):
        Q[1:] = solved[1:]
    yield len(Q)
    return None


def _fault(problem: Problem, measures: Measures) -> float:
    """What is wrong with a path, in one number: largest error, and missing clearance."""
    error = max(measures.position_error.max(), measures.orientation_error.max())
    return float(error + max(0.0, problem.d_safe - measures.min_swept))


class _Program:
    """The program of a whole path; the functions of one sample, mapped over all."""

    def __init__(
        self, casadi: Any, problem: Problem, options: PathOptions, N: int, deadline: Deadline
    ) -> None:
        self.problem, self.N = problem, N
        arm, K = problem.arm, problem.arm.K
        q, G = casadi.SX.sym("q", K), casadi.SX.sym("G", 12)
        carriers, T = _forward(casadi, problem, q)
        error = _error(casadi, problem, T, G)
        apart = _distances(casadi, problem, carriers)
        self.pairs = apart.numel()
        sample = casadi.Function("sample", [q, G], [error, apart]).map(N - 1)
        first = departure(problem, options)
        X, need = casadi.MX.sym("X", K, N - 1), casadi.MX.sym("need")
        steps = casadi.diff(casadi.horzcat(first, X), 1, 1)
        errors, distances = sample(X, problem.path.targets[1:].T)
        self.fast = np.isfinite(problem.most_per_step)
        limited = steps[np.flatnonzero(self.fast).tolist(), :]
        constraints = casadi.vertcat(
            casadi.vec(errors), casadi.vec(distances - need), casadi.vec(limited)
        )
        program = {"x": casadi.vec(X), "p": need, "f": casadi.sumsqr(steps), "g": constraints}
        settings = {
            "print_level": 0,
            "sb": "yes",
            "tol": 1e-8,
            "constr_viol_tol": 1e-10,
            "bound_relax_factor": 0.0,
            "max_iter": 300,
            "max_wall_time": max(1e-3, min(deadline.left, 1e6) / TRIES),
            "mu_strategy": "adaptive",
        }
        self.wanted = _wanted(casadi, deadline, X.numel(), constraints.numel())
        told = {"ipopt": settings, "print_time": False, "iteration_callback": self.wanted}
        self.solver = casadi.nlpsol("whole", "ipopt", program, told)
        chain, most = arm.chain, problem.most_per_step[self.fast]
        self.low, self.high = np.tile(chain.lower, N - 1), np.tile(chain.upper, N - 1)
        rows, pairs = error.numel() * (N - 1), self.pairs * (N - 1)
        self.lower = np.r_[np.zeros(rows + pairs), np.tile(-most, N - 1)]
        self.upper = np.r_[np.zeros(rows), np.full(pairs, np.inf), np.tile(most, N - 1)]

    def solve(self, Q: FloatArray, need: float) -> FloatArray:
        """The path from a first guess of shape (N, K), its row 0 kept."""
        found = self.solver(
            x0=Q[1:].reshape(-1), p=need, lbx=self.low, ubx=self.high, lbg=self.lower,
            ubg=self.upper,
        )  # fmt: skip
        X = np.asarray(found["x"]).reshape(self.N - 1, -1)
        if not np.isfinite(X).all():
            return Q.copy()
        X = np.clip(X, self.problem.arm.chain.lower, self.problem.arm.chain.upper)
        return np.concatenate((Q[:1], X))


def _wanted(casadi: Any, deadline: Deadline, variables: int, constraints: int) -> Any:
    """What IPOPT asks between two iterations: whether to go on."""
    sizes = {"x": variables, "f": 1, "g": constraints, "lam_x": variables, "lam_g": constraints}

    class Wanted(casadi.Callback):  # type: ignore[misc]
        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.construct("wanted", {})

        def get_n_in(self) -> int:
            return int(casadi.nlpsol_n_out())

        def get_sparsity_in(self, i: int) -> Any:
            return casadi.Sparsity.dense(sizes.get(casadi.nlpsol_out(i), 1))

        def eval(self, _: Any) -> list[int]:
            return [int(deadline.is_dropped)]

    return Wanted()


def _forward(casadi: Any, problem: Problem, q: Any) -> tuple[list[Any], Any]:
    """Poses of the joints and of the frame, 4x4, and the latter again, as expressions."""
    chain = problem.arm.chain
    bottom = np.array([[0.0, 0.0, 0.0, 1.0]])
    constants = [np.concatenate((C.reshape(3, 4), bottom)) for C in chain.placements]
    T, carriers = casadi.SX(constants[0]), []
    for k in range(chain.length):
        M = casadi.SX.eye(4)
        if chain.turns[k]:
            c, s = casadi.cos(q[k]), casadi.sin(q[k])
            M[0, 0], M[0, 1], M[1, 0], M[1, 1] = c, -s, s, c
        else:
            M[2, 3] = q[k]
        T = T @ M
        carriers.append(T)
        T = T @ constants[k + 1]
    return [*carriers, T], T


def _error(casadi: Any, problem: Problem, T: Any, G: Any) -> Any:
    """Task error that vanishes where the pose is reached; rows the arm cannot move left out."""
    task = problem.arm.task
    goal = casadi.reshape(G, 4, 3).T
    R, S = T[:3, :3], goal[:, :3]
    if task.own_axes:
        turned = R.T @ casadi.cross(R[:, 2], S[:, 2])
    else:
        turned = sum((casadi.cross(R[:, i], S[:, i]) for i in range(3)), casadi.SX.zeros(3)) / 2
    every = casadi.vertcat(T[:3, 3] - goal[:, 3], turned)
    k = np.arange(problem.arm.K)
    moved = np.zeros(problem.arm.m)
    for phase in (1.0, 2.0):
        q = problem.first + 0.3 * np.sin(phase + 2.0 * k)
        _, J, _ = problem.arm.task_at(q, problem.path.targets[0])
        moved = np.maximum(moved, np.abs(J).max(axis=1))
    return every[[row for row, m in zip(task.rows, moved, strict=True) if m > 1e-12]]


def _distances(casadi: Any, problem: Problem, carriers: list[Any]) -> Any:
    """Clearance of every pair of link and obstacle, not below zero for boxes."""
    found = []
    for link in problem.links.rows:
        A, B = (
            carriers[int(link[end])][:3, 3]
            + carriers[int(link[end])][:3, :3] @ link[OFFSET + 3 * end : OFFSET + 3 * end + 3]
            for end in range(2)
        )
        for row in problem.obstacles:
            if row[0] == HALF_SPACE:
                ends = (A, B) if link[WHOLE] else (B,)
                found += [casadi.dot(row[1:4], p) - row[4] - link[RADIUS] for p in ends]
            else:
                found.append(_distance(casadi, A, B, row) - link[RADIUS])
    return casadi.vertcat(*found) if found else casadi.SX(0, 1)


def _distance(casadi: Any, A: Any, B: Any, row: FloatArray) -> Any:
    kind, d = row[0], B - A
    if kind in (SPHERE, CIRCLE):
        keep = casadi.DM([1, 1, 0 if kind == CIRCLE else 1])
        d, a = d * keep, (A - row[1:4]) * keep
        t = _clamped(casadi, -casadi.dot(a, d) / (casadi.sumsqr(d) + 1e-18))
        return _length(casadi, a + t * d) - row[4]
    if kind == CAPSULE:
        u = row[4:7] - row[1:4]
        size = float(u @ u)

        def away(p: Any) -> Any:
            w = p - row[1:4]
            s = _clamped(casadi, casadi.dot(w, u) / size) if size > 0 else 0.0
            return w - s * u

        return _length(casadi, away(A + _nearest(casadi, A, d, away) * d)) - row[7]
    assert kind == BOX
    axes, half = row[7:16].reshape(3, 3), row[4:7]

    def outside(p: Any) -> Any:
        x = axes @ (p - row[1:4])
        return axes.T @ (x - casadi.fmin(half, casadi.fmax(-half, x)))

    return _length(casadi, outside(A + _nearest(casadi, A, d, outside) * d))


def _nearest(casadi: Any, A: Any, d: Any, away: Any) -> Any:
    """Where on the link its distance, which is convex along it, is least: by halving.

    Its derivative is 0, which is right: the distance does not change with it to first order.
    """
    low, high = casadi.SX(0), casadi.SX(1)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        rising = casadi.dot(away(A + middle * d), d) > 0
        low, high = casadi.if_else(rising, low, middle), casadi.if_else(rising, middle, high)
    return (low + high) / 2


def _clamped(casadi: Any, t: Any) -> Any:
    return casadi.fmin(1, casadi.fmax(0, t))


def _length(casadi: Any, x: Any) -> Any:
    return casadi.sqrt(casadi.sumsqr(x) + 1e-18)
