"""Bytes on a connection that are no request, half of one, or more than one."""

from __future__ import annotations

import socket
import time
from dataclasses import dataclass

HEAD = b"Host: denavit\r\n"
LIVE = b"GET /health/live HTTP/1.1\r\n" + HEAD
FK = b"POST /v1/robots/planar_2r/fk HTTP/1.1\r\n" + HEAD + b"Content-Type: application/json\r\n"
UPGRADE = b"Upgrade: h2c\r\nConnection: Upgrade, HTTP2-Settings\r\nHTTP2-Settings: AAMAAABk\r\n"
BODY = b'{"q": [0, 0]}'
WHOLE = FK + b"Content-Length: 13\r\n\r\n" + BODY
CHUNKED = FK + b"Transfer-Encoding: chunked\r\n\r\n"
PUT = b"PUT /v1/robots/corpus-wire HTTP/1.1\r\n" + HEAD + b"Content-Type: application/json\r\n"
CLOSED = 0
"""Stands for a connection that is closed without an answer, where none can be expected."""
NONE_IS_READ = (400,)


@dataclass(frozen=True)
class Wire:
    """What is sent on one connection, and the statuses of the answers, one after the other.

    Attributes:
        name: What is tried.
        parts: Pieces, with a pause after each.
        answers: For each answer, the statuses that are right.
        end: Whether the client says that it sends no more.
    """

    name: str
    parts: tuple[bytes, ...]
    answers: tuple[tuple[int, ...], ...]
    end: bool = False


def one(name: str, sent: bytes, *statuses: int, end: bool = False) -> Wire:
    """A case that has one answer."""
    return Wire(name, (sent,), (statuses or NONE_IS_READ,), end)


def chunks(*parts: bytes) -> bytes:
    return CHUNKED + b"".join(b"%x\r\n%s\r\n" % (len(part), part) for part in (*parts, b""))


