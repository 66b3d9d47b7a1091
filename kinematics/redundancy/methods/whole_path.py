"""All samples at once: ``min Σ ‖θ_k − θ_{k−1}‖²`` over the whole path, one sparse program.

Subject to ``f(θ_k) = P(t_k)``, limits, speeds and ``d ≥ d_safe + margin`` at every sample, by
IPOPT through CasADi (an optional extra), from the samples of ``qp``. It looks ahead, where the
methods that go sample by sample do not: smoother, and free where they get stuck.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinematics.deadline import Deadline, current
from kinematics.errors import InvalidOption, MethodUnavailable
from kinematics.inverse import IKStatus
from kinematics.redundancy.clearance.link_points import OFFSET, RADIUS, WHOLE
from kinematics.redundancy.clearance.obstacles import BOX, CAPSULE, CIRCLE, HALF_SPACE, SPHERE
from kinematics.redundancy.clearance.sweep import RESOLUTION
from kinematics.redundancy.measure import clearances_at, measure, nearest_part, swept_between
from kinematics.redundancy.methods import damped, null_space, qp
from kinematics.redundancy.problem import TOUCH, PathOptions, PathProblem, departure
from kinematics.redundancy.reach import reach
from kinematics.redundancy.stop import Stop, StopReason
from kinematics.singularity import RANK_TOLERANCE
from robots.robot import FloatArray

MOST = 60_000
"""Most samples times (joints + links times obstacles) of one program."""
HALVINGS = 18
"""Of the link where it is nearest to a box or capsule is sought."""
TRIES = 3
"""Times a program is solved again, with clearances where the arm came too near between samples."""
ITERATIONS, FEWER_ITERATIONS = 300, 100
"""Of IPOPT: most from the first guess, and from every other."""
SEARCH = 10.0
"""Seconds for other guesses than the first, all together."""
SEEDS, ENDS, APART = 40, 3, 0.3
"""Inverse kinematics at the end of the path from so many seeds, for so many configurations that
differ by so much, rad or m."""


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """Follow a path; see :class:`kinematics.redundancy.methods.Method`."""
    try:
        import casadi
    except ImportError:
        raise MethodUnavailable(
            "whole_path needs CasADi, which is not installed; pip install 'denavit[whole-path]',"
            " or use qp",
            package="casadi",
            extra="whole-path",
            argument="method",
            value="whole_path",
        ) from None
    arm = problem.arm
    size = len(Q) * (arm.K + len(problem.links) * len(problem.obstacles))
    if size > MOST:
        raise InvalidOption(
            f"{len(Q)} samples are too many for one program with {arm.K} joints and"
            f" {len(problem.obstacles)} obstacles; give at most"
            f" {MOST // (size // len(Q))}, or use qp",
            argument="samples",
            value=len(Q),
            upper=MOST // (size // len(Q)),
        )
    for _ in qp.follow(problem, options, Q):
        pass
    kept = kept_until(problem, Q)
    best, found = _look_ahead(casadi, problem, options, Q, kept)
    if found is not Q:
        Q[1:best] = found[1:best]
        yield best
        # From there on, what can be done sample by sample.
        qp.follow_from(problem, options, Q, best)
    yield len(Q)
    return Stop(StopReason.AS_QP, len(Q)) if found is Q else None


def _look_ahead(
    casadi: Any, problem: PathProblem, options: PathOptions, Q: FloatArray, kept: int
) -> tuple[int, FloatArray]:
    """Return how far the best path of the program holds, and it; else ``kept`` and Q."""
    best, found = kept, Q
    program = _Program(casadi, problem, options, len(Q), ())
    search: Deadline | None = None
    for guess in _guesses(problem, options, Q, kept):
        whole = current()
        if search is None:
            limit = _Limit(Deadline(whole.left / 2, of=whole), ITERATIONS)
        else:
            limit = _Limit(Deadline(min(search.left, whole.left / 2), of=whole), FEWER_ITERATIONS)
        if limit.deadline.left <= 0:
            break
        solved = _solved(casadi, problem, options, program, guess, limit)
        until = kept_until(problem, solved)
        if until > best or until == len(Q):
            best, found = until, solved
        if until == len(Q):
            break
        search = search or Deadline(SEARCH)
    return best, found


def kept_until(problem: PathProblem, Q: FloatArray) -> int:
    """Return the first sample at which something does not hold; their number N where all does.

    Error, clearance (swept from the sample before), limits and speeds, as the verdict sees them;
    and the step from the sample before, by which it stays in one branch.
    """
    measures = measure(problem, Q)
    bad = (
        measures.off_path(problem.tolerance)
        | (measures.clearance < problem.d_safe)
        | (measures.limit_margin < -TOUCH)
    )
    bad[1:] |= (measures.swept < problem.d_safe) | (measures.speed_ratio > 1 + TOUCH)
    bad[1:] |= (np.abs(np.diff(Q, axis=0)) > problem.longest_step).any(axis=1)
    return int(np.argmax(bad)) if bad.any() else len(Q)


def _guesses(
    problem: PathProblem, options: PathOptions, Q: FloatArray, kept: int
) -> Iterator[FloatArray]:
    """Yield first guesses: what qp found; if that fails, ways on other sides of the obstacles.

    Those are the path as it would be without obstacles, as the null space keeps off them, and
    straight in joint space to configurations at the end that keep clear. Where the start is
    singular, too near itself, or the end out of reach, there is no other way.
    """
    yield Q
    if kept == len(Q) or kept == 0 or not len(problem.obstacles):
        return
    _, J, _ = problem.arm.task_at(problem.first, problem.path.targets[0])
    if np.linalg.matrix_rank(J, RANK_TOLERANCE * max(1.0, float(np.abs(J).max()))) < len(J):
        return
    ends = _ends(problem)
    if not ends:
        return
    for method in (damped, null_space):
        guess = Q.copy()
        if _exhausted(method.follow(problem, options, guess)) is None:
            yield guess
    for end in ends:
        yield problem.first + np.linspace(0.0, 1.0, len(Q))[:, None] * (end - problem.first)


def _exhausted(work: Generator[int, None, Stop | None]) -> Stop | None:
    """Let a method work to its end; return why it stopped before that of the path."""
    while True:
        try:
            next(work)
        except StopIteration as last:
            stop: Stop | None = last.value
            return stop


def _ends(problem: PathProblem) -> list[FloatArray]:
    """Return configurations that reach the end and keep clear there, far from each other."""
    arm, rng = problem.arm, np.random.default_rng(0)
    low, high = arm.chain.lower, arm.chain.upper
    found: list[FloatArray] = []
    for k in range(SEEDS):
        off = rng.normal(0.0, 0.5, arm.K) if k else np.zeros(arm.K)
        seed = arm.expanded(np.clip(problem.first + off, low, high)[None], problem.start)[0]
        end = reach(problem, -1, seed, restarts=0, seconds=0.02)
        if end.status is IKStatus.CONVERGED:
            q = arm.reduced(end.q)
            clearance, _ = clearances_at(problem, q[None])
            if clearance[0] >= problem.d_safe:
                found.append(q)
    found.sort(key=lambda q: float(np.linalg.norm(q - problem.first)))
    apart: list[FloatArray] = []
    for q in found:
        if all(np.linalg.norm(q - other) > APART for other in apart):
            apart.append(q)
    return apart[:ENDS]


def _solved(
    casadi: Any,
    problem: PathProblem,
    options: PathOptions,
    program: _Program,
    guess: FloatArray,
    limit: _Limit,
) -> FloatArray:
    """Return the program's path from a guess; solved again where it comes too near in between."""
    solved = program.solve(guess, limit)
    between: list[tuple[int, float]] = []
    for _ in range(TRIES):
        current().check_wanted()
        swept = swept_between(problem, solved)
        near = np.flatnonzero(swept < problem.d_safe)
        clearance, _ = clearances_at(problem, solved)
        if not near.size or clearance[1:].min() < problem.d_safe or limit.deadline.left <= 0:
            break
        between += [(int(k), nearest_part(problem, solved[k], solved[k + 1])) for k in near]
        program = _Program(casadi, problem, options, len(guess), tuple(between))
        solved = program.solve(solved, limit)
    return solved


