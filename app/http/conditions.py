"""Conditions of requests: the revisions that If-Match and If-None-Match name (RFC 9110, 13.1)."""

from __future__ import annotations

from fastapi import Request


def if_match_of(request: Request) -> tuple[str, ...]:
    """The revisions that a request insists on; empty for any or none."""
    return tuple(_revision(tag) for tag in _tags(request, "if-match"))


def if_none_match_of(request: Request) -> tuple[str, ...]:
    """The revisions that a request must not meet; empty for none."""
    return tuple(_revision(tag.removeprefix("W/")) for tag in _tags(request, "if-none-match"))


def _tags(request: Request, header: str) -> list[str]:
    return [item.strip() for line in request.headers.getlist(header) for item in line.split(",")]


def _revision(tag: str) -> str:
    # A star in quotes is a tag that no robot has; without them, it would stand for any.
    quoted = len(tag) > 1 and tag[0] == tag[-1] == '"' and tag != '"*"'
    return tag[1:-1] if quoted else tag
