"""Media types: of a body, and of the answer that a request asks for."""

from __future__ import annotations

from fastapi import Request

from app.http.problems import (
    INVALID_REQUEST,
    NOT_ACCEPTABLE,
    UNSUPPORTED_TYPE,
    RequestProblem,
)
from app.http.ranges import accepted_ranges
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.writer import TABLE_TEXTS

JSON = "application/json"

NPY = "application/x-npy"

TEXT = "text/plain"

HTML = "text/html"

NDJSON = "application/x-ndjson"

YAML = "application/yaml"

CSV = "text/csv"

SVG = "image/svg+xml"

PNG = "image/png"

LATEX = TABLE_TEXTS["latex"].media_type

PYTHON_SOURCE = "text/x-python"

C_SOURCE = "text/x-c"

MATLAB_SOURCE = TABLE_TEXTS["matlab"].media_type

FORMATS = {
    "json": JSON,
    "text": TEXT,
    "html": HTML,
    "npy": NPY,
    "ndjson": NDJSON,
    "yaml": YAML,
    "csv": CSV,
    "svg": SVG,
    "png": PNG,
    "python": PYTHON_SOURCE,
    "c": C_SOURCE,
} | {name: form.media_type for name, form in TABLE_TEXTS.items()}
"""Names of media types in ``?format=``."""


def media_type(request: Request) -> str:
    """The body's media type in lower case, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


def wanted_type(request: Request, *offers: str) -> str:
    """The form of the answer: ``?format=`` if given, else the best of the Accept header.

    Raises:
        RequestProblem: 406, neither names an offer.
    """
    named = request.query_params.get("format") if request.scope["query_string"] else None
    if named is not None:
        wanted = FORMATS.get(named)
        if wanted not in offers:
            choices = ", ".join(key for key, value in FORMATS.items() if value in offers)
            raise RequestProblem(
                INVALID_REQUEST,
                say(
                    "format is {named!r}; give one of {choices}", named=named[:32], choices=choices
                ),
                "/format",
            )
        return wanted
    accept = request.headers.get("accept", "*/*")
    if accept in ("*/*", offers[0]):
        return offers[0]
    ranges = accepted_ranges(",".join(request.headers.getlist("accept")))
    best: tuple[float, int] | None = None
    chosen = None
    for offer in offers:
        kind = offer.partition("/")[0]
        # The most specific range that fits an offer says how much it is wanted.
        found = next((ranges[n] for n in (offer, f"{kind}/*", "*/*") if n in ranges), None)
        if found is not None and found[0] < 0 and (best is None or found < best):
            best, chosen = found, offer
    if chosen is None:
        raise RequestProblem(
            NOT_ACCEPTABLE, say("this answer is available as {offers}", offers=", ".join(offers))
        )
    return chosen


def require_type(request: Request, *accepted: str) -> str:
    """The body's media type, if it is one of those accepted.

    Raises:
        RequestProblem: 415, with what to write.
    """
    given = media_type(request)
    if given in accepted:
        return given
    raise unsupported(given, accepted)


def unsupported(given: str, accepted: tuple[str, ...]) -> RequestProblem:
    """415 that teaches ``curl --json`` to those who used ``curl -d``."""
    listed = ", ".join(accepted)
    if given in ("", "application/x-www-form-urlencoded"):
        detail = say(
            "the body has no JSON content type; with curl write --json '{{…}}'"
            " instead of -d, or add -H 'Content-Type: {accepted}' (read here:"
            " {listed})",
            accepted=accepted[0],
            listed=listed,
        )
    else:
        detail = say(
            "a body of type {given!r} is not read here; send {listed}",
            given=given[:64],
            listed=listed,
        )
    return RequestProblem(UNSUPPORTED_TYPE, detail, headers={"Accept": listed})