class _Program:
    """The program of a whole path; the functions of one sample, mapped over all.

    ``between`` are places k + s between samples k and k + 1 at which clearances are kept too.
    """

    def __init__(
        self,
        casadi: Any,
        problem: PathProblem,
        options: PathOptions,
        N: int,
        between: Sequence[tuple[int, float]],
    ) -> None:
        self.problem, self.N = problem, N
        arm, K = problem.arm, problem.arm.K
        q, G = casadi.SX.sym("q", K), casadi.SX.sym("G", 12)
        carriers, T = _forward(casadi, problem, q)
        error = _error(casadi, problem, T, G)
        apart = _distances(casadi, problem, carriers)
        sample = casadi.Function("sample", [q, G], [error, apart]).map(N - 1)
        first = departure(problem, options)
        X = casadi.MX.sym("X", K, N - 1)
        way = casadi.horzcat(first, X)
        steps = casadi.diff(way, 1, 1)
        errors, distances = sample(X, problem.path.targets[1:].T)
        fast = np.isfinite(problem.most_per_step)
        limited = steps[np.flatnonzero(fast).tolist(), :]
        parts = [casadi.vec(errors), casadi.vec(distances), casadi.vec(limited)]
        rows, pairs = error.numel() * (N - 1), apart.numel()
        most = np.tile(problem.most_per_step[fast], N - 1)
        need = np.full(pairs * (N - 1), problem.d_safe + max(options.margin, 2 * RESOLUTION))
        lower, upper = [np.zeros(rows), need, -most], [np.zeros(rows), need * np.inf, most]
        if between:
            at = [int(k) for k, _ in between]
            after, s = [k + 1 for k in at], np.array([[part for _, part in between]])
            s = np.repeat(s, K, axis=0)
            places = (1 - s) * way[:, at] + s * way[:, after]
            clear = casadi.Function("clear", [q], [apart]).map(len(at))
            parts.append(casadi.vec(clear(places)))
            least = problem.d_safe + 0.25 * options.margin + 2 * RESOLUTION
            lower.append(np.full(pairs * len(at), least))
            upper.append(np.full(pairs * len(at), np.inf))
        constraints = casadi.vertcat(*parts)
        program = {"x": casadi.vec(X), "f": casadi.sumsqr(steps), "g": constraints}
        settings = {
            "print_level": 0,
            "sb": "yes",
            "tol": 1e-8,
            "constr_viol_tol": 1e-10,
            "bound_relax_factor": 0.0,
            "max_iter": ITERATIONS,
            "mu_strategy": "adaptive",
        }
        self.wanted = _wanted(casadi, X.numel(), constraints.numel())
        told = {"ipopt": settings, "print_time": False, "iteration_callback": self.wanted}
        self.solver = casadi.nlpsol("whole", "ipopt", program, told)
        self.low, self.high = np.tile(arm.chain.lower, N - 1), np.tile(arm.chain.upper, N - 1)
        self.lower, self.upper = np.concatenate(lower), np.concatenate(upper)

    def solve(self, Q: FloatArray, limit: _Limit) -> FloatArray:
        """Return the path from a first guess of shape (N, K), its row 0 kept."""
        self.wanted.begin(limit)
        guess = np.clip(Q[1:].reshape(-1), self.low, self.high)
        found = self.solver(x0=guess, lbx=self.low, ubx=self.high, lbg=self.lower, ubg=self.upper)
        X = np.asarray(found["x"]).reshape(self.N - 1, -1)
        if not np.isfinite(X).all():
            return Q.copy()
        X = np.clip(X, self.problem.arm.chain.lower, self.problem.arm.chain.upper)
        return np.concatenate((Q[:1], X))


