"""Problem documents of RFC 9457: their types, and the answer that carries one."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import orjson
from fastapi import Request, Response

from app.http.language import language_headers, language_of
from dh_to_urdf.languages import Language
from dh_to_urdf.messages import say

MEDIA_TYPE = "application/problem+json"
MAX_ERRORS = 10
MAX_MESSAGE = 400
MAX_TRANSLATED = 600
"""Other languages take more room than English."""
MAX_BYTES = 4096
MAX_XPATH = 160
# Control characters, and those that turn the direction of what follows.
_UNSAFE = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb]+"
)


@dataclass(frozen=True, slots=True)
class ProblemType:
    """A kind of problem.

    Attributes:
        slug: Last part of its type URI.
        status: HTTP status.
        title: What it is, in one line.
    """

    slug: str
    status: int
    title: str


@dataclass(frozen=True, slots=True)
class ErrorEntry:
    """One entry of ``errors`` of a problem document.

    Attributes:
        pointer: JSON pointer (RFC 6901) to the field at fault, empty for the whole request.
        message: What is wrong and what to send instead.
        line: Line of an XML text where it stands; None elsewhere.
        xpath: The element at fault of an XML text; else empty.
    """

    pointer: str
    message: str
    line: int | None = None
    xpath: str = ""


class RequestProblem(Exception):
    """A problem that the HTTP layer itself finds."""

    def __init__(
        self,
        type_: ProblemType,
        detail: str,
        pointer: str = "",
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.type = type_
        self.entries = (ErrorEntry(pointer, detail),)
        self.headers = dict(headers or {})


MALFORMED_BODY = ProblemType("malformed-body", 400, say("The body cannot be parsed"))
INVALID_REQUEST = ProblemType("invalid-request", 422, say("The request cannot be used"))
UNSUPPORTED_TYPE = ProblemType(
    "unsupported-media-type", 415, say("This body type is not read here")
)
TOO_LONG = ProblemType("uri-too-long", 414, say("The address is too long"))
NOT_ACCEPTABLE = ProblemType("not-acceptable", 406, say("The answer has no such form"))
TOO_LARGE = ProblemType("too-large", 413, say("The request is too large"))
INTERNAL = ProblemType("internal-error", 500, say("The service failed"))
STOPPING = ProblemType("stopping", 503, say("The service is stopping"))

BUSY = ProblemType("busy", 503, say("The service has no room for this now"))
UNAUTHORISED = ProblemType("unauthorised", 401, say("This needs a key"))
TWO_KEYS = ProblemType("two-keys", 400, say("The request shows two different keys"))
FORBIDDEN = ProblemType("forbidden", 403, say("The key does not allow this"))
NOT_REVEALED = ProblemType("not-revealed", 403, say("Right answers are not shown here"))
CROSS_ORIGIN = ProblemType(
    "cross-origin", 403, say("A page of another origin may not change robots")
)
MALFORMED_HOST = ProblemType("malformed-host", 400, say("The request does not say whom it calls"))
MISDIRECTED = ProblemType("misdirected", 421, say("The service does not go by this name"))
TOO_MANY = ProblemType("too-many-requests", 429, say("Too many requests"))
NOT_FOUND = ProblemType("not-found", 404, say("There is nothing here"))
METHOD_NOT_ALLOWED = ProblemType("method-not-allowed", 405, say("The method is not possible here"))
# Of requests that no route sees, since they are not read as a whole:
UNREADABLE = ProblemType("malformed-request", 400, say("The request cannot be read"))
TOO_SLOW = ProblemType("request-timeout", 408, say("The request took too long to arrive"))
HEAD_TOO_LARGE = ProblemType("head-too-large", 431, say("The head of the request is too large"))

GENERIC_TYPES = (
    INVALID_REQUEST,
    MALFORMED_BODY,
    UNSUPPORTED_TYPE,
    NOT_ACCEPTABLE,
    TOO_LARGE,
    TOO_LONG,
    NOT_FOUND,
    METHOD_NOT_ALLOWED,
    INTERNAL,
    STOPPING,
    UNAUTHORISED,
    TWO_KEYS,
    FORBIDDEN,
    NOT_REVEALED,
    CROSS_ORIGIN,
    MALFORMED_HOST,
    MISDIRECTED,
    TOO_MANY,
    BUSY,
    UNREADABLE,
    TOO_SLOW,
    HEAD_TOO_LARGE,
)
"""Types of problems that no exception of a package below stands for."""


def problem_response(
    request: Request,
    type_: ProblemType,
    entries: Sequence[ErrorEntry],
    headers: Mapping[str, str] | None = None,
) -> Response:
    """A problem document: at most ten errors and 4 kB, no control characters.

    As text where the request asks for text, so that a terminal shows a sentence.
    """
    spoken = language_of(request)
    title = spoken.text(type_.title)
    errors: list[dict[str, Any]] = [_entry(entry, spoken) for entry in entries[:MAX_ERRORS]]
    detail = errors[0]["message"] if errors else title
    if len(entries) > 1:
        detail = spoken.text(
            say(
                "{message}{suffix}",
                message=detail,
                suffix=say(" (and {more} more)", more=len(entries) - 1),
            )
        )
    body: dict[str, Any] = {
        "type": f"{request.scope.get('root_path', '')}/problems/{type_.slug}",
        "title": title,
        "status": type_.status,
        "detail": detail,
        "errors": errors,
        **({"more_errors": len(entries) - len(errors)} if len(entries) > len(errors) else {}),
        "request_id": request.scope.get("state", {}).get("request_id", ""),
    }
    as_text = _wants_text(request)

    def written(body: Mapping[str, Any]) -> bytes:
        return _write_text(body, spoken) if as_text else orjson.dumps(body)

    content = written(body)
    while len(content) > MAX_BYTES and len(errors) > 1:
        errors.pop()
        body["more_errors"] = len(entries) - len(errors)
        content = written(body)
    media_type = "text/plain; charset=utf-8" if as_text else MEDIA_TYPE
    return Response(content, type_.status, language_headers(spoken, headers), media_type)


def _wants_text(request: Request) -> bool:
    if request.scope.get("query_string"):
        named = request.query_params.get("format")
        if named is not None:
            return named == "text"
    return request.headers.get("accept", "").lower().lstrip().startswith("text/plain")


def _write_text(body: Mapping[str, Any], spoken: Language) -> bytes:
    """``422 The request cannot be used``, then what is wrong and where."""
    lines = [f"{body['status']} {body['title']}"]
    for error in body["errors"]:
        line = spoken.text(say("line {line}", line=error["line"])) if "line" in error else ""
        places = [error["pointer"], line]
        place = ", ".join(place for place in places if place)
        lines.append(f"  {place}: {error['message']}" if place else f"  {error['message']}")
    if "more_errors" in body:
        lines.append(f"  … +{body['more_errors']}")
    lines.append(f"request_id: {body['request_id']}")
    return ("\n".join(lines) + "\n").encode()


def _entry(entry: ErrorEntry, spoken: Language) -> dict[str, Any]:
    shown: dict[str, Any] = {
        "pointer": _pointer(entry.pointer),
        "message": _told(entry.message, spoken),
    }
    if entry.line is not None:
        shown["line"] = entry.line
    if entry.xpath:
        shown["xpath"] = _shown(entry.xpath, MAX_XPATH)
    return shown


def _told(message: str, spoken: Language) -> str:
    most = MAX_MESSAGE if spoken.is_source else MAX_TRANSLATED
    return _shown(spoken.text(message), most)


def _shown(message: str, most: int = MAX_MESSAGE) -> str:
    text = _UNSAFE.sub(" ", message.encode("utf-8", "replace").decode())
    return text if len(text) <= most else text[: most - 1] + "…"


def _pointer(pointer: str) -> str:
    """Cut without leaving half of an escape."""
    return _shown(pointer)[:200].removesuffix("~")
