"""Markdown -> HTML of one guide page, with links that work below ``/guide``."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from posixpath import dirname, join, normpath
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token

_NOT_IN_ANCHOR = re.compile(r"[^\w\- ]+")
_ADDRESS = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


@dataclass(frozen=True)
class Heading:
    """A heading of a page.

    Attributes:
        level: 1 to 6.
        text: Its words, without markup.
        anchor: Its ``id``, as forges make it from the words.
    """

    level: int
    text: str
    anchor: str


@dataclass(frozen=True)
class RenderedPage:
    """The body of a page, and what its frame needs to know.

    Attributes:
        headings: All headings in order.
        body: HTML.
    """

    headings: tuple[Heading, ...]
    body: str


def render_page(
    text: str,
    path: str,
    addresses: Mapping[str, str],
    parser: MarkdownIt | None = None,
    section: str = "Link to this section",
) -> RenderedPage:
    """Render one Markdown file.

    Args:
        text: The Markdown.
        path: The file's path in the repository; relative links start from its folder.
        addresses: Address below ``/guide``, relative to this page, of each file of the
            repository that the service has. A link to any other file becomes plain text.
        parser: What reads and writes it; default one for plain pages.
        section: Label of the link that a heading has to itself.
    """
    chosen = parser or _PARSER
    tokens = chosen.parse(text)
    headings = _anchor_headings(tokens)
    for token in tokens:
        if token.children:
            token.children = _with_addresses(token.children, path, addresses)
    environment = {"section": section}
    return RenderedPage(headings, str(chosen.renderer.render(tokens, chosen.options, environment)))


def headings_of(text: str) -> tuple[Heading, ...]:
    """Return the headings of a Markdown text, in order."""
    return _anchor_headings(_PARSER.parse(text))


def title_of(headings: Sequence[Heading]) -> str:
    """Return the words of the first heading of level 1; empty where there is none."""
    return next((one.text for one in headings if one.level == 1), "")


def anchor_of(words: str) -> str:
    """Return the anchor that forges give a heading: ``Keys, rates`` -> ``keys-rates``."""
    return _NOT_IN_ANCHOR.sub("", words.strip().lower()).replace(" ", "-")


def _anchor_headings(tokens: Sequence[Token]) -> tuple[Heading, ...]:
    """Give every heading an ``id`` and a link to itself; a second one of a name gets ``-1``."""
    found: list[Heading] = []
    used: Counter[str] = Counter()
    for opening, inline, closing in zip(tokens, tokens[1:], tokens[2:], strict=False):
        if opening.type != "heading_open":
            continue
        children = inline.children or []
        words = "".join(one.content for one in children if one.type in ("text", "code_inline"))
        anchor = anchor_of(words)
        used[anchor] += 1
        if used[anchor] > 1:
            anchor = f"{anchor}-{used[anchor] - 1}"
        opening.attrSet("id", anchor)
        closing.meta["anchor"] = anchor
        found.append(Heading(int(opening.tag[1:]), words, anchor))
    return tuple(found)


def _with_addresses(
    children: Sequence[Token], path: str, addresses: Mapping[str, str]
) -> list[Token]:
    """Return inline tokens whose links and pictures point to what the service has."""
    kept: list[Token] = []
    dropped: list[bool] = []
    for token in children:
        if token.type == "link_open":
            address = _address(str(token.attrGet("href")), path, addresses)
            dropped.append(address is None)
            if address is None:
                continue
            token.attrSet("href", address)
        elif token.type == "link_close":
            if dropped.pop():
                continue
        elif token.type == "image":
            address = _address(str(token.attrGet("src")), path, addresses)
            if address is None:
                raise ValueError(f"{path} shows {token.attrGet('src')}, which is not served")
            token.attrSet("src", address)
        kept.append(token)
    return kept


def _address(link: str, path: str, addresses: Mapping[str, str]) -> str | None:
    """Return where a link of a file leads below ``/guide``; None where the service has it not."""
    if link.startswith("#") or _ADDRESS.match(link):
        return link
    target, mark, fragment = link.partition("#")
    address = addresses.get(normpath(join(dirname(path), target)))
    return None if address is None else f"{address}{mark}{fragment}"


def _heading_close(
    _: RendererHTML, tokens: Sequence[Token], index: int, __: Any, environment: Mapping[str, Any]
) -> str:
    token = tokens[index]
    label = escape(environment["section"])
    link = f'<a class="anchor" href="#{token.meta["anchor"]}" aria-label="{label}">#</a>'
    return f" {link}</{token.tag}>\n"


def _table_open(*_: Any) -> str:
    # A wide table scrolls by itself, and not the page with it.
    return '<div class="wide"><table>\n'


def _table_close(*_: Any) -> str:
    return "</table></div>\n"


def code_block(token: Token) -> str:
    """Write a block of code; commands and what they print are told apart by class."""
    kind = "output" if language_of_code(token) in ("text", "json") else "code"
    return f'<pre class="{kind}"><code>{escape(token.content)}</code></pre>\n'


def language_of_code(token: Token) -> str:
    """Return the language that a block of code names."""
    return token.info.strip().partition(" ")[0]


def _fence(_: RendererHTML, tokens: Sequence[Token], index: int, *__: Any) -> str:
    return code_block(tokens[index])


def page_parser() -> MarkdownIt:
    """Return a parser of Markdown pages: CommonMark and tables, no HTML."""
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    parser.add_render_rule("heading_close", _heading_close)
    parser.add_render_rule("table_open", _table_open)
    parser.add_render_rule("table_close", _table_close)
    parser.add_render_rule("fence", _fence)
    return parser


_PARSER = page_parser()
