"""The tables, printed and as Markdown."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from bench.peers.arms import ARMS, RESTARTS
from bench.peers.measure import BLOCK, Score
from bench.peers.peer import Peer

HEAD = ("solver", "success %", "median µs", "peer / ours", "targets")


def rows(scores: list[Score]) -> list[tuple[str, ...]]:
    """One line a peer that was measured."""
    return [
        (
            score.peer.name,
            f"{100 * score.success:.1f}",
            f"{score.median * 1e6:.1f}",
            f"{score.ratio(scores[0]):.2f}",
            str(len(score.times)),
        )
        for score in scores
        if not score.skipped
    ]


def lines(arm: str, scores: list[Score]) -> list[str]:
    """For the terminal."""
    made = [f"\n{arm} ({ARMS[arm]})"]
    made += [
        f"  {name:16}" + "".join(f"{cell:>13}" for cell in cells)
        for name, *cells in (HEAD, *rows(scores))
    ]
    made += [f"  {one.peer.name:16} skipped: {one.skipped}" for one in scores if one.skipped]
    return made


class Run:
    """One run, arm by arm."""

    def __init__(self, targets: int, seconds: float) -> None:
        self.targets, self.seconds = targets, seconds
        self.started, self.load = datetime.now(UTC), os.getloadavg()
        self.arms: dict[str, list[Score]] = {}

    def add(self, arm: str, scores: list[Score]) -> None:
        self.arms[arm] = scores

    def text(self, peers: list[Peer]) -> str:
        """The report in Markdown."""
        load = " → ".join(f"{one[0]:.2f}" for one in (self.load, os.getloadavg()))
        made = [
            "# Inverse kinematics against other solvers",
            "",
            f"{self.started:%Y-%m-%d %H:%M} UTC, {os.cpu_count()} CPUs ({platform.machine()}),"
            f" Python {platform.python_version()}, load of the machine (1 min) {load}.",
            "",
            f"{self.targets} reachable random targets an arm, all from the mid-range seed. Solved"
            " means: within the joint limits (1e-9 for rounding), and Pinocchio's forward"
            " kinematics of the canonical URDF is within 1e-6 m and 1e-6 rad of the target; what a"
            " solver says of itself does"
            f" not count. Solvers took turns of {BLOCK} targets in a rotating order, so that load"
            " hits all alike: read the ratios, taken turn by turn, not the microseconds. A solve"
            " includes what is"
            " converted for the solver, its restarts, and its failures. A solver that used"
            f" {self.seconds:g} s on an arm stopped there; `targets` is how many it was given."
            " Where a peer wants limits, a joint without any has ±π; where it knows only whole"
            " poses, the planar arm's targets are whole poses in its plane.",
            "",
            "Written by `python -m bench.peers`.",
            "",
            "## Solvers",
            "",
            "| solver | distribution | how |",
            "| --- | --- | --- |",
            *(f"| {p.name} | {_version(p.distribution)} | {p.how} |" for p in peers),
            "",
            f"Solvers whose interface has no restarts get up to {RESTARTS} random ones.",
        ]
        summary = "Success in %, and how many times our time the peer takes (median over turns)."
        made += ["", "## Summary", "", summary, ""]
        made += ["| solver | " + " | ".join(self.arms) + " |"]
        made += ["| --- |" + " ---: |" * len(self.arms)]
        for k, peer in enumerate(peers):
            cells = [_cell(scores[k], scores[0]) for scores in self.arms.values()]
            made.append(f"| {peer.name} | " + " | ".join(cells) + " |")
        for arm, scores in self.arms.items():
            made += ["", f"## {arm}, task `{ARMS[arm]}`", ""]
            made += ["| " + " | ".join(HEAD) + " |", "| --- |" + " ---: |" * (len(HEAD) - 1)]
            made += ["| " + " | ".join(cells) + " |" for cells in rows(scores)]
            skipped = [score for score in scores if score.skipped]
            if skipped:
                made += ["", *(f"- {s.peer.name}: skipped, {s.skipped}" for s in skipped)]
        return "\n".join(made) + "\n"


def _cell(score: Score, ours: Score) -> str:
    if score.skipped:
        return "–"
    return f"{100 * score.success:.1f}, {score.ratio(ours):.2f}×"


def _version(distribution: str) -> str:
    try:
        return f"{distribution} {version(distribution)}"
    except PackageNotFoundError:
        return f"{distribution}, not installed"
