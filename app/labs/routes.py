"""``/labs``: the sheets in English and French; ``/labs/teacher``: their solutions."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from html import escape
from importlib.resources import files
from importlib.resources.abc import Traversable
from posixpath import basename, dirname, join, normpath, relpath

from anyio.to_thread import run_sync
from fastapi import FastAPI, Request, Response
from fastapi.responses import RedirectResponse
from starlette.exceptions import HTTPException

from app.access.control import key_of
from app.access.keys import Scope
from app.exercises.texts import LANGUAGES, language_of
from app.guide.document import Entry, Menu, document
from app.guide.rendering import render_page
from app.guide.routes import POLICY, STYLESHEET, page_file
from app.guide.sources import INDEX as GUIDE_INDEX
from app.guide.sources import PAGES as GUIDE_PAGES
from app.guide.sources import source_root
from app.http.negotiation import HTML, TEXT, wanted_type
from app.http.problems import FORBIDDEN, RequestProblem
from app.labs.rendering import sheet_parser
from app.labs.sources import SHEETS, student_addresses, teacher_addresses
from app.labs.words import WORDS
from app.page import TYPES, PageFile

LABS_STYLE = "labs.css"
ADDRESS = "http://localhost:8000"
"""The service in the files; a reader sees the address by which the page was asked for."""
MAX_HELD = 128
"""Pages held in memory: all of them, for a few addresses of the service."""
_WRITTEN = re.compile(r"(?:http://)?localhost:8000")
_PLAIN_ADDRESS = re.compile(r"https?://[A-Za-z0-9.:\[\]-]+(/[A-Za-z0-9._~/-]*)?")


class Labs:
    """All sheets; each is rendered when it is first asked for.

    Args:
        root: The folder that holds ``labs/``.

    Attributes:
        style: The stylesheet.
    """

    def __init__(self, root: Traversable) -> None:
        self._root = root
        self._files = {
            address: path
            for addresses in (student_addresses(), teacher_addresses())
            for path, address in addresses.items()
        }
        self.style = page_file((files("app.labs") / LABS_STYLE).read_bytes(), TYPES[".css"])
        self._html: Callable[[str], str] = lru_cache(len(self._files))(self._rendered)
        self.file: Callable[[str, str, str], PageFile] = lru_cache(MAX_HELD)(self._file)

    def __contains__(self, address: str) -> bool:
        return address in self._files

    def _text(self, address: str) -> str:
        return self._root.joinpath(self._files[address]).read_text("utf-8")

    def _file(self, address: str, service: str, kind: str) -> PageFile:
        """Return a page as it is sent.

        Args:
            address: Of the page, such as ``labs/fr/4-jacobian``.
            service: Address of the service, without a slash at the end.
            kind: HTML or text.
        """
        if kind == HTML:
            written, content = escape(service), self._html(address)
        else:
            written, content = service, self._text(address)
        content = _WRITTEN.sub(lambda _: written, content)
        return page_file(content.encode(), f"{kind}; charset=utf-8")

    def _rendered(self, address: str) -> str:
        def leads_to(other: str) -> str:
            return _relative(other, address)

        language = "fr" if "/fr" in address else "en"
        words, path = WORDS[language], self._files[address]
        addresses = {file: leads_to(one) for one, file in self._files.items()}
        if "/teacher" not in address:
            addresses = {one: to for one, to in addresses.items() if "teacher" not in one}
        guide = {file: leads_to(f"guide/{name}") for name, file in GUIDE_PAGES.items()}
        addresses |= {**guide, GUIDE_INDEX: leads_to("guide")}
        page = render_page(self._text(address), path, addresses, sheet_parser(), words.section)
        styles = (leads_to(f"guide/{STYLESHEET}"), leads_to(f"labs/{LABS_STYLE}"))
        return document(
            page, self._menus(address, language), styles, language=language, contents=words.contents
        )

    def _menus(self, address: str, language: str) -> tuple[Menu, Menu]:
        words = WORDS[language]
        folder = "labs/teacher" if address.startswith("labs/teacher") else "labs"
        index = f"{folder}/{language}"
        first = words.index if folder == "labs" else words.teacher
        sheets = [Entry(_relative(index, address), first, current=address == index)]
        sheets += [
            Entry(
                _relative(f"{index}/{name}", address),
                name.partition("-")[0],
                current=address == f"{index}/{name}",
            )
            for name in SHEETS
        ]
        other = next(one for one in LANGUAGES if one != language)
        there = address.replace(f"/{language}", f"/{other}", 1)
        service = (
            Entry(_relative(there, address), WORDS[other].itself, language=other),
            Entry(_relative("", address), words.page),
            Entry(_relative("guide", address), words.guide),
        )
        return Menu(words.sheets, sheets), Menu(words.service, service)


def _relative(address: str, page: str) -> str:
    """Return an address as a page links it, so that it holds under any prefix."""
    if not address:
        return "../" * page.count("/") or "./"
    folder = relpath(f"/{dirname(address)}", f"/{dirname(page)}")
    return normpath(join(folder, basename(address)))


def load_labs() -> Labs:
    """Return the sheets of the wheel, or of the checkout.

    Raises:
        FileNotFoundError: The package was built without them.
    """
    root = source_root()
    for path in (*student_addresses(), *teacher_addresses()):
        if not root.joinpath(path).is_file():
            raise FileNotFoundError(path)
    return Labs(root)


def install(app: FastAPI, labs: Labs, *, teacher_edition: bool) -> None:
    """Add ``/labs``, the sheets below it, and their solutions where they are to be served."""

    @app.get("/labs", include_in_schema=False)
    async def languages(request: Request) -> Response:
        headers = {"Vary": "Accept, Accept-Language", "Cache-Control": "no-cache"}
        wanted = wanted_type(request, HTML, TEXT)
        query = "" if wanted == HTML else "?format=text"
        return RedirectResponse(f"labs/{language_of(request)}{query}", 307, headers)

    @app.get("/labs/labs.css", include_in_schema=False)
    async def style(request: Request) -> Response:
        headers: Mapping[str, str] = {"Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
        return labs.style.answer(request, dict(headers))

    if teacher_edition:

        @app.get("/labs/teacher/{path:path}", include_in_schema=False)
        async def teacher(path: str, request: Request) -> Response:
            _require_teacher(request)
            return await _answer(labs, f"labs/teacher/{path}", request, "private, no-cache")

    @app.get("/labs/{path:path}", include_in_schema=False)
    async def sheet(path: str, request: Request) -> Response:
        if path.startswith("teacher"):
            raise HTTPException(404)
        return await _answer(labs, f"labs/{path}", request, "no-cache")


def _require_teacher(request: Request) -> None:
    """Refuse whoever is not a teacher, on a service that tells people apart.

    Raises:
        RequestProblem: 403.
    """
    if not request.app.state.keys.required:
        return
    key = key_of(request.scope)
    if key is None or key.scope is not Scope.SHARE:
        raise RequestProblem(FORBIDDEN, "solutions are shown to keys of scope share")


async def _answer(labs: Labs, address: str, request: Request, cache: str) -> Response:
    if address not in labs:
        raise HTTPException(404)
    wanted = wanted_type(request, HTML, TEXT)
    service = str(request.base_url).rstrip("/")
    if not _PLAIN_ADDRESS.fullmatch(service):
        service = ADDRESS
    file = await run_sync(labs.file, address, service, wanted)
    headers = {
        "Cache-Control": cache,
        "Vary": "Accept, Accept-Encoding, Host",
        "Content-Security-Policy": POLICY,
    }
    return file.answer(request, headers)
