"""``/guide``: every page rendered once, held in memory, served with an entity tag."""

from __future__ import annotations

import gzip
import hashlib
from dataclasses import dataclass
from importlib.resources import files

from fastapi import FastAPI, Request, Response
from starlette.exceptions import HTTPException

from app.guide.document import Entry, Menu, document
from app.guide.rendering import RenderedPage, headings_of, render_page, title_of
from app.guide.sources import INDEX, PAGES, PICTURES, source_root
from app.http.negotiation import HTML, TEXT, wanted_type
from app.labs.sources import student_addresses
from app.page import TYPES, PageFile

STYLESHEET = "guide.css"
POLICY = "; ".join(
    (
        "default-src 'none'",
        "style-src 'self'",
        "img-src 'self' data:",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
"""No script at all, and nothing from other hosts."""


@dataclass(frozen=True)
class GuidePage:
    """One page, as HTML and as the Markdown that it was made from."""

    html: PageFile
    markdown: PageFile

    def answer(self, request: Request) -> Response:
        """Return the page in the form that the request asks for, or 304.

        Raises:
            RequestProblem: Neither HTML nor text is acceptable.
        """
        wanted = self.html if wanted_type(request, HTML, TEXT) == HTML else self.markdown
        headers = {
            "Cache-Control": "no-cache",
            "Vary": "Accept, Accept-Encoding",
            "Content-Security-Policy": POLICY,
        }
        return wanted.answer(request, headers)


@dataclass(frozen=True)
class Guide:
    """The whole guide.

    Attributes:
        index: The page at ``/guide``.
        pages: The pages below it, by the last part of their path.
        files: Stylesheet and pictures, likewise.
    """

    index: GuidePage
    pages: dict[str, GuidePage]
    files: dict[str, PageFile]


def load_guide() -> Guide:
    """Render every page.

    Raises:
        FileNotFoundError: The package was built without the pages.
    """
    root = source_root()
    texts = {path: root.joinpath(path).read_text("utf-8") for path in (INDEX, *PAGES.values())}
    menu = {name: title_of(headings_of(texts[path])) for name, path in PAGES.items()}

    def page(path: str, name: str) -> GuidePage:
        # Links are relative, so that they hold under any prefix of a reverse proxy.
        below, above = ("guide/", "") if path == INDEX else ("", "../")
        served = {source: below + name for name, source in (PAGES | PICTURES).items()}
        served[INDEX] = f"{above}guide"
        served |= {file: above + address for file, address in student_addresses().items()}
        rendered = render_page(texts[path], path, served)
        html = _document(rendered, name, menu, below, above)
        return GuidePage(
            page_file(html.encode(), TYPES[".html"]),
            page_file(texts[path].encode(), f"{TEXT}; charset=utf-8"),
        )

    pictures = {
        name: page_file(root.joinpath(path).read_bytes(), TYPES["." + name.rpartition(".")[2]])
        for name, path in PICTURES.items()
    }
    style = (files("app.guide") / STYLESHEET).read_bytes()
    return Guide(
        page(INDEX, ""),
        {name: page(path, name) for name, path in PAGES.items()},
        {**pictures, STYLESHEET: page_file(style, TYPES[".css"])},
    )


def page_file(content: bytes, kind: str) -> PageFile:
    """Return a file that is held in memory, with its entity tag."""
    forms = {"identity": content}
    if kind != TYPES[".png"]:
        forms["gzip"] = gzip.compress(content, mtime=0)
    return PageFile(kind, hashlib.sha256(content).hexdigest()[:32], forms)


def _document(page: RenderedPage, name: str, menu: dict[str, str], below: str, above: str) -> str:
    """Return a whole HTML document: menu, contents of the page, body."""
    pages = [Entry(f"{above}guide", "Guide", current=not name)]
    pages += [Entry(below + one, title, current=one == name) for one, title in menu.items()]
    service = (
        Entry(f"{above}labs/en", "Labs"),
        Entry(above or "./", "The page"),
        Entry(f"{above}docs", "API docs"),
    )
    menus = (Menu("Guide", pages), Menu("Service", service))
    return document(page, menus, (below + STYLESHEET,))


def install(app: FastAPI, guide: Guide) -> None:
    """Add ``/guide`` and what is below it."""

    @app.get("/guide", include_in_schema=False)
    async def index(request: Request) -> Response:
        return guide.index.answer(request)

    @app.get("/guide/{name}", include_in_schema=False)
    async def page(request: Request, name: str) -> Response:
        found = guide.pages.get(name)
        if found is not None:
            return found.answer(request)
        file = guide.files.get(name)
        if file is None:
            raise HTTPException(404)
        return file.answer(request, {"Cache-Control": "no-cache", "Vary": "Accept-Encoding"})
