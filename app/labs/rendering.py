"""Markdown of a sheet -> HTML: formulas as MathML, commands also in PowerShell and Python."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from html import escape
from typing import Any

from lxml import etree
from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token
from mdit_py_plugins.dollarmath import dollarmath_plugin

from app.guide.rendering import code_block, language_of_code, page_parser
from app.labs.commands import read_commands
from app.labs.programs import as_powershell, as_python

FUNCTIONS = ("cos", "sin", "tan")
THIN = "0.17em"
LONG = 36
"""Characters of LaTeX; a longer formula in a line may be wider than a telephone."""
_MATHML = "{http://www.w3.org/1998/Math/MathML}"
_ROWS = tuple(_MATHML + name for name in ("math", "mrow", "mtd", "mstyle"))


@cache
def sheet_parser() -> MarkdownIt:
    """Return a parser of sheets: pages with $formulas$, inline and between lines of $$."""
    parser = page_parser().use(dollarmath_plugin, allow_space=False, allow_digits=False)
    parser.add_render_rule("fence", _fence)
    parser.add_render_rule("math_inline", _inline)
    parser.add_render_rule("math_block", _block)
    return parser


def _mathml(latex: str, display: str) -> str:
    # It reads a table of symbols when it is imported, a moment that a starting service does not
    # have: pages are rendered when somebody asks for them.
    from latex2mathml.converter import convert

    formula = etree.fromstring(convert(latex.strip(), display=display))
    for name in formula.iter(f"{_MATHML}mi"):
        if name.text in FUNCTIONS:
            _set_apart(name)
    return etree.tostring(formula, encoding="unicode")


def _set_apart(name: etree._Element) -> None:
    """Put thin spaces around the name of a function, where it stands in a row."""
    row = name.getparent()
    if row is None or row.tag not in _ROWS:
        return
    before, after = name.getprevious(), name.getnext()
    if after is not None and after.tag != f"{_MATHML}mo":
        name.addnext(etree.Element(f"{_MATHML}mspace", width=THIN))
    if before is not None and before.tag not in (f"{_MATHML}mo", f"{_MATHML}mspace"):
        name.addprevious(etree.Element(f"{_MATHML}mspace", width=THIN))


def _inline(_: RendererHTML, tokens: Sequence[Token], index: int, *__: Any) -> str:
    latex = tokens[index].content
    formula = _mathml(latex, "inline")
    return formula if len(latex) <= LONG else f'<span class="long">{formula}</span>'


def _block(_: RendererHTML, tokens: Sequence[Token], index: int, *__: Any) -> str:
    return f'<div class="formula">{_mathml(tokens[index].content, "block")}</div>\n'


def _fence(_: RendererHTML, tokens: Sequence[Token], index: int, *__: Any) -> str:
    token = tokens[index]
    shown = code_block(token)
    if language_of_code(token) != "bash":
        return shown
    statements = read_commands(token.content)
    programs = (("PowerShell", as_powershell(statements)), ("Python", as_python(statements)))
    others = "".join(
        f"<details><summary>{name}</summary>"
        f'<pre class="code"><code>{escape(program)}</code></pre></details>'
        for name, program in programs
    )
    return f'<div class="commands">{shown}{others}</div>\n'
