"""``python -m tests.torture.tables --count 50000``: mutated D-H tables against their readers.

JSON, YAML, CSV, SYMORO ``.par`` and pasted texts. Case k of a seed is the same in every run.
"""

from __future__ import annotations

import random

import click

from tests.torture.campaign import run
from tests.torture.table_grammar import Text, random_text
from tests.torture.table_mutations import mutate
from tests.torture.table_oracle import judge


def text(seed: int, case: int) -> tuple[Text, random.Random]:
    """A mutated table, and the randomness for its judge."""
    rng = random.Random(f"table {seed} {case}")
    return mutate(rng, random_text(rng)), rng


@click.command()
@click.option("--count", default=1000, show_default=True, help="How many cases.")
@click.option("--seed", default=0, show_default=True)
@click.option("--first", default=0, show_default=True, help="First case.")
@click.option("--save", type=click.Path(), help="Folder for the documents that fail.")
def main(count: int, seed: int, first: int, save: str | None) -> None:
    """Judges mutated tables."""
    run(text, judge, lambda text: text.content, count, seed, first, save)


if __name__ == "__main__":
    main()
