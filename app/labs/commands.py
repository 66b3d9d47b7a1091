"""Blocks of shell commands of a sheet, read into what they do: files saved, requests sent."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass

_FILE = re.compile(r"cat > ([\w.-]+) <<'(\w+)'")


class UnknownCommand(ValueError):
    """A block holds something else than a saved file and curl with the options known here."""


@dataclass(frozen=True)
class SavedFile:
    """A text that is saved.

    Attributes:
        name: Name of the file.
        text: What it holds; its last line ends.
    """

    name: str
    text: str


@dataclass(frozen=True)
class SentRequest:
    """A request that is sent, and whose answer is shown or saved.

    Attributes:
        method: GET, POST, PUT or DELETE.
        url: With its scheme.
        content_type: Of the body; empty where there is none.
        body: The body; None: there is none, or it is a file.
        body_file: Name of the file with the body.
        output: Name of the file that the answer is saved in; None: it is shown.
    """

    method: str
    url: str
    content_type: str = ""
    body: str | None = None
    body_file: str | None = None
    output: str | None = None


Statement = SavedFile | SentRequest


def read_commands(text: str) -> tuple[Statement, ...]:
    """Return the statements of a block, in order.

    Raises:
        UnknownCommand: There is something that only a shell can do.
    """
    found: list[Statement] = []
    lines = iter(text.splitlines())
    for line in lines:
        if not line.strip():
            continue
        saved = _FILE.fullmatch(line)
        found.append(_saved(saved, lines) if saved else _request(_words(line, lines)))
    return tuple(found)


def _saved(opening: re.Match[str], lines: Iterator[str]) -> SavedFile:
    kept: list[str] = []
    for line in lines:
        if line == opening[2]:
            return SavedFile(opening[1], "".join(f"{one}\n" for one in kept))
        kept.append(line)
    raise UnknownCommand(f"{opening[0]} has no end")


def _words(line: str, lines: Iterator[str]) -> list[str]:
    """Return the words of a command, which goes on while a quote or a line is open."""
    while True:
        if not line.endswith("\\"):
            try:
                return shlex.split(line)
            except ValueError as error:
                last = error
        else:
            line, last = line[:-1], ValueError("the last line goes on")
        following = next(lines, None)
        if following is None:
            raise UnknownCommand(f"{line}: {last}")
        line = line + ("" if line.endswith(" ") else "\n") + following


def _request(words: list[str]) -> SentRequest:
    if words[0] != "curl":
        raise UnknownCommand(f"{words[0]} is not curl")
    url = method = output = body = body_file = None
    content_type = ""
    rest = iter(words[1:])
    for word in rest:
        match word:
            case "-s":
                continue
            case "-X":
                method = next(rest)
            case "-o":
                output = next(rest)
            case "-T":
                body_file, method = next(rest), method or "PUT"
            case "-d" | "--data-binary":
                given, method = next(rest), method or "POST"
                body, body_file = (None, given[1:]) if given[0] == "@" else (given, None)
            case "-H":
                name, _, value = next(rest).partition(": ")
                if name.lower() != "content-type":
                    raise UnknownCommand(f"a header {name}")
                content_type = value
            case _ if word.startswith("-") or url is not None:
                raise UnknownCommand(word)
            case _:
                url = word if "://" in word else f"http://{word}"
    if url is None:
        raise UnknownCommand("curl without an address")
    return SentRequest(method or "GET", url, content_type, body, body_file, output)
