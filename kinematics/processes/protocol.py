"""What a process and its parent say to each other. Standard library only: processes start fast."""

from __future__ import annotations

from dataclasses import dataclass

HEADER = 8
"""Bytes of a length, big-endian."""
ANSWER, DONE, NO_MEMORY, FAILED = b"a", b"d", b"m", b"f"
"""First byte of a message: an answer; the task is finished; it ran out of memory; a traceback."""


@dataclass(frozen=True)
class Limits:
    """What a task may take.

    Attributes:
        memory: Bytes besides those of an idle process.
        seconds: Processor time; may be infinite.
    """

    memory: int
    seconds: float


def framed(content: bytes, tag: bytes = b"") -> bytes:
    """Return a message: its tag, its length, its content."""
    return tag + len(content).to_bytes(HEADER) + content


def messages(received: bytes) -> tuple[list[tuple[bytes, bytes]], bytes]:
    """Return the whole messages at the start of what was received, and the rest."""
    found = []
    head = 1 + HEADER
    while len(received) >= head:
        end = head + int.from_bytes(received[1:head])
        if len(received) < end:
            break
        found.append((received[:1], received[head:end]))
        received = received[end:]
    return found, received