CASES = (
    # What is no HTTP.
    one("TLS", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(200)),
    one("SSH", b"SSH-2.0-OpenSSH_9.0\r\n"),
    one("SMTP", b"EHLO denavit\r\n"),
    one("HTTP/2", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
    one("HTTP/0.9", b"GET /health/live\r\n\r\n", 200, 400),
    one("HTTP/3.0", b"GET /health/live HTTP/3.0\r\n" + HEAD + b"\r\n"),
    one("HTTP/1.2", b"GET /health/live HTTP/1.2\r\n" + HEAD + b"\r\n"),
    one("HTTQ", b"GET /health/live HTTQ/1.1\r\n" + HEAD + b"\r\n"),
    one("zeros", bytes(5000)),
    one("all bytes", bytes(range(256)) * 8),
    one("a proxy's line", b"PROXY TCP4 1.2.3.4 5.6.7.8 1 2\r\n" + LIVE + b"\r\n"),
    # The request line.
    one("an unknown method", b"GRAB /health/live HTTP/1.1\r\n" + HEAD + b"\r\n", 400, 405),
    one("a method in small letters", b"get /health/live HTTP/1.1\r\n" + HEAD + b"\r\n", 400, 405),
    one("no target", b"GET HTTP/1.1\r\n" + HEAD + b"\r\n"),
    one("two blanks", b"GET  /health/live HTTP/1.1\r\n" + HEAD + b"\r\n", 400, 200),
    one("a tab", b"GET\t/health/live\tHTTP/1.1\r\n" + HEAD + b"\r\n"),
    one("NUL in the target", b"GET /health/\0live HTTP/1.1\r\n" + HEAD + b"\r\n"),
    one("raw bytes in the target", b"GET /v1/\xff\xfe HTTP/1.1\r\n" + HEAD + b"\r\n", 400, 404),
    one("a degree sign", "GET /v1/robots/ur5/fk?q=90° HTTP/1.1\r\n".encode() + HEAD + b"\r\n"),
    one("a fragment", b"GET /health/live#x HTTP/1.1\r\n" + HEAD + b"\r\n", 200, 400, 404),
    one(
        "an absolute target",
        b"GET http://denavit/health/live HTTP/1.1\r\n" + HEAD + b"\r\n",
        200,
        400,
        404,
    ),
    one(
        "another's target", b"GET http://evil.example/ HTTP/1.1\r\n" + HEAD + b"\r\n", 200, 400, 404
    ),
    one("a star", b"OPTIONS * HTTP/1.1\r\n" + HEAD + b"\r\n", 200, 204, 400, 404),
    one("connect", b"CONNECT evil.example:443 HTTP/1.1\r\n" + HEAD + b"\r\n", 400, 404, 405),
    one("a relative target", b"GET health/live HTTP/1.1\r\n" + HEAD + b"\r\n", 400, 404),
    one("dots", b"GET /../../etc/passwd HTTP/1.1\r\n" + HEAD + b"\r\n", 400, 404),
    one(
        "a target of 100 kB",
        b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n" + HEAD + b"\r\n",
        431,
        414,
    ),
    one("a target without end", b"GET /" + b"a" * 100_000, 431, 414),
    one(
        "a query of 60 kB",
        b"GET /health/live?" + b"a" * 60_000 + b" HTTP/1.1\r\n" + HEAD + b"\r\n",
        414,
        431,
    ),
    # Headers.
    one("no Host", b"GET /health/live HTTP/1.1\r\n\r\n", 200, 400),
    one("two Hosts", LIVE + b"Host: evil.example\r\n\r\n", 200, 400),
    one(
        "an odd Host",
        b'GET / HTTP/1.1\r\nHost: a b/"<script>\r\nAccept: application/json\r\n\r\n',
        200,
        400,
    ),
    one("a blank before the colon", LIVE + b"X-A : b\r\n\r\n"),
    one("no colon", LIVE + b"X-A\r\n\r\n"),
    one("no name", LIVE + b": b\r\n\r\n"),
    one("a folded header", LIVE + b"X-A: b\r\n c\r\n\r\n", 400, 200),
    one("NUL in a header", LIVE + b"X-A: b\0c\r\n\r\n"),
    one("a bare CR in a header", LIVE + b"X-A: b\rc\r\n\r\n"),
    one("a bare LF in a header", LIVE + b"X-A: b\nX-B: c\r\n\r\n", 400, 200),
    one("bare LFs", b"GET /health/live HTTP/1.1\nHost: x\n\n", 200, 400),
    one("bytes in a name", LIVE + b"X-\xff: b\r\n\r\n"),
    one("200 headers", LIVE + b"X-A: b\r\n" * 200 + b"\r\n", 431),
    one("a header of 100 kB", LIVE + b"X-A: " + b"b" * 100_000 + b"\r\n\r\n", 431),
    one("a header without end", LIVE + b"X-A: " + b"b" * 100_000, 431),
    one("a name of 100 kB", LIVE + b"X-" + b"b" * 100_000, 431),
    one(
        "an upgrade to WebSocket",
        LIVE + b"Upgrade: websocket\r\nConnection: Upgrade\r\n"
        b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n",
        200,
        400,
        403,
        426,
    ),
    one(
        "an upgrade to HTTP/2",
        LIVE + b"Upgrade: h2c\r\nConnection: Upgrade, HTTP2-Settings\r\n"
        b"HTTP2-Settings: AAMAAABk\r\n\r\n",
        200,
        400,
    ),
    one(
        "an unknown expectation",
        FK + b"Expect: 200-ok\r\nContent-Length: 13\r\n\r\n" + BODY,
        200,
        417,
    ),
    # Lengths.
    one("a negative length", FK + b"Content-Length: -1\r\n\r\n"),
    one("a length of words", FK + b"Content-Length: many\r\n\r\n"),
    one("a hexadecimal length", FK + b"Content-Length: 0xd\r\n\r\n" + BODY),
    one("a length with a plus", FK + b"Content-Length: +13\r\n\r\n" + BODY),
    one("a length of two numbers", FK + b"Content-Length: 13, 14\r\n\r\n" + BODY),
    one("two lengths", FK + b"Content-Length: 13\r\nContent-Length: 14\r\n\r\n" + BODY),
    one(
        "the same length twice",
        FK + b"Content-Length: 13\r\nContent-Length: 13\r\n\r\n" + BODY,
        400,
        200,
    ),
    one("a length that overflows", FK + b"Content-Length: 99999999999999999999\r\n\r\n"),
    one("a length of 2^63", FK + b"Content-Length: 9223372036854775808\r\n\r\n", 400, 413),
    one("a length of 9 GB", FK + b"Content-Length: 9000000000\r\n\r\n", 413),
    one("an empty length", FK + b"Content-Length: \r\n\r\n"),
    one(
        "length and chunks",
        FK + b"Content-Length: 13\r\nTransfer-Encoding: chunked\r\n\r\n"
        b"d\r\n" + BODY + b"\r\n0\r\n\r\n",
    ),
    one(
        "chunks and length",
        FK + b"Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n"
        b"0\r\n\r\nGET /admin HTTP/1.1\r\n\r\n",
    ),
    # Codings.
    one(
        "chunked twice",
        FK + b"Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n"
        b"d\r\n" + BODY + b"\r\n0\r\n\r\n",
        400,
        200,
    ),
    one(
        "identity and chunked",
        FK + b"Transfer-Encoding: identity, chunked\r\n\r\nd\r\n" + BODY + b"\r\n0\r\n\r\n",
        400,
        200,
    ),
    one(
        "chunked, then identity",
        FK + b"Transfer-Encoding: chunked, identity\r\n\r\nd\r\n" + BODY + b"\r\n0\r\n\r\n",
    ),
    one(
        "gzip and chunked",
        FK + b"Transfer-Encoding: gzip, chunked\r\n\r\nd\r\n" + BODY + b"\r\n0\r\n\r\n",
        400,
        415,
    ),
    one(
        "an unknown coding",
        FK + b"Transfer-Encoding: xchunked\r\n\r\nd\r\n" + BODY + b"\r\n0\r\n\r\n",
    ),
    one(
        "a coding with a tab",
        FK + b"Transfer-Encoding:\x0bchunked\r\n\r\nd\r\n" + BODY + b"\r\n0\r\n\r\n",
    ),
    one(
        "a coding in HTTP/1.0",
        FK.replace(b"1.1", b"1.0") + b"Transfer-Encoding: chunked\r\n\r\n"
        b"d\r\n" + BODY + b"\r\n0\r\n\r\n",
        400,
        200,
    ),
    # Chunks.
    one("no hexadecimal size", CHUNKED + b"xyz\r\n" + BODY),
    one("a negative size", CHUNKED + b"-1\r\n" + BODY),
    one("a size with 0x", CHUNKED + b"0xd\r\n" + BODY + b"\r\n0\r\n\r\n"),
    one("a size that overflows", CHUNKED + b"fffffffffffffffff\r\n" + BODY),
    one(
        "a size of 16 digits", CHUNKED + b"7fffffffffffffff\r\n" + BODY, 400, 413, CLOSED, end=True
    ),
    one("a chunk longer than its size", CHUNKED + b"3\r\n" + BODY + b"\r\n0\r\n\r\n"),
    one("no line end after a chunk", CHUNKED + b"d\r\n" + BODY + b"0\r\n\r\n"),
    one("an extension of 200 kB", CHUNKED + b"d;" + b"e" * 200_000, 400),
    one(
        "trailers of 200 kB",
        CHUNKED + b"d\r\n" + BODY + b"\r\n0\r\nX-A: " + b"b" * 200_000,
        400,
        431,
        200,
    ),
    # Right ones.
    one("as it should be", WHOLE, 200),
    one("chunks", chunks(BODY[:4], BODY[4:]), 200),
    one("chunks of one byte", chunks(*(BODY[k : k + 1] for k in range(13))), 200),
    one("an extension", CHUNKED + b"d;name=value\r\n" + BODY + b"\r\n0\r\n\r\n", 200),
    one("trailers", CHUNKED + b"d\r\n" + BODY + b"\r\n0\r\nX-A: b\r\n\r\n", 200),
    one("a size in capitals with zeros", CHUNKED + b"000D\r\n" + BODY + b"\r\n0\r\n\r\n", 200),
    one("an offer of HTTP/2 with a body", FK + UPGRADE + b"Content-Length: 13\r\n\r\n" + BODY, 200),
    one("an offer of HTTP/2 with chunks", chunks(BODY).replace(HEAD, HEAD + UPGRADE), 200),
    Wire(
        "an offer of HTTP/2, then the body",
        (FK + UPGRADE + b"Content-Length: 13\r\n", b"\r\n", BODY, WHOLE),
        ((200,), (200,)),
    ),
    Wire(
        "an offer of HTTP/2 inside a body",
        (
            FK
            + UPGRADE
            + b"Content-Length: 70\r\n\r\n"
            + (b'{"q": [0, 0],\r\n\r\n"\\nupgrade:": "\nUpgrade: h2c"').ljust(70),
            WHOLE,
        ),
        ((400, 422), (200,)),
    ),
    one(
        "100-continue", FK + b"Expect: 100-continue\r\nContent-Length: 13\r\n\r\n" + BODY, 100, 200
    ),
    one("HTTP/1.0", b"GET /health/live HTTP/1.0\r\n\r\n", 200),
    one("empty lines before", b"\r\n\r\n" + LIVE + b"\r\n", 200),
    one("GET with a body", LIVE + b"Content-Length: 5\r\n\r\nhello", 200, 400),
    one("half closed", WHOLE, 200, CLOSED, end=True),
    Wire("byte by byte", tuple(WHOLE[k : k + 1] for k in range(len(WHOLE))), ((200,),)),
    Wire("two at once", (WHOLE + WHOLE,), ((200,), (200,))),
    Wire("thirty at once", (WHOLE * 30,), ((200,),) * 30),
    Wire("a bad one after a good one", (WHOLE + b"NONSENSE\r\n\r\n",), ((200,), (400,))),
    Wire(
        "bad ones after ten good ones",
        (WHOLE * 10 + b"\x00\x01\r\n\r\n" * 5,),
        ((200,),) * 10 + ((400,),),
    ),
    Wire(
        "a bad body after good ones",
        (WHOLE * 3 + CHUNKED + b"xyz\r\n" + WHOLE,),
        ((200,),) * 3 + ((400,),),
    ),
    Wire("connect after a good one", (WHOLE + b"CONNECT a:1 HTTP/1.1\r\n\r\n",), ((200,), (400,))),
    Wire(
        "a longer body than said",
        (FK + b"Content-Length: 13\r\n\r\n" + BODY + BODY,),
        ((200,), (400,)),
    ),
    Wire(
        "a request inside a body",
        (
            FK
            + b"Content-Length: 40\r\n\r\n"
            + (b"DELETE /v1/robots/a HTTP/1.1\r\n\r\n" + b" " * 40)[:40]
            + WHOLE,
        ),
        ((400,), (200,)),
    ),
    Wire(
        "a refused one, then a good one",
        (FK + b"Content-Length: 3\r\n\r\nabc" + WHOLE,),
        ((400,), (200,)),
    ),
    Wire(
        "an upload that is cut off",
        (PUT + b'Content-Length: 400\r\n\r\n{"convention": "dh"',),
        ((CLOSED,),),
        end=True,
    ),
    Wire(
        "a chunked upload that is cut off",
        (PUT + b'Transfer-Encoding: chunked\r\n\r\n14\r\n{"convention": "dh",\r\n',),
        ((CLOSED, 400),),
        end=True,
    ),
    Wire(
        "an upload larger than is read",
        (PUT + b"Content-Length: 2100000\r\n\r\n", b" " * 2_100_000),
        ((413,),),
    ),
    Wire("65 at once", (LIVE + b"\r\n",) * 65, ((200,),) * 65),
)


def answers(port: int, case: Wire, patience: float) -> list[bytes]:
    """What comes back on one connection, answer by answer."""
    found: list[bytes] = []
    with socket.create_connection(("127.0.0.1", port), patience) as connection:
        try:
            for part in case.parts:
                connection.sendall(part)
                time.sleep(0.001 if len(case.parts) > 1 else 0.0)
            if case.end:
                connection.shutdown(socket.SHUT_WR)
        except (BrokenPipeError, ConnectionResetError):
            pass  # it may have answered and gone before all was sent
        stream = connection.makefile("rb")
        try:
            while len(found) < len(case.answers) and (head := _head(stream)):
                length = next(
                    (
                        int(line[15:])
                        for line in head.lower().split(b"\r\n")
                        if line.startswith(b"content-length:")
                    ),
                    0,
                )
                found.append(head + stream.read(length))
        except ConnectionResetError:
            pass
    return found


def _head(stream: object) -> bytes:
    lines = []
    while line := stream.readline():  # type: ignore[attr-defined]
        lines.append(line)
        if line == b"\r\n":
            break
    return b"".join(lines)


def wrong_with(case: Wire, found: list[bytes]) -> list[str]:
    """What is wrong with the answers; nothing, where all is well."""
    statuses = [int(raw[9:12]) for raw in found]
    statuses += [CLOSED] * (len(case.answers) - len(found))
    wrong = [
        f"answer {k} is {status}, not {right}"
        for k, (status, right) in enumerate(zip(statuses, case.answers, strict=True))
        if status not in right
    ]
    for raw in found:
        head, _, text = raw.partition(b"\r\n\r\n")
        if int(raw[9:12]) >= 400 and b"application/problem+json" not in head:
            wrong.append(f"is no problem document: {raw[:200]!r}")
        if int(raw[9:12]) >= 400 and len(text) > 4096:
            wrong.append(f"a problem of {len(text)} bytes")
    return [f"{one}; {[raw[:300] for raw in found[:2]]}" for one in wrong]
