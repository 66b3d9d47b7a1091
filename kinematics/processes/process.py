"""One process of a pool, as its parent sees it."""

from __future__ import annotations

import logging
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from kinematics.deadline import current
from kinematics.processes.protocol import ANSWER, DONE, FAILED, NO_MEMORY, framed, messages

ROOT = Path(__file__).parents[2]
LOOK = 0.2
"""Interval of checks whether the result is still wanted, s."""
MAX_ERRORS = 2000
"""Most bytes of a process's standard error that are logged."""
START = (
    "import sys; sys.path.append(sys.argv[1]); from kinematics.processes.worker import main; main()"
)
"""The program of a process; its arguments: where the packages are if they are not installed, and
the module that does the work."""
NEARLY = 0.9
"""Part of its memory with which a process that died is taken to have run out of it."""
ENDING = 5.0
"""Seconds that a process which has closed its output may take to end."""
_LOG = logging.getLogger(__name__)
_READ = 1 << 20


@dataclass
class Outcome:
    """What came of a task.

    Attributes:
        answers: Whole answers, the last one the best.
        finished: Whether the task is done, so that the process is fit for another.
        failure: The traceback of an error; empty where there was none.
        out_of_memory: Whether it needed more memory than it had.
    """

    answers: list[bytes] = field(default_factory=list)
    finished: bool = False
    failure: str = ""
    out_of_memory: bool = False

    @property
    def over(self) -> bool:
        """Whether there is nothing more to come."""
        return self.finished or self.out_of_memory or bool(self.failure)


class Process:
    """A process for one task after another.

    It imports nothing from the directory in which the service was started: it runs in safe-path
    mode, without PYTHONPATH, from the root directory.

    Args:
        module: Name of the module that does the work.

    Attributes:
        tasks: Number of tasks that it has been given.
    """

    def __init__(self, module: str) -> None:
        self.tasks = 0
        self._module = module
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  closed by end()
        self._process = started(module, self._errors)

    def is_alive(self) -> bool:
        """Return whether the process runs."""
        return self._process.poll() is None

    def end(self) -> None:
        """End the process, and log what it has written to standard error."""
        with self._process:
            status = self._process.poll()
            self._process.kill()
            assert self._process.stdin is not None
            with suppress(BrokenPipeError):  # a task that it did not live to read
                self._process.stdin.close()
        with self._errors:
            self._errors.seek(max(self._errors.seek(0, os.SEEK_END) - MAX_ERRORS, 0))
            errors = self._errors.read().decode("utf-8", "replace").strip()
        if status is not None or errors:
            name = self._module
            _LOG.error("%s ended with status %s: %s", name, status, errors or "no message")

    def outcome(self, task: bytes, deadline: float) -> Outcome:
        """Give it a task, and return what has come of it before a deadline.

        Raises:
            Cancelled: The result is no longer wanted.
        """
        self.tasks += 1
        return outcome(self._process, task, deadline)


def started(module: str, errors: IO[bytes] | int = subprocess.DEVNULL) -> subprocess.Popen[bytes]:
    """Start a process, which writes errors to a file."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.Popen(
        [sys.executable, "-P", "-c", START, str(ROOT), module],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=errors,
        cwd="/",
        # One arena of memory: what is freed in one thread serves the next.
        env={**environment, "OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"},
    )


def outcome(process: subprocess.Popen[bytes], task: bytes, deadline: float) -> Outcome:
    """See :meth:`Process.outcome`."""
    assert process.stdin is not None
    assert process.stdout is not None
    wanted = current()
    found, received, filled = Outcome(), b"", 0.0
    try:
        process.stdin.write(framed(task))
        process.stdin.flush()
    except BrokenPipeError:
        return found
    while not found.over and (left := deadline - time.monotonic()) > 0:
        ready, _, _ = select.select([process.stdout], [], [], min(left, LOOK))
        if not ready:
            wanted.check_wanted()
            filled = _filled(process.pid)
            continue
        piece = os.read(process.stdout.fileno(), _READ)
        if not piece:
            found.out_of_memory = filled > NEARLY or _has_aborted(process)
            break
        complete, received = messages(received + piece)
        for tag, content in complete:
            if tag == ANSWER:
                found.answers.append(content)
            found.finished |= tag == DONE
            found.out_of_memory |= tag == NO_MEMORY
            if tag == FAILED:
                found.failure = content.decode()
    return found


def _has_aborted(process: subprocess.Popen[bytes]) -> bool:
    """Return whether a process that has closed its output aborted, as C++ does without memory."""
    with suppress(subprocess.TimeoutExpired):
        return process.wait(ENDING) == -signal.SIGABRT
    return False


def _filled(pid: int) -> float:
    """Return the part of its memory limit that a process takes; 0 where that cannot be known."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
        limits = Path(f"/proc/{pid}/limits").read_text()
        data = int(status.partition("VmData:")[2].split(maxsplit=1)[0]) * 1024
        return data / int(limits.partition("Max data size")[2].split(maxsplit=1)[0])
    except (OSError, ValueError, IndexError):
        return 0.0
