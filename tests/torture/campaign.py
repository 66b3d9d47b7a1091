"""Many cases one after the other, and figures about them."""

from __future__ import annotations

import random
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import click

T = TypeVar("T")


def run(
    make: Callable[[int, int], tuple[T, random.Random]],
    judge: Callable[[T, random.Random], str],
    content_of: Callable[[T], bytes],
    count: int,
    seed: int,
    first: int,
    save: str | None,
) -> None:
    """Judges cases one after the other, prints figures, and exits with 1 where one failed."""
    outcomes: Counter[str] = Counter()
    slowest, failures, started = 0.0, 0, time.monotonic()
    for case in range(first, first + count):
        document, rng = make(seed, case)
        before = time.thread_time()
        try:
            outcomes[judge(document, rng)] += 1
        except Exception as error:
            failures += 1
            click.echo(f"FAILED seed {seed} case {case}: {type(error).__name__}: {error}")
            if save is not None:
                Path(save).mkdir(parents=True, exist_ok=True)
                (Path(save) / f"{seed}-{case}").write_bytes(content_of(document))
        slowest = max(slowest, time.thread_time() - before)
        if (case + 1 - first) % 5000 == 0:
            click.echo(f"{case + 1 - first} cases, {dict(outcomes)}, {failures} failures")
    seconds = time.monotonic() - started
    click.echo(
        f"{count} cases of seed {seed} in {seconds:.0f} s: {dict(outcomes)}, {failures} failures;"
        f" slowest {slowest:.3f} s of CPU"
    )
    sys.exit(failures > 0)
