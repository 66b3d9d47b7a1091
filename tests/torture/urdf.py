"""``python -m tests.torture.urdf --count 100000 --seed 0``: mutated URDFs against the gate.

Case k of a seed is the same in every run, and does not depend on the others.
"""

from __future__ import annotations

import random
from functools import cache

import click

from robots.shipped import shipped_file, shipped_ids, urdf_path
from tests.torture.campaign import run
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


@click.command()
@click.option("--count", default=1000, show_default=True, help="How many cases.")
@click.option("--seed", default=0, show_default=True)
@click.option("--first", default=0, show_default=True, help="First case.")
@click.option("--save", type=click.Path(), help="Folder for the documents that fail.")
def main(count: int, seed: int, first: int, save: str | None) -> None:
    """Judges mutated URDFs."""
    run(document, judge, bytes, count, seed, first, save)


if __name__ == "__main__":
    main()
