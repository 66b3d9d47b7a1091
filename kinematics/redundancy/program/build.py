"""The program of a whole path in CasADi, for IPOPT: see :mod:`..methods.whole_path`."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Any

import casadi
import numpy as np

from kinematics.redundancy.program.data import (
    BOX,
    CAPSULE,
    CIRCLE,
    HALF_SPACE,
    SPHERE,
    ProgramData,
    Segment,
    Solid,
)
from kinematics.redundancy.program.exhausted import Complaints

if TYPE_CHECKING:
    from robots.robot import FloatArray

HALVINGS = 18
"""Of the link where it is nearest to a box or capsule is sought."""
MOST_ITERATIONS = 300
"""Of IPOPT; an attempt may ask for fewer."""
SETTINGS: dict[str, Any] = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-8,
    "constr_viol_tol": 1e-10,
    "bound_relax_factor": 0.0,
    "mu_strategy": "adaptive",
    "mumps_mem_percent": 50,
}
SOLVED = "Solve_Succeeded", "Solved_To_Acceptable_Level"
"""What IPOPT says of a solution."""


class Program:
    """The program of a whole path; the functions of one sample, mapped over all."""

    def __init__(self, data: ProgramData) -> None:
        self.N, K = data.samples, len(data.first)
        N = self.N
        q, G = casadi.SX.sym("q", K), casadi.SX.sym("G", 12)
        carriers, T = _forward(data, q)
        error = _error(data, T, G)
        apart = _distances(data, carriers)
        sample = casadi.Function("sample", [q, G], [error, apart]).map(N - 1)
        X = casadi.MX.sym("X", K, N - 1)
        way = casadi.horzcat(data.first, X)
        steps = casadi.diff(way, 1, 1)
        errors, distances = sample(X, data.targets.T)
        fast = np.isfinite(data.most_per_step)
        limited = steps[np.flatnonzero(fast).tolist(), :]
        parts = [casadi.vec(errors), casadi.vec(distances), casadi.vec(limited)]
        rows, pairs = error.numel() * (N - 1), apart.numel()
        most = np.tile(data.most_per_step[fast], N - 1)
        need = np.full(pairs * (N - 1), data.need)
        lower, upper = [np.zeros(rows), need, -most], [np.zeros(rows), need * np.inf, most]
        if data.between:
            at = [int(k) for k, _ in data.between]
            after, s = [k + 1 for k in at], np.array([[part for _, part in data.between]])
            s = np.repeat(s, K, axis=0)
            places = (1 - s) * way[:, at] + s * way[:, after]
            clear = casadi.Function("clear", [q], [apart]).map(len(at))
            parts.append(casadi.vec(clear(places)))
            lower.append(np.full(pairs * len(at), data.need_between))
            upper.append(np.full(pairs * len(at), np.inf))
        constraints = casadi.vertcat(*parts)
        program = {"x": casadi.vec(X), "f": casadi.sumsqr(steps), "g": constraints}
        self._until = _until(X.numel(), constraints.numel())
        self._complaints = Complaints()
        told = {
            "ipopt": {**SETTINGS, **self._complaints.options, "max_iter": MOST_ITERATIONS},
            "print_time": False,
            "iteration_callback": self._until,
        }
        self._solver = casadi.nlpsol("whole", "ipopt", program, told)
        self._low, self._high = np.tile(data.lower, N - 1), np.tile(data.upper, N - 1)
        self._lower, self._upper = np.concatenate(lower), np.concatenate(upper)

    def solved(self, Q: FloatArray, seconds: float, iterations: int) -> FloatArray:
        """Return rows 1 to N - 1 of the path from a first guess of shape (N, K).

        They are what there is when the time is up or the iterations are done.

        Raises:
            MemoryError: The memory of this process is exhausted.
        """
        self._until.begin(seconds, iterations)
        guess = np.clip(Q[1:].reshape(-1), self._low, self._high)
        found = self._solver(
            x0=guess, lbx=self._low, ubx=self._high, lbg=self._lower, ubg=self._upper
        )
        status = self._solver.stats()["return_status"]
        if status == "Insufficient_Memory":
            raise MemoryError
        if status not in SOLVED and self._complaints.are_about_memory():
            raise MemoryError
        return np.asarray(found["x"]).reshape(self.N - 1, -1)


def load_solver() -> None:
    """Solve a program of one unknown: libraries are loaded, and take their own buffers."""
    x = casadi.SX.sym("x")
    program = {"x": x, "f": x**2, "g": x}
    casadi.nlpsol("smallest", "ipopt", program, {"ipopt": SETTINGS, "print_time": False})(x0=1.0)


def _until(variables: int, constraints: int) -> Any:
    """Return the callback that IPOPT asks between two iterations whether to go on."""
    sizes = {"x": variables, "f": 1, "g": constraints, "lam_x": variables, "lam_g": constraints}

    class Until(casadi.Callback):
        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.begin(0.0, 0)
            self.construct("until", {})

        def begin(self, seconds: float, iterations: int) -> None:
            self.end, self.iterations, self.asked = perf_counter() + seconds, iterations, 0

        def get_n_in(self) -> int:
            return int(casadi.nlpsol_n_out())

        def get_sparsity_in(self, i: int) -> Any:
            name = casadi.nlpsol_out(i)
            return casadi.Sparsity(0, 0) if name == "lam_p" else casadi.Sparsity.dense(sizes[name])

        def eval(self, _: Any) -> list[int]:
            self.asked += 1
            return [int(self.asked > self.iterations or perf_counter() > self.end)]

    return Until()


def _forward(data: ProgramData, q: Any) -> tuple[list[Any], Any]:
    """Return the poses of the joints and of the frame, 4x4, and the latter again, symbolically."""
    bottom = np.array([[0.0, 0.0, 0.0, 1.0]])
    constants = [np.concatenate((C.reshape(3, 4), bottom)) for C in data.placements]
    if data.coupling is not None:
        q = casadi.mtimes(casadi.DM(data.coupling), casadi.vec(q)) + casadi.DM(data.offset)
    T, carriers = casadi.SX(constants[0]), []
    for k, is_revolute in enumerate(data.is_revolute):
        M = casadi.SX.eye(4)
        if is_revolute:
            c, s = casadi.cos(q[k]), casadi.sin(q[k])
            M[0, 0], M[0, 1], M[1, 0], M[1, 1] = c, -s, s, c
        else:
            M[2, 3] = q[k]
        T = T @ M
        carriers.append(T)
        T = T @ constants[k + 1]
    return [*carriers, T], T


def _error(data: ProgramData, T: Any, G: Any) -> Any:
    """Task error that vanishes where the pose is reached; rows the arm cannot move left out."""
    goal = casadi.reshape(G, 4, 3).T
    R, S = T[:3, :3], goal[:, :3]
    if data.own_axes:
        turned = R.T @ casadi.cross(R[:, 2], S[:, 2])
    else:
        turned = sum((casadi.cross(R[:, i], S[:, i]) for i in range(3)), casadi.SX.zeros(3)) / 2
    every = casadi.vertcat(T[:3, 3] - goal[:, 3], turned)
    return every[list(data.rows)]


def _distances(data: ProgramData, carriers: list[Any]) -> Any:
    """Clearance of every pair of link and obstacle, not below zero for boxes."""
    found = []
    for link in data.segments:
        A, B = (_placed(carriers, link, end) for end in range(2))
        for solid in data.solids:
            row = solid.row
            if solid.kind == HALF_SPACE:
                ends = (A, B) if link.whole else (B,)
                found += [casadi.dot(row[1:4], p) - row[4] - link.radius for p in ends]
            else:
                found.append(_distance(A, B, solid) - link.radius)
    return casadi.vertcat(*found) if found else casadi.SX(0, 1)


def _placed(carriers: list[Any], link: Segment, end: int) -> Any:
    """Place start (0) or end (1) of a link in base axes."""
    offset = link.offsets[end]
    if link.carriers[end] < 0:
        return casadi.DM(offset)
    T = carriers[link.carriers[end]]
    return T[:3, 3] + T[:3, :3] @ offset


def _distance(A: Any, B: Any, solid: Solid) -> Any:
    kind, row, d = solid.kind, solid.row, B - A
    if kind in (SPHERE, CIRCLE):
        keep = casadi.DM([1, 1, 0 if kind == CIRCLE else 1])
        d, a = d * keep, (A - row[1:4]) * keep
        t = _clamped(-casadi.dot(a, d) / (casadi.sumsqr(d) + 1e-18))
        return _length(a + t * d) - row[4]
    if kind == CAPSULE:
        u = row[4:7] - row[1:4]
        size = float(u @ u)

        def away(p: Any) -> Any:
            w = p - row[1:4]
            s = _clamped(casadi.dot(w, u) / size) if size > 0 else 0.0
            return w - s * u

        return _length(away(A + _nearest(A, d, away) * d)) - row[7]
    assert kind == BOX
    axes, half = row[7:16].reshape(3, 3), row[4:7]

    def outside(p: Any) -> Any:
        x = axes @ (p - row[1:4])
        return axes.T @ (x - casadi.fmin(half, casadi.fmax(-half, x)))

    return _length(outside(A + _nearest(A, d, outside) * d))


def _nearest(A: Any, d: Any, away: Callable[[Any], Any]) -> Any:
    """Find where on the link its distance, which is convex along it, is least: by halving.

    Its derivative is 0, which is right: the distance does not change with it to first order.
    """
    low, high = casadi.SX(0), casadi.SX(1)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        rising = casadi.dot(away(A + middle * d), d) > 0
        low, high = casadi.if_else(rising, low, middle), casadi.if_else(rising, middle, high)
    return (low + high) / 2


def _clamped(t: Any) -> Any:
    return casadi.fmin(1, casadi.fmax(0, t))


def _length(x: Any) -> Any:
    return casadi.sqrt(casadi.sumsqr(x) + 1e-18)
