"""The page: what ``hatch_build.py`` made of ``web/``, held in memory and served at ``/``.

It may come, or change, while the service runs: ``make run`` builds it beside.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

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
        "frame-ancestors 'none'",
    )
)
"""Nothing from other hosts, and no script or style but those of the service's own files."""
WAITING = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta http-equiv="refresh" content="2">
<title>Denavit</title>
<h1>Denavit</h1>
<p>The page is not built yet. After <code>make run</code> it is being built, and comes here by
itself within a minute; <code>python hatch_build.py</code> builds it by hand.</p>
<p>The API answers already: <a href="docs">docs</a>, <a href="v1/robots">robots</a>,
<a href="v1/robots/puma560/fk?q=0,45,-90,0,45,0&amp;angle=deg&amp;format=text">a first pose</a>.</p>
"""


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
    """All files of the page, by path; none where it has not been built.

    Args:
        folder: Where it is built, in one piece.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._built: tuple[int, int] | None = None
        self.files: dict[str, PageFile] = {}
        self.refresh()

    @property
    def is_built(self) -> bool:
        """Whether there is a page to show."""
        return "index.html" in self.files

    def refresh(self) -> None:
        """Read the page where it was built since it was last read."""
        built = self._moment()
        if built is None or built == self._built:
            return
        try:
            found = dict(_read(self._folder, ""))
        except FileNotFoundError:  # yet another is put in its place
            return
        if built == self._moment():
            self._built, self.files = built, found

    def _moment(self) -> tuple[int, int] | None:
        try:
            status = (self._folder / "index.html").stat()
        except OSError:
            return None
        return status.st_ino, status.st_mtime_ns

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
        if f"assets/{name}" not in self.files:
            self.refresh()
        found = self.files.get(f"assets/{name}")
        headers = {"Cache-Control": "public, max-age=31536000, immutable"}
        if found is None:
            return None
        return found.answer(request, {**headers, "Vary": "Accept-Encoding"})


def waiting() -> Response:
    """What a browser shows in the place of a page that is not built yet, and asks for anew."""
    headers = {"Cache-Control": "no-store", "Vary": "Accept", "Content-Security-Policy": POLICY}
    return Response(WAITING, headers=headers, media_type=f"{HTML}; charset=utf-8")


def _read(folder: Path, prefix: str) -> list[tuple[str, PageFile]]:
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
    return Page(Path(__file__).parent / "static")


def install(app: FastAPI, page: Page) -> None:
    """Adds ``/assets``, the page's parts."""

    @app.api_route("/assets/{name}", methods=["GET", "HEAD"], include_in_schema=False)
    async def asset(request: Request, name: str) -> Response:
        found = page.asset(request, name)
        if found is None:
            raise HTTPException(404)
        return found
