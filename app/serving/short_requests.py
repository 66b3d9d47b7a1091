"""Short computations, answered where their bytes arrive: without a task, and each layer once.

It is made of the pieces of the ordinary way: names of hosts, ids, decoding, the computation, its
writer, headers, records. What is unusual goes the ordinary way from its first step, and so does
every error, of which that way says what is wrong: a header that is not among the plain ones, keys,
counted requests, pages of other origins, traces, robots that are not in memory, batches.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from time import perf_counter
from typing import TYPE_CHECKING, cast

from fastapi import Request

from app.access.headers import SafeHeaders
from app.access.hosts import AllowedHosts, allowed_hosts
from app.access.wiring import is_open
from app.http.compression import needs_coding
from app.http.negotiation import NDJSON
from app.http.problems import RequestProblem
from app.middleware.request_id import RequestIds
from app.operations.operation import Runs
from app.routes.compute import INLINE_BYTES, Computation, Form, Terms, form_of
from app.telemetry.lines import REQUEST_ID
from app.telemetry.observed import Client, Records
from app.telemetry.tracing import asked_for

if TYPE_CHECKING:
    from starlette.types import Receive, Scope, Send
    from uvicorn._types import HTTPScope

    from app.dependencies import Services

PLAIN = frozenset(
    (
        *(b"accept", b"accept-encoding", b"accept-language", b"cache-control", b"connection"),
        *(b"content-length", b"content-type", b"cookie", b"dnt", b"host", b"origin", b"pragma"),
        *(b"priority", b"referer", b"sec-ch-ua", b"sec-ch-ua-mobile", b"sec-ch-ua-platform"),
        *(b"sec-fetch-dest", b"sec-fetch-mode", b"sec-fetch-site", b"user-agent"),
        b"x-request-id",
    )
)
"""Headers that are known to be looked at by the pieces here, or by none."""
ONCE = (b"accept", b"accept-language", b"content-length", b"content-type", b"host")
"""Of which two in one request would be looked at by the ordinary way."""
OK = 200


HEADS = 512
HEAD_BYTES = 2_048
"""Heads that are remembered, and the longest of them: a megabyte at most."""


@dataclass(frozen=True, slots=True)
class ShortRequest:
    """What the head of a request says that may be answered at once.

    Attributes:
        method: POST or GET.
        computation: What it asks for.
        route: The template of its path.
        robot_id: Of which robot.
        terms: What it asks for besides.
        form: The form of its answer.
        length: Bytes of its body.
        given_id: Its own ``X-Request-ID``; empty where there is none.
    """

    method: str
    computation: Computation
    route: str
    robot_id: str
    terms: Terms
    form: Form
    length: int
    given_id: bytes


@dataclass(frozen=True, slots=True)
class ShortAnswer:
    """An answer with status 200.

    Attributes:
        head: Its header lines.
        body: Its body.
        request_id: The id that it names.
    """

    head: bytes
    body: bytes
    request_id: str


class Declined(Enum):
    """Why a request goes the ordinary way after all."""

    ERROR = "error"
    LONGER = "longer"
    """It is known to take longer than microseconds."""


class ShortRequests:
    """Answers short computations of one application.

    Args:
        services: Those of the application.
        computations: What may be asked for, by name.
        records: What is kept of each request.
        ids: Ids of requests.
    """

    def __init__(
        self,
        services: Services,
        computations: Mapping[str, Computation],
        records: Records,
        ids: RequestIds,
    ) -> None:
        self.services = services
        self._computations = {
            name: (one, f"/v1/robots/{{robot_id}}/{name}")
            for name, one in computations.items()
            if one.operation.runs is Runs.EVENT_LOOP
        }
        self._records = records
        self._ids = ids
        settings = services.settings
        self._hosts = AllowedHosts(_never, allowed_hosts(settings))
        self._safe = SafeHeaders(_never, private=False)
        self._root = settings.root_path.rstrip("/")
        self._head = lru_cache(maxsize=256)(self._head_of)
        self._known: dict[bytes, ShortRequest] = {}

    def known(self, data: bytes) -> tuple[ShortRequest, bytes] | None:
        """Return what was found of the head that data begins with, and the body behind it.

        A client sends the same head again and again, of which a parser makes the same each time.
        None where this head is not remembered, or data is not one whole request.
        """
        end = data.find(b"\r\n\r\n") + 4
        found = self._known.get(data[:end])
        if found is None or len(data) - end != found.length:
            return None
        return found, data[end:]

    def remember(self, data: bytes, asked: ShortRequest, body: bytes) -> None:
        """Remember the head that data begins with.

        Args:
            data: What has come since the end of the request before.
            asked: What :meth:`find` has found of it.
            body: The body that the parser has found of it.
        """
        end = data.find(b"\r\n\r\n") + 4
        if end > HEAD_BYTES or asked.given_id or data[end:] != body or len(body) != asked.length:
            return
        if len(self._known) >= HEADS:
            self._known.clear()
        self._known[data[:end]] = asked

    def find(self, http_scope: HTTPScope) -> ShortRequest | None:
        """Return a request that may be answered here, by its head; None: it goes the other way."""
        scope: Scope = cast("Scope", http_scope)
        path = scope["path"]
        if self._root:
            path = path.removeprefix(self._root)
        # /v1/robots/{id}/{name}; names of some computations have a slash of their own.
        parts = path.split("/", 4)
        if len(parts) != 5 or parts[2] != "robots" or parts[1] != "v1" or parts[0]:
            return None
        found = self._computations.get(parts[4])
        if found is None or len(scope["query_string"]) > INLINE_BYTES:
            return None
        method = scope["method"]
        headers: dict[bytes, bytes] = {}
        for name, value in scope["headers"]:
            if name not in PLAIN or (name in headers and name in ONCE):
                return None
            headers.setdefault(name, value)
        if not self._hosts.allows(headers.get(b"host", b"")):
            return None
        length, kind = headers.get(b"content-length"), headers.get(b"content-type")
        if method == "POST":
            if kind != b"application/json" or length is None or not length.isdigit():
                return None
            if len(length) > 4 or int(length) > INLINE_BYTES:
                return None
        elif method != "GET" or length is not None or kind is not None:
            return None
        request, (computation, route) = Request(scope), found
        try:
            terms = computation.terms(request, by_query=method == "GET")
            form = form_of(request, terms.wanted)
        except RequestProblem:  # the ordinary way meets it again, and says what is wrong
            return None
        if terms.wanted == NDJSON or needs_coding(request):
            return None
        given = headers.get(b"x-request-id", b"")
        size = 0 if length is None else int(length)
        return ShortRequest(method, computation, route, parts[3], terms, form, size, given)

    def answer(self, asked: ShortRequest, body: bytes) -> ShortAnswer | Declined:
        """Return the answer, or why it goes the ordinary way after all.

        Args:
            asked: What :meth:`find` has found.
            body: The whole body.
        """
        stored = self.services.store.in_memory(asked.robot_id)
        if stored is None:
            return Declined.ERROR
        request_id = self._ids.of(asked.given_id)
        token = REQUEST_ID.set(request_id)
        try:
            read = body if asked.method == "POST" else None
            written = asked.computation.at_once(
                asked.terms, asked.form, stored, self.services, read
            )
        except Exception:  # the ordinary way meets it again, says what is wrong, and logs it
            return Declined.ERROR
        finally:
            REQUEST_ID.reset(token)
        if written is None:
            return Declined.LONGER
        head = b"content-length: %d\r\nx-request-id: %b\r\n%b" % (
            len(written.body),
            request_id.encode("ascii"),
            self._head(written.head),
        )
        return ShortAnswer(head, written.body, request_id)

    def await_body(self, change: int) -> None:
        """Count a request as in progress whose body is awaited, 1, or not any more, -1."""
        if self._records.metrics is not None:
            self._records.metrics.in_progress.inc(change)

    def keep(
        self, asked: ShortRequest, answer: ShortAnswer, begun: float, client: Client | None
    ) -> None:
        """Count a request that has been answered here, and write its line.

        Args:
            asked: The request.
            answer: Its answer.
            begun: When it came, as ``perf_counter`` tells.
            client: Address and port of the client.
        """
        seconds = perf_counter() - begun
        told = asked.method, asked.route, OK, seconds, len(answer.body)
        self._records.keep_soon(*told, client, answer.request_id)

    def _head_of(self, headers: tuple[tuple[bytes, bytes], ...]) -> bytes:
        """Return header lines; those of the service, which are not checked by the server here."""
        lines = [b"%b: %b" % one for one in self._safe.completed(headers)]
        if any(b"\r" in line or b"\n" in line for line in lines):
            raise ValueError("a header has a line break")
        return b"".join(line + b"\r\n" for line in lines)


def short_requests(
    services: Services,
    computations: Mapping[str, Computation],
    records: Records,
    ids: RequestIds,
) -> ShortRequests | None:
    """Return what answers short computations, None where every request goes the ordinary way.

    That is where something is done for each request besides: keys and rates are looked at, pages
    of other origins answered, traces kept.
    """
    if asked_for() or not is_open(services.settings):
        return None
    return ShortRequests(services, computations, records, ids)


async def _never(scope: Scope, receive: Receive, send: Send) -> None:
    raise NotImplementedError
