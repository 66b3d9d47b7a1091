"""The page: what ``hatch_build.py`` made of ``web/``, held in memory and served at ``/``."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable

from fastapi import FastAPI, Request, Response
from starlette.exceptions import HTTPException

from app.http.negotiation import HTML

TYPES = {
    ".html": f"{HTML}; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".json": "application/json",
    ".png": "image/png",
    ".woff2": "font/woff2",
}
ENCODINGS = (("br", ".br"), ("gzip", ".gz"))
POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data: blob:",
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'self'",
    )
)
"""Nothing from other hosts, and no script or style but those of the service's own files."""


@dataclass(frozen=True)
class PageFile:
    """One file of the page.

    Attributes:
        kind: Its Content-Type.
        tag: Strong entity tag of the plain form.
        forms: Bytes by content coding; ``identity`` is always there.
    """

    kind: str
    tag: str
    forms: dict[str, bytes]

    def answer(self, request: Request, headers: dict[str, str]) -> Response:
        """The file in the best coding that the client takes, or 304."""
        accepted = request.headers.get("accept-encoding", "").lower()
        taken = {
            name.strip()
            for name, _, weight in (part.partition(";") for part in accepted.split(","))
            if weight.replace(" ", "") not in ("q=0", "q=0.0")
        }
        coding = next((name for name, _ in ENCODINGS if name in taken & set(self.forms)), None)
        tag = f'"{self.tag}-{coding or "identity"}"'
        sent = {**headers, "ETag": tag}
        if tag in {one.strip() for one in request.headers.get("if-none-match", "").split(",")}:
            return Response(status_code=304, headers=sent)
        if coding:
            sent["Content-Encoding"] = coding
        body = self.forms[coding or "identity"]
        return Response(body, headers=sent, media_type=self.kind)


class Page:
    """All files of the page, by path; none where it has not been built."""

    def __init__(self, folder: Traversable) -> None:
        self.files = dict(_read(folder, "")) if folder.is_dir() else {}

    @property
    def is_built(self) -> bool:
        """Whether there is a page to show."""
        return "index.html" in self.files

    def index(self, request: Request) -> Response:
        """The page itself, asked for anew each time: the names of its parts change with them."""
        headers = {
            "Cache-Control": "no-cache",
            "Vary": "Accept, Accept-Encoding",
            "Content-Security-Policy": POLICY,
            "Referrer-Policy": "no-referrer",
        }
        return self.files["index.html"].answer(request, headers)

    def asset(self, request: Request, name: str) -> Response | None:
        """A part of the page; its name has its hash, so it never changes."""
        found = self.files.get(f"assets/{name}")
        headers = {"Cache-Control": "public, max-age=31536000, immutable"}
        if found is None:
            return None
        return found.answer(request, {**headers, "Vary": "Accept-Encoding"})


def _read(folder: Traversable, prefix: str) -> list[tuple[str, PageFile]]:
    found: list[tuple[str, PageFile]] = []
    entries = {entry.name: entry for entry in folder.iterdir()}
    for name, entry in sorted(entries.items()):
        if entry.is_dir():
            found += _read(entry, f"{prefix}{name}/")
            continue
        kind = TYPES.get("." + name.rpartition(".")[2])
        if kind is None or name.startswith("."):
            continue
        forms = {"identity": entry.read_bytes()}
        for coding, suffix in ENCODINGS:
            if name + suffix in entries:
                forms[coding] = entries[name + suffix].read_bytes()
        tag = hashlib.sha256(forms["identity"]).hexdigest()[:32]
        found.append((prefix + name, PageFile(kind, tag, forms)))
    return found


def load_page() -> Page:
    """The page that was built into the package."""
    return Page(files("app") / "static")


def install(app: FastAPI, page: Page) -> None:
    """Adds ``/assets``, the page's parts."""

    @app.api_route("/assets/{name}", methods=["GET", "HEAD"], include_in_schema=False)
    async def asset(request: Request, name: str) -> Response:
        found = page.asset(request, name)
        if found is None:
            raise HTTPException(404)
        return found
