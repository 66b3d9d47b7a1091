"""A whole HTML document around a rendered page: menus, contents, body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from app.guide.rendering import RenderedPage, title_of


@dataclass(frozen=True)
class Entry:
    """A link of a menu.

    Attributes:
        address: Where it leads, relative to the page.
        text: Its words.
        current: Whether it is this page.
        language: Of the words and of what they lead to, where it is another than that of the page.
    """

    address: str
    text: str
    current: bool = False
    language: str = ""


@dataclass(frozen=True)
class Menu:
    """Links that stand together.

    Attributes:
        label: What they are, for those who do not see them.
        entries: The links.
    """

    label: str
    entries: Sequence[Entry]


def document(
    page: RenderedPage,
    menus: Sequence[Menu],
    stylesheets: Sequence[str],
    *,
    language: str = "en",
    contents: str = "On this page",
) -> str:
    """Return an HTML document.

    Args:
        page: What it shows.
        menus: Above it.
        stylesheets: Their addresses, relative to the page.
        language: Of the page.
        contents: Label of the list of sections.
    """
    navigation = "\n".join(_menu(one) for one in menus)
    styles = "\n".join(f'<link rel="stylesheet" href="{one}">' for one in stylesheets)
    sections = "".join(
        f'<li><a href="#{one.anchor}">{escape(one.text)}</a></li>'
        for one in page.headings
        if one.level == 2
    )
    return f"""<!doctype html>
<html lang="{language}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{escape(title_of(page.headings))} · Denavit</title>
<link rel="icon" href="data:,">
{styles}
</head>
<body>
<header>
{navigation}
</header>
<main>
<nav class="contents" aria-label="{escape(contents)}"><ul>{sections}</ul></nav>
<article>
{page.body}</article>
</main>
</body>
</html>
"""


def _menu(menu: Menu) -> str:
    links = "".join(
        f'<a href="{one.address}"{_attributes(one)}>{escape(one.text)}</a>' for one in menu.entries
    )
    return f'<nav aria-label="{escape(menu.label)}">{links}</nav>'


def _attributes(entry: Entry) -> str:
    language = f' hreflang="{entry.language}" lang="{entry.language}"' if entry.language else ""
    return f"{' aria-current=page' if entry.current else ''}{language}"
