"""``python -m bench.before PATH``: this checkout against an older one, in turns in one run.

Each has a process of its own, which computes when it is told to; PATH has its environment in
``.venv``, or uses that of this process. One thread but where it says otherwise. Times are the best
of the rounds; ratios are this checkout's time over the older one's: of the best, the median of
those of the rounds, and of the best processor times, which a busy machine leaves alone.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

POSES = 10_000
NUMERIC = ("panda", "iiwa14", "xarm7", "pa10", "planar_8r", "kinova")
CLOSED = ("ur5", "puma560", "kr6_r900", "scara")
TASKS_OF = {"planar_8r": "xy_phi", "scara": "xyz_phi"}
Call = Callable[[], dict[str, Any]]


def cases() -> dict[str, tuple[str, tuple[str, ...]]]:
    """What is measured: a title, then what :func:`prepared` takes."""
    found = {}
    for name in ("panda", "ur5", "planar_8r"):
        found[f"fk {name}"] = (f"{name}: FK, a pose of {POSES}", ("fk", name))
        found[f"jacobian {name}"] = (f"{name}: Jacobian, one of {POSES}", ("jacobian", name))
    for name in NUMERIC:
        title = f"{name}: numeric IK, a target of {POSES}"
        found[f"numeric {name}"] = (title, ("numeric", name))
    for name in (*NUMERIC, *CLOSED):
        title = f"{name}: IK, a target of {POSES}, two threads"
        found[f"batch {name}"] = (title, ("batch", name))
    for name in (*NUMERIC, "ur5"):
        found[f"one {name}"] = (f"{name}: IK, one target, median", ("one", name))
        found[f"p99 {name}"] = (f"{name}: IK, one target, 99th percentile", ("p99", name))
    return found


def prepared(kind: str, name: str) -> Call:
    """Return what measures once, in the checkout whose packages are imported here."""
    import numpy as np

    from kinematics.forward import fk
    from kinematics.inverse import prepared_solver, solve_ik, solve_ik_batch
    from kinematics.inverse.bounds import JointBounds
    from kinematics.jacobian import jacobian
    from kinematics.task import TASKS
    from robots.shipped import shipped_robot

    if kind == "numeric":
        prepared_solver.closed_form_of = lambda _: None  # type: ignore[assignment]
    robot, task = shipped_robot(name), TASKS[TASKS_OF.get(name, "pose")]
    low, high = JointBounds.of(robot).ranges(1.0)
    q = np.random.default_rng(0).uniform(low, high, (POSES, robot.dof))
    targets = fk(robot, q)[robot.tip_frame]
    calls: dict[str, Callable[[], Any]] = {
        "fk": lambda: fk(robot, q),
        "jacobian": lambda: jacobian(robot, q),
        "numeric": lambda: solve_ik_batch(robot, targets, task=task),
        "batch": lambda: solve_ik_batch(robot, targets, task=task, threads=2),
    }

    def many() -> dict[str, Any]:
        started, began = time.perf_counter(), time.process_time()
        found = calls[kind]()
        busy = (time.process_time() - began) / POSES
        taken = {"seconds": (time.perf_counter() - started) / POSES, "cpu": busy}
        if hasattr(found, "codes"):
            taken |= {"solved": int((found.codes == 0).sum()), "steps": int(found.iterations.sum())}
        return taken

    def one() -> dict[str, Any]:
        times, wanted = [], 0.5 if kind == "one" else 0.99
        for target in targets[:1000]:
            # Of three, so that what another process interrupts does not count.
            three = []
            for _ in range(3):
                started = time.perf_counter()
                solve_ik(robot, target, task=task)
                three.append(time.perf_counter() - started)
            times.append(min(three))
        seconds = float(np.quantile(times, wanted))
        return {"seconds": seconds, "cpu": seconds}

    return one if kind in ("one", "p99") else many


def serve() -> None:
    """Measure what each line of the standard input asks for."""
    calls: dict[str, Call] = {}
    for line in sys.stdin:
        kind, name = json.loads(line)
        if f"{kind} {name}" not in calls:
            calls = {f"{kind} {name}": prepared(kind, name)}
            for call in calls.values():
                call()
        sys.stdout.write(json.dumps(calls[f"{kind} {name}"]()) + "\n")
        sys.stdout.flush()


class Checkout:
    """A process that computes with the packages of a checkout."""

    def __init__(self, path: Path) -> None:
        own = path / ".venv" / "bin" / "python"
        python = str(own) if own.exists() else sys.executable
        environment = {**os.environ, "PYTHONPATH": str(path)}
        environment.pop("NUMBA_CACHE_DIR", None)
        self.process = subprocess.Popen(
            [python, "-P", __file__, "--serve"],
            cwd=path,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def measure(self, what: tuple[str, ...]) -> dict[str, Any]:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(json.dumps(what) + "\n")
        self.process.stdin.flush()
        found: dict[str, Any] = json.loads(self.process.stdout.readline())
        return found


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench.before", description=__doc__)
    parser.add_argument("path", type=Path, nargs="?", help="the older checkout")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--only", default="", help="only what has this in its name")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.serve:
        serve()
        return
    if chosen.path is None:
        parser.error("give the path of the older checkout")
    report(chosen.path, chosen.rounds, chosen.only)


def report(older: Path, rounds: int = 7, only: str = "") -> None:
    """Print a line for each case whose name has ``only`` in it."""
    checkouts = (Path(__file__).parents[1], older.resolve())
    sides: dict[bool, tuple[Checkout, Checkout]] = {}
    print(f"{'':46}{'now':>10}{'before':>10}   best median processor")
    for key, (title, what) in cases().items():
        if only not in key:
            continue
        numeric = what[0] == "numeric"  # closed forms are switched off in a process of its own
        if numeric not in sides:
            sides[numeric] = (Checkout(checkouts[0]), Checkout(checkouts[1]))
        ours, theirs = sides[numeric]
        pairs = [(ours.measure(what), theirs.measure(what)) for _ in range(rounds)]
        now, before = (min(found["seconds"] for found in side) for side in zip(*pairs, strict=True))
        ratio = statistics.median(a["seconds"] / b["seconds"] for a, b in pairs)
        line = (
            f"{title:58}{now * 1e6:>8.3f}µs{before * 1e6:>8.3f}µs  {now / before:.3f}  {ratio:.3f}"
        )
        mine, other = pairs[-1]
        if "solved" in mine:
            line += f"  solved {mine['solved']} | {other['solved']}"
            line += f"  steps {mine['steps']} | {other['steps']}"
        print(line, flush=True)


if __name__ == "__main__":
    main()