@dataclass(frozen=True, eq=False)
class _Limit:
    """How long a program may be worked at.

    Attributes:
        deadline: Until when.
        iterations: How many.
    """

    deadline: Deadline
    iterations: int


def _wanted(casadi: Any, variables: int, constraints: int) -> Any:
    """Return the callback that IPOPT asks between two iterations whether to go on."""
    sizes = {"x": variables, "f": 1, "g": constraints, "lam_x": variables, "lam_g": constraints}

    class Wanted(casadi.Callback):  # type: ignore[misc]
        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.begin(_Limit(current(), ITERATIONS))
            self.construct("wanted", {})

        def begin(self, limit: _Limit) -> None:
            self.limit, self.asked = limit, 0

        def get_n_in(self) -> int:
            return int(casadi.nlpsol_n_out())

        def get_sparsity_in(self, i: int) -> Any:
            name = casadi.nlpsol_out(i)
            return casadi.Sparsity(0, 0) if name == "lam_p" else casadi.Sparsity.dense(sizes[name])

        def eval(self, _: Any) -> list[int]:
            self.asked += 1
            deadline = self.limit.deadline
            over = self.asked > self.limit.iterations or deadline.left <= 0
            return [int(over or deadline.is_dropped)]

    return Wanted()


def _forward(casadi: Any, problem: PathProblem, q: Any) -> tuple[list[Any], Any]:
    """Return the poses of the joints and of the frame, 4x4, and the latter again, symbolically."""
    chain = problem.arm.chain
    bottom = np.array([[0.0, 0.0, 0.0, 1.0]])
    constants = [np.concatenate((C.reshape(3, 4), bottom)) for C in chain.placements]
    if chain.is_coupled:
        q = casadi.mtimes(casadi.DM(chain.coupling), casadi.vec(q)) + casadi.DM(chain.offset)
    T, carriers = casadi.SX(constants[0]), []
    for k in range(chain.length):
        M = casadi.SX.eye(4)
        if chain.is_revolute[k]:
            c, s = casadi.cos(q[k]), casadi.sin(q[k])
            M[0, 0], M[0, 1], M[1, 0], M[1, 1] = c, -s, s, c
        else:
            M[2, 3] = q[k]
        T = T @ M
        carriers.append(T)
        T = T @ constants[k + 1]
    return [*carriers, T], T


def _error(casadi: Any, problem: PathProblem, T: Any, G: Any) -> Any:
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


def _distances(casadi: Any, problem: PathProblem, carriers: list[Any]) -> Any:
    """Clearance of every pair of link and obstacle, not below zero for boxes."""
    found = []
    for link in problem.links.rows:
        A, B = (_placed(casadi, carriers, link, end) for end in range(2))
        for row in problem.obstacles:
            if row[0] == HALF_SPACE:
                ends = (A, B) if link[WHOLE] else (B,)
                found += [casadi.dot(row[1:4], p) - row[4] - link[RADIUS] for p in ends]
            else:
                found.append(_distance(casadi, A, B, row) - link[RADIUS])
    return casadi.vertcat(*found) if found else casadi.SX(0, 1)


def _placed(casadi: Any, carriers: list[Any], link: FloatArray, end: int) -> Any:
    """Place start (0) or end (1) of a link in base axes."""
    offset = link[OFFSET + 3 * end : OFFSET + 3 * end + 3]
    if link[end] < 0:
        return casadi.DM(offset)
    T = carriers[int(link[end])]
    return T[:3, 3] + T[:3, :3] @ offset


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
    """Find where on the link its distance, which is convex along it, is least: by halving.

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
