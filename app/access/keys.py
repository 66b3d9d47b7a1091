"""API keys: made here, kept as hashes, compared in constant time.

A key is 256 random bits, so one SHA-256 of it cannot be undone and needs no salt; a slow hash is
for passwords that people choose.
"""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

PREFIX = "dnv_"
_LINE = re.compile(r"([A-Za-z0-9._-]{1,64}):(read|write):([0-9a-f]{64})")


class Scope(StrEnum):
    """What a key allows: ``read`` reads and computes, ``write`` also changes stored robots."""

    READ = "read"
    WRITE = "write"


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
    """The keys that are accepted.

    Args:
        keys: Each with a name of its own.
    """

    def __init__(self, keys: Iterable[Key]) -> None:
        self._keys = tuple(keys)

    def __bool__(self) -> bool:
        return bool(self._keys)

    def find(self, secret: bytes) -> Key | None:
        """The key that a request shows, if it is known; the time taken does not tell which."""
        digest = _digest(secret)
        found = None
        for key in self._keys:
            if hmac.compare_digest(key.digest, digest):
                found = key
        return found


def read_keys(text: str, file: Path | None = None) -> KeyRing:
    """The keys of hash lines.

    Args:
        text: Lines, or entries between commas or blanks.
        file: A file of more lines; what follows ``#`` is a comment.

    Raises:
        InvalidKeys: A line is none, a name is used twice, or the file cannot be read.
    """
    entries = [("DENAVIT_API_KEYS", item) for item in re.split(r"[,\s]+", text) if item]
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
        if not entries:
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
