"""What is recorded of a request: what was sent, what came back, and where both are kept."""

from __future__ import annotations

import base64
import json
import lzma
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.torture.exchange import Sent

FOLDER = Path(__file__).parent
REQUESTS = FOLDER / "requests.ndjson.xz"
OPENAPI = FOLDER / "openapi.json.xz"
ROBOTS = FOLDER / "robots.json.xz"
FILTERS = [{"id": lzma.FILTER_LZMA2, "preset": 9, "dict_size": 1 << 26}]
SETUP = "setup"
"""Operation of the requests that others rest on: they are sent whatever is chosen."""
MINE = "recorded-"
"""What the ids of all robots that are stored by the recorded requests begin with."""


@dataclass(frozen=True)
class Asked:
    """A request.

    Attributes:
        operation: Last part of the path of a computation, or a group of other routes.
        kind: What is tried, such as ``form`` or ``refused field``.
        sent: The request. ``{etag:PATH}`` in a header stands for the ETag last seen at a path.
    """

    operation: str
    kind: str
    sent: Sent


@dataclass(frozen=True)
class Answer:
    """What came back, normalised.

    Attributes:
        status: The status.
        headers: All that matter, by lower-case name.
        text: The body; None where it is kept as a digest.
        digest: Of a body that is long or no text.
    """

    status: int
    headers: dict[str, str]
    text: str | None = None
    digest: dict[str, Any] | None = None


@dataclass(frozen=True)
class Recorded:
    """A request and its answer."""

    asked: Asked
    answer: Answer


def written(records: Iterable[Recorded]) -> bytes:
    """The records as compressed lines; the same records give the same bytes."""
    lines = [json.dumps(_line(one), ensure_ascii=False, separators=(",", ":")) for one in records]
    text = "".join(f"{line}\n" for line in lines)
    return compressed(text.encode("utf-8", "surrogatepass"))


def compressed(content: bytes) -> bytes:
    """Content as xz, without a time or a name."""
    return lzma.compress(content, format=lzma.FORMAT_XZ, filters=FILTERS)


def records(path: Path = REQUESTS) -> Iterator[Recorded]:
    """The records of a file, in order."""
    text = lzma.decompress(path.read_bytes()).decode("utf-8", "surrogatepass")
    for line in text.split("\n")[:-1]:
        yield _record(json.loads(line))


def _line(one: Recorded) -> dict[str, Any]:
    sent, answer = one.asked.sent, one.answer
    line: dict[str, Any] = {
        "operation": one.asked.operation,
        "kind": one.asked.kind,
        "what": sent.what,
        "method": sent.method,
        "path": sent.path,
        "query": sent.query,
        "headers": [list(pair) for pair in sent.headers],
        **_body(sent.body),
        "status": answer.status,
        "answer_headers": answer.headers,
        "answer": answer.text,
        "digest": answer.digest,
    }
    return {name: value for name, value in line.items() if value not in (None, "", [], {})}


def _body(body: bytes | None) -> dict[str, str]:
    if body is None:
        return {}
    try:
        return {"body": body.decode()} if body else {"base64": "="}
    except UnicodeDecodeError:
        return {"base64": base64.b64encode(body).decode()}


def _record(line: dict[str, Any]) -> Recorded:
    body = line["body"].encode() if "body" in line else None
    if "base64" in line:
        body = b"" if line["base64"] == "=" else base64.b64decode(line["base64"])
    headers = tuple((name, value) for name, value in line.get("headers", ()))
    sent = Sent(
        line["method"],
        line["path"],
        line.get("query", ""),
        headers,
        body,
        what=line.get("what", ""),
    )
    text = line.get("answer", None if "digest" in line else "")
    answer = Answer(line["status"], line.get("answer_headers", {}), text, line.get("digest"))
    return Recorded(Asked(line["operation"], line["kind"], sent), answer)
