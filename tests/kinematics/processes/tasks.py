"""Tasks of the tests of processes: a word, and what it takes."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator


def prepare() -> Callable[[tuple[str, int]], Iterator[bytes]]:
    return work


def work(task: tuple[str, int]) -> Iterator[bytes]:
    word, size = task
    if word == "fill":
        yield str(len(bytearray(size))).encode()
    elif word == "fill later":
        yield b"first"
        bytearray(size)
    elif word == "fail":
        raise ValueError("no such thing")
    elif word == "print":
        sys.stdout.write("x" * size)
        sys.stdout.flush()
        os.write(1, b"y" * size)
        yield b"z" * size
    elif word == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    elif word == "abort":
        os.abort()
    elif word == "pid":
        yield str(os.getpid()).encode()
    else:
        while True:
            pass
