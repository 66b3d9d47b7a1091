"""``python -m bench.all_solutions``: the table of all arms and limits, printed and written down."""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from bench.all_solutions.arms import ARMS, LIMITS, Arm, load
from bench.all_solutions.judging import Judge
from bench.all_solutions.targets import targets
from kinematics.inverse.all_solutions import all_solutions
from robots.robot import FloatArray

RESULTS = Path(__file__).parents[1] / "results-all-solutions.md"
PROGRAMS = ("denavit", "ssik")
BLOCK = 20
"""Targets of a turn."""


@dataclass
class Tally:
    """What happened on an arm with one kind of limits.

    Attributes:
        solutions: Of all targets, by both programs.
        missing: Solutions that a program left out.
        false: Answers that do not reach the target or are beyond the limits.
        complete: Our answers that say they are complete.
        wrong: Those of them to which the other program adds a solution.
        times: Seconds of the processor of each call.
        general: Whether a target was random.
        faults: Target and what is wrong with it.
    """

    solutions: int = 0
    missing: dict[str, int] = field(default_factory=lambda: dict.fromkeys(PROGRAMS, 0))
    false: dict[str, int] = field(default_factory=lambda: dict.fromkeys(PROGRAMS, 0))
    complete: int = 0
    wrong: int = 0
    times: dict[str, list[float]] = field(default_factory=lambda: {one: [] for one in PROGRAMS})
    general: list[bool] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench.all_solutions", description=__doc__)
    parser.add_argument("--targets", type=int, default=500, help="of each arm and kind of limits")
    parser.add_argument("--arms", nargs="+", choices=ARMS, default=list(ARMS))
    parser.add_argument("--limits", nargs="+", choices=LIMITS, default=list(LIMITS))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output", type=Path, default=RESULTS)
    options = parser.parse_args()
    rows = list(HEAD.format(targets=options.targets, seed=options.seed).splitlines())
    print("\n".join(rows), flush=True)
    for name in options.arms:
        for limits in options.limits:
            tally = measured(load(name, limits), options.targets, options.seed)
            rows.append(row(name, limits, options.targets, tally))
            print("\n".join((rows[-1], *tally.faults)), flush=True)
    options.output.write_text("\n".join(rows) + "\n", "utf-8")


HEAD = """\
# All solutions beside ssik 8.2.0

`python -m bench.all_solutions --targets {targets} --seed {seed}`: half of the targets random, a \
quarter singular (a zero of det J between two random q), a quarter of joint values that are \
multiples of 45°. True is what reaches the target by Rodrigues' formula, whoever found it; missing \
what is true, more than 1e-6 rad inside the limits, and not in an answer; wrong a `complete: true` \
of ours beside which the other found more. Both in one process, a block of targets in turn \
each; times are those of the processor.

| arm | limits | targets | solutions | missing: ours | ssik | false: ours | ssik | complete \
| wrong | ours, median, p90 ms | ssik, median, p90 ms | ours / ssik: all, random, special |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"""


def row(name: str, limits: str, count: int, tally: Tally) -> str:
    """Return a row of the table."""
    ours, theirs = (np.array(tally.times[one]) * 1e3 for one in PROGRAMS)
    cells = [name.removesuffix("_ik"), limits, count, tally.solutions]
    cells += [*tally.missing.values(), *tally.false.values(), tally.complete, tally.wrong]
    cells += [f"{np.median(ms):.2f}, {np.quantile(ms, 0.9):.2f}" for ms in (ours, theirs)]
    ratios, general = ours / theirs, np.array(tally.general)
    parts = [ratios, ratios[general], ratios[~general]]
    cells += [", ".join(f"{np.median(part):.2f}" for part in parts if len(part))]
    return f"| {' | '.join(map(str, cells))} |"


def measured(arm: Arm, count: int, seed: int) -> Tally:
    """Give both programs the targets of an arm, a block in turn each, so that caches are warm."""
    tally = Tally()
    made = targets(arm, count, seed)
    for number in range(0, count, BLOCK):
        block = made[number : number + BLOCK]
        poses = [arm.pose(q) for _, q in block]
        answers: dict[str, list[list[FloatArray]]] = {one: [] for one in PROGRAMS}
        complete: list[bool] = []
        for program in PROGRAMS[:: 1 if number // BLOCK % 2 else -1]:
            _solved(arm, program, arm.pose(np.zeros(6)))
            for pose in poses:
                started = time.thread_time()
                found, told = _solved(arm, program, pose)
                tally.times[program].append(time.thread_time() - started)
                answers[program].append(found)
                if program == "denavit":
                    complete.append(told)
        tally.complete += sum(complete)
        for k, (kind, q) in enumerate(block):
            tally.general.append(kind == "random")
            theirs = {one: answers[one][k] for one in PROGRAMS}
            _judge(arm, tally, (number + k, kind, q), theirs, complete[k])
    return tally


def _solved(arm: Arm, program: str, pose: FloatArray) -> tuple[list[FloatArray], bool]:
    """Return the solutions within the limits, and whether they are said to be all."""
    if program == "ssik":
        return [np.asarray(one.q) for one in arm.module.solve(pose)], False
    mine = all_solutions(arm.robot, pose)
    return [one.q for one in mine.solutions if one.within_limits], mine.complete


def _judge(
    arm: Arm,
    tally: Tally,
    made: tuple[int, str, FloatArray],
    answers: dict[str, list[FloatArray]],
    complete: bool,
) -> None:
    number, kind, q = made
    judge = Judge(arm, arm.pose(q))
    truth = judge.truth(*answers.values(), [q])
    tally.solutions += len(truth)
    for program in PROGRAMS:
        missing = [one for one in truth if not judge.has(answers[program], one)]
        false = sum(not (judge.is_true(one) and arm.inside(one, 1e-12)) for one in answers[program])
        tally.missing[program] += len(missing)
        tally.false[program] += false
        if program == "denavit":
            tally.wrong += complete and bool(missing)
            if missing or false:
                where = f"  target {number} ({kind}) of q = {q.tolist()}"
                tally.faults.append(f"{where}: {len(missing)} missing, {false} false")
                tally.faults += [f"    missing {one.tolist()}" for one in missing]


if __name__ == "__main__":
    os.environ.setdefault("SSIK_DERIVATION_CACHE", "off")
    main()
