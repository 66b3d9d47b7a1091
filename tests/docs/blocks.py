"""Code blocks of the documentation: found, run as a reader would, compared with what is shown."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from tests.conftest import unused_port

ROOT = Path(__file__).parents[2]
LABS = tuple(sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("labs/**/*.md")))
DOCS = ("README.md", *sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/*.md")))
PAGES = (*DOCS, *LABS)
RUN = ("bash", "python")
OUTPUT = ("text", "json")
SECONDS = 300
BUSY = ("/problems/busy", "/problems/out-of-time", "503 The service has no", "422 The computation")
TRIES = 8
"""How often a service that is full, or too slow now, is asked again."""

_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_VOLATILE = re.compile(r'(elapsed_ms"?: |request_id"?: "?)[\w.-]+')
_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
_TOLERANCE = 2e-5


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its text, and where the text stands in the page."""

    language: str
    text: str
    begin: int
    end: int


def blocks_of(page: str) -> list[Block]:
    return [
        Block(match[1], match[2], match.start(2), match.end(2)) for match in _BLOCK.finditer(page)
    ]


def runs_of(page: str) -> list[tuple[Block, Block | None]]:
    """Every block that can be run, in order, with the output that is shown below it."""
    found = blocks_of(page)
    return [
        (block, following if following and following.language in OUTPUT else None)
        for block, following in pairwise([*found, None])
        if block.language in RUN
    ]


def run(block: Block, server: str, folder: Path) -> str:
    """What a block prints, run in a folder and against a server of the test."""
    text = block.text.replace("localhost:8000", server.removeprefix("http://"))
    text = text.replace("8010", str(unused_port()))
    command = ["bash", "-euo", "pipefail", "-c", text]
    if block.language == "python":
        command = [sys.executable, "-c", text]
    environment = {
        **os.environ,
        "DENAVIT_DATA_DIR": str(folder / "data"),
        "DENAVIT_PRELOAD": "false",
    }
    for _ in range(TRIES):
        printed = _printed(command, environment, folder)
        if not any(busy in printed for busy in BUSY):
            break
        time.sleep(1)
    return printed.replace(server.removeprefix("http://"), "localhost:8000")


def _printed(command: list[str], environment: dict[str, str], folder: Path) -> str:
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        printed, errors = process.communicate(timeout=SECONDS)
    finally:
        # A service that the block has started, and that its time has cut off.
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 0, f"{command[-1]}\n{printed}\n{errors}"
    return printed


def assert_same(printed: str, shown: Block) -> None:
    """Whether a command printed what is shown, but for spaces, times, ids and rounding."""
    expected, actual = shown.text, printed
    if shown.language == "json":
        expected, actual = (json.dumps(json.loads(text)) for text in (expected, actual))
    words, numbers = _taken_apart(actual)
    shown_words, shown_numbers = _taken_apart(expected)
    assert words == shown_words
    off = [
        (one, other)
        for one, other in zip(numbers, shown_numbers, strict=True)
        if abs(one - other) > _TOLERANCE * max(1.0, abs(other))
    ]
    assert off == [], "(printed, shown)"


def _taken_apart(text: str) -> tuple[list[str], list[float]]:
    text = _VOLATILE.sub(r"\1…", text)
    numbers = [float(number) for number in _NUMBER.findall(text)]
    return _NUMBER.sub("#", text).split(), numbers
