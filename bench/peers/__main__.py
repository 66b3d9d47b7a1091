"""``python -m bench.peers``: the table of all arms and solvers, printed and written down."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from bench.peers.arms import ARMS, load
from bench.peers.measure import measure
from bench.peers.report import Run, lines
from bench.peers.roster import PEERS

RESULTS = Path(__file__).parents[1] / "results.md"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench.peers", description=__doc__)
    parser.add_argument("--targets", type=int, default=300, help="random targets of each arm")
    parser.add_argument("--seconds", type=float, default=6.0, help="at most, a solver and arm")
    parser.add_argument("--arms", nargs="+", choices=ARMS, default=list(ARMS))
    parser.add_argument("--peers", nargs="+", default=[peer.name for peer in PEERS])
    parser.add_argument("--output", type=Path, default=RESULTS)
    options = parser.parse_args()
    peers = [peer for peer in PEERS if peer is PEERS[0] or peer.name in options.peers]
    run = Run(options.targets, options.seconds)
    with tempfile.TemporaryDirectory() as folder:
        for name in options.arms:
            scores = measure(load(name, Path(folder)), peers, options.targets, options.seconds)
            run.add(name, scores)
            print("\n".join(lines(name, scores)), flush=True)
    options.output.write_text(run.text(peers), "utf-8")


if __name__ == "__main__":
    main()
