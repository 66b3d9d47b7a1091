"""API keys: made here, kept as hashes, compared in constant time.

A key is 256 random bits, so one SHA-256 of it cannot be undone and needs no salt; a slow hash is
for passwords that people choose.
"""

from __future__ import annotations

import hashlib
import hmac
import logging
import re
import secrets
import time
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from app.settings import listed

LOG = logging.getLogger("denavit.access")
PREFIX = "dnv_"
LOOK_SECONDS = 1.0
"""How often it is looked whether the file of the keys has changed."""
_LINE = re.compile(r"([A-Za-z0-9._-]{1,64}):(read|write|share):([0-9a-f]{64})")


class Scope(StrEnum):
    """What a key allows.

    ``read`` reads and computes, ``write`` also changes stored robots, ``share`` changes those that
    all keys see; without namespaces these are all robots.
    """

    READ = "read"
    WRITE = "write"
    SHARE = "share"

    @property
    def changes(self) -> bool:
        """Whether stored robots may be changed."""
        return self is not Scope.READ


class InvalidKeys(ValueError):
    """Hash lines that cannot be read; says which, not what they hold."""


@dataclass(frozen=True)
class Key:
    """A key that is known by its hash.

    Attributes:
        name: Whose it is.
        scope: What it allows.
        digest: SHA-256 of the key.
    """

    name: str
    scope: Scope
    digest: bytes

    @property
    def line(self) -> str:
        """The hash line: ``name:scope:hex``."""
        return f"{self.name}:{self.scope}:{self.digest.hex()}"


def new_key(name: str, scope: Scope) -> tuple[str, Key]:
    """A new random key, and what is kept of it.

    Raises:
        InvalidKeys: The name has other characters than letters, digits, ``. _ -``.
    """
    secret = PREFIX + secrets.token_urlsafe(32)
    key = Key(name, scope, _digest(secret.encode()))
    if not _LINE.fullmatch(key.line):
        raise InvalidKeys("the name of a key is made of letters, digits and . _ -")
    return secret, key


class KeyRing:
    """The keys that are accepted at a moment.

    Args:
        keys: Each with a name of its own.
    """

    def __init__(self, keys: Iterable[Key]) -> None:
        self._keys = tuple(keys)

    def __len__(self) -> int:
        return len(self._keys)

    def find(self, secret: bytes) -> Key | None:
        """The key that a request shows, if it is known; the time taken does not tell which."""
        digest = _digest(secret)
        found = None
        for key in self._keys:
            if hmac.compare_digest(key.digest, digest):
                found = key
        return found


class KeySource:
    """The keys of a deployment, read again when their file has changed.

    So a key can be revoked while the service runs. A file that cannot be read leaves the keys as
    they are, and a log line says so.

    Args:
        text: As of :func:`read_keys`.
        file: As of :func:`read_keys`.

    Attributes:
        required: Whether a key is needed; what the file holds later changes nothing about that.

    Raises:
        InvalidKeys: The keys cannot be read.
    """

    def __init__(self, text: str, file: Path | None = None) -> None:
        self._text = text
        self._file = file
        self._state = self._state_of_file()
        self._ring = read_keys(text, file)
        self._looked = time.monotonic()
        self.required = bool(self._ring)

    def find(self, secret: bytes) -> Key | None:
        """Return the key that a request shows, if it is known now."""
        if self._file is not None and time.monotonic() - self._looked > LOOK_SECONDS:
            self._looked = time.monotonic()
            state = self._state_of_file()
            if state != self._state:
                self._state = state
                self.read_again()
        return self._ring.find(secret)

    def read_again(self) -> None:
        """Read the keys, whether or not the file looks changed."""
        try:
            self._ring = read_keys(self._text, self._file, may_be_empty=True)
        except InvalidKeys as error:
            LOG.error("keys stay as they were: %s", error)
        else:
            LOG.info("keys read again: %d are accepted", len(self._ring))

    def _state_of_file(self) -> tuple[int, int, int] | None:
        """Return what changes with the content of the file; None where it is not there."""
        try:
            found = self._file.stat() if self._file is not None else None
        except OSError:
            return None
        return found and (found.st_ino, found.st_size, found.st_mtime_ns)


def read_keys(text: str, file: Path | None = None, *, may_be_empty: bool = False) -> KeyRing:
    """Return the keys of hash lines.

    Args:
        text: Lines, or entries between commas or blanks.
        file: A file of more lines; what follows ``#`` is a comment.
        may_be_empty: Whether a file without a key is accepted.

    Raises:
        InvalidKeys: A line is none, a name is used twice, or the file cannot be read.
    """
    entries = [("DENAVIT_API_KEYS", item) for item in listed(text)]
    if file is not None:
        try:
            content = file.read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            reason = getattr(error, "strerror", None) or "it is no text"
            raise InvalidKeys(f"DENAVIT_API_KEYS_FILE cannot be read: {reason}") from None
        for number, line in enumerate(content.splitlines(), 1):
            item = line.partition("#")[0].strip()
            if item:
                entries.append((f"line {number} of DENAVIT_API_KEYS_FILE", item))
        if not entries and not may_be_empty:
            raise InvalidKeys("DENAVIT_API_KEYS_FILE holds no key; make one with denavit key")
    keys: dict[str, Key] = {}
    for place, item in entries:
        match = _LINE.fullmatch(item)
        if match is None:
            raise InvalidKeys(
                f"{place} is no hash line name:scope:sha256; make one with denavit key"
            )
        name, scope, digest = match.groups()
        if name in keys:
            raise InvalidKeys(f"{place}: the name {name} is taken; give each key its own")
        keys[name] = Key(name, Scope(scope), bytes.fromhex(digest))
    return KeyRing(keys.values())


def _digest(secret: bytes) -> bytes:
    return hashlib.sha256(secret).digest()
