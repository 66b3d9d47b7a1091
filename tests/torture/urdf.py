"""``python -m tests.torture.urdf --count 100000 --seed 0``: mutated URDFs against the gate.

Case k of a seed is the same in every run, and does not depend on the others.
"""

from __future__ import annotations

import random
import sys
import time
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path

import click

from robots.shipped import shipped_file, shipped_ids, urdf_path
from tests.torture.urdf_grammar import random_urdf
from tests.torture.urdf_mutations import mutate
from tests.torture.urdf_oracle import judge

REAL = 0.15
"""Part of the cases that start from a robot of the library instead of a random one."""
MAX_REAL_BYTES = 60_000


@cache
def real_urdfs() -> tuple[bytes, ...]:
    """URDFs of robots in the library, the very large ones left out."""
    names = sorted({shipped_file(robot_id).urdf for robot_id in shipped_ids()} - {None})
    texts = (urdf_path(name).read_bytes() for name in names)
    return tuple(text for text in texts if len(text) <= MAX_REAL_BYTES)


def document(seed: int, case: int) -> tuple[bytes, random.Random]:
    """A mutated URDF, and the randomness for its judge."""
    rng = random.Random(f"urdf {seed} {case}")
    real = rng.random() < REAL
    start = rng.choice(real_urdfs()) if real else random_urdf(rng).encode()
    return mutate(rng, start), rng


def run(
    make: Callable[[int, int], tuple[bytes, random.Random]],
    judge: Callable[[bytes, random.Random], str],
    count: int,
    seed: int,
    first: int,
    save: str | None,
) -> None:
    """Judges cases one after the other, prints figures, and exits with 1 where one failed."""
    outcomes: Counter[str] = Counter()
    slowest, failures, started = 0.0, 0, time.monotonic()
    for case in range(first, first + count):
        content, rng = make(seed, case)
        before = time.thread_time()
        try:
            outcomes[judge(content, rng)] += 1
        except Exception as error:
            failures += 1
            click.echo(f"FAILED seed {seed} case {case}: {type(error).__name__}: {error}")
            if save is not None:
                Path(save).mkdir(parents=True, exist_ok=True)
                (Path(save) / f"{seed}-{case}").write_bytes(content)
        slowest = max(slowest, time.thread_time() - before)
        if (case + 1 - first) % 5000 == 0:
            click.echo(f"{case + 1 - first} cases, {dict(outcomes)}, {failures} failures")
    seconds = time.monotonic() - started
    click.echo(
        f"{count} cases of seed {seed} in {seconds:.0f} s: {dict(outcomes)}, {failures} failures;"
        f" slowest {slowest:.3f} s of CPU"
    )
    sys.exit(failures > 0)


@click.command()
@click.option("--count", default=1000, show_default=True, help="How many cases.")
@click.option("--seed", default=0, show_default=True)
@click.option("--first", default=0, show_default=True, help="First case.")
@click.option("--save", type=click.Path(), help="Folder for the documents that fail.")
def main(count: int, seed: int, first: int, save: str | None) -> None:
    """Judges mutated URDFs."""
    run(document, judge, count, seed, first, save)


if __name__ == "__main__":
    main()
