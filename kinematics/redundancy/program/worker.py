"""Programs of whole paths in a process of their own."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kinematics.redundancy.program.data import Attempt

MOST_HELD = 2
"""Small programs that are kept: that of a path, and one with clearances between its samples."""


def prepare() -> Callable[[Attempt], Iterator[bytes]]:
    """Import what the first task needs, and return what does tasks: it keeps its last programs."""
    from kinematics.redundancy.program.build import Program, load_solver
    from kinematics.redundancy.program.exhausted import abort_without_memory

    load_solver()
    abort_without_memory()

    held: dict[bytes, Program] = {}

    def work(attempt: Attempt) -> Iterator[bytes]:
        started = perf_counter()
        try:
            program = held.get(attempt.program)
            if program is None:
                if not attempt.kept or len(held) == MOST_HELD:
                    held.clear()
                program = held[attempt.program] = Program(pickle.loads(attempt.program))
            seconds = attempt.seconds - (perf_counter() - started)
            yield program.solved(attempt.guess, seconds, attempt.iterations).tobytes()
        except RuntimeError as error:
            # CasADi has no type of its own for it.
            if "bad_alloc" in str(error):
                raise MemoryError from None
            raise

    return work
