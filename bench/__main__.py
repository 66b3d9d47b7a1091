"""``python -m bench``: every benchmark, as ratios of two things measured in turns in one run.

``python -m bench --before PATH`` measures against an older checkout; see :mod:`bench.before`.
"""

import argparse
from pathlib import Path

from bench import before, compute, http, http_short, redundancy

if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("--before", type=Path, metavar="PATH", help="an older checkout")
    older = parser.parse_args().before
    if older is not None:
        before.report(older)
        parser.exit()
    reports = (
        ("In process", compute.run()),
        ("Redundancy", redundancy.run()),
        ("Over HTTP", http.run()),
        ("Short computations over HTTP, beside a server that does nothing", http_short.run()),
    )
    for title, rows in reports:
        print(f"\n{title}")
        width = max((len(row.what) for row in rows), default=0)
        for row in rows:
            print(f"  {row.what:{width}}  {row.ours:>12}  {row.other:>12}  ratio {row.ratio:.2f}")
