"""All samples at once: ``min Σ ‖θ_k − θ_{k−1}‖²`` over the whole path, one sparse program.

Subject to ``f(θ_k) = P(t_k)``, limits, speeds and ``d ≥ d_safe + margin`` at every sample, by
IPOPT through CasADi (an optional extra) in a process of its own, from the samples of ``qp``. It
looks ahead, where the methods that go sample by sample do not: smoother, and free where they get
stuck.
"""

from __future__ import annotations

import pickle
from collections.abc import Generator, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from dh_to_urdf.messages import say
from kinematics.deadline import Deadline, current
from kinematics.errors import InvalidOption, MethodUnavailable, OutOfMemory
from kinematics.inverse import IKStatus
from kinematics.processes.pool import ProcessPool, Session
from kinematics.processes.protocol import Limits
from kinematics.redundancy.measure import clearances_at, measure, nearest_part, swept_between
from kinematics.redundancy.methods import damped, null_space, qp
from kinematics.redundancy.problem import TOUCH, PathOptions, PathProblem
from kinematics.redundancy.program.data import Attempt, ProgramData, array_of
from kinematics.redundancy.program.made import program_data
from kinematics.redundancy.program.size import program_bytes
from kinematics.redundancy.reach import reach
from kinematics.redundancy.stop import Stop, StopReason
from kinematics.singularity import RANK_TOLERANCE
from robots.robot import FloatArray

WORKER = "kinematics.redundancy.program.worker"
KEPT = 64 << 20
"""Bytes of a program that its process may go on holding when it waits for the next."""
GRACE = 2.0
"""Seconds that a process has beside those of its attempt, for the iteration that is begun."""
MOST = 60_000
"""Most samples times (joints + links times obstacles) of one program."""
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
    if find_spec("casadi") is None:
        raise MethodUnavailable(
            say(
                "whole_path needs CasADi, which is not installed; pip install"
                " 'denavit[whole-path]', or use qp"
            ),
            package="casadi",
            extra="whole-path",
            argument="method",
            value="whole_path",
        )
    arm = problem.arm
    size = len(Q) * (arm.K + len(problem.links) * len(problem.obstacles))
    if size > MOST:
        raise InvalidOption(
            say(
                "{count} samples are too many for one program with {k} joints and"
                " {count_2} obstacles; give at most {most}, or use qp",
                count=len(Q),
                k=arm.K,
                count_2=len(problem.obstacles),
                most=MOST // (size // len(Q)),
            ),
            argument="samples",
            value=len(Q),
            upper=MOST // (size // len(Q)),
        )
    with _session(options) as session:
        session.start()  # while qp works
        for _ in qp.follow(problem, options, Q):
            pass
        kept = kept_until(problem, Q)
        best, found = _look_ahead(session, problem, options, Q, kept)
    if found is not Q:
        Q[1:best] = found[1:best]
        yield best
        # From there on, what can be done sample by sample.
        qp.follow_from(problem, options, Q, best)
    yield len(Q)
    return Stop(StopReason.AS_QP, len(Q)) if found is Q else None


@contextmanager
def _session(options: PathOptions) -> Iterator[Session]:
    """Hold a process: of the pool that the options name, or of one for this path."""
    if options.processes is not None:
        with options.processes.session() as session:
            yield session
        return
    with closing(ProcessPool(WORKER)) as pool, pool.session() as session:
        yield session


def memory_bytes(problem: PathProblem) -> int:
    """Return the memory that the process for a path takes besides that of an idle one."""
    size = len(problem.links), len(problem.obstacles)
    return program_bytes(problem.path.samples, problem.arm.K, *size)


def _look_ahead(
    session: Session, problem: PathProblem, options: PathOptions, Q: FloatArray, kept: int
) -> tuple[int, FloatArray]:
    """Return how far the best path of the program holds, and it; else ``kept`` and Q."""
    best, found = kept, Q
    search: Deadline | None = None
    for guess in _guesses(problem, options, Q, kept):
        whole = current()
        if search is None:
            limit = _Limit(Deadline(whole.left / 2, of=whole), ITERATIONS)
        else:
            limit = _Limit(Deadline(min(search.left, whole.left / 2), of=whole), FEWER_ITERATIONS)
        if limit.deadline.left <= 0:
            break
        try:
            solved = _solved(session, problem, options, guess, limit)
        except OutOfMemory:
            if search is None:
                raise
            break  # the first guess had enough: what came of it counts
        until = kept_until(problem, solved)
        if until > best or until == len(Q):
            best, found = until, solved
        if until == len(Q):
            break
        search = search or Deadline(SEARCH)
    if memory_bytes(problem) > KEPT:
        session.retire()
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


@dataclass(frozen=True, eq=False)
class _Limit:
    """How long a program may be worked at.

    Attributes:
        deadline: Until when.
        iterations: How many.
    """

    deadline: Deadline
    iterations: int


def _solved(
    session: Session,
    problem: PathProblem,
    options: PathOptions,
    guess: FloatArray,
    limit: _Limit,
) -> FloatArray:
    """Return the program's path from a guess; solved again where it comes too near in between."""
    solved = _attempted(session, problem, program_data(problem, options), guess, limit)
    between: list[tuple[int, float]] = []
    for _ in range(TRIES):
        current().check_wanted()
        swept = swept_between(problem, solved)
        near = np.flatnonzero(swept < problem.d_safe)
        clearance, _ = clearances_at(problem, solved)
        if not near.size or clearance[1:].min() < problem.d_safe or limit.deadline.left <= 0:
            break
        between += [(int(k), nearest_part(problem, solved[k], solved[k + 1])) for k in near]
        data = program_data(problem, options, between)
        try:
            solved = _attempted(session, problem, data, solved, limit)
        except OutOfMemory:
            break
    return solved


def _attempted(
    session: Session, problem: PathProblem, data: ProgramData, Q: FloatArray, limit: _Limit
) -> FloatArray:
    """Return the path of a program from a first guess of shape (N, K), its row 0 kept.

    It is the guess itself where the program has no answer in time.

    Raises:
        OutOfMemory: The program needs more memory than it may take.
    """
    memory = memory_bytes(problem)
    seconds = limit.deadline.left
    attempt = Attempt(pickle.dumps(data), Q, seconds, limit.iterations, memory <= KEPT)
    answers = session.call(attempt, Limits(memory, seconds), seconds + GRACE)
    if not answers:
        return Q.copy()
    X = array_of(answers[-1], len(Q))
    if not np.isfinite(X).all():
        return Q.copy()
    X = np.clip(X, problem.arm.chain.lower, problem.arm.chain.upper)
    return np.concatenate((Q[:1], X))
