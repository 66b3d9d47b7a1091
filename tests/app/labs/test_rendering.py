"""Formulas and commands of a sheet as HTML."""

import pytest
from lxml import html

from app.guide.rendering import render_page
from app.labs.commands import UnknownCommand
from app.labs.rendering import sheet_parser

MATH = ".//*[local-name()='math']"


def body(text):
    return html.fragment_fromstring(
        render_page(text, "labs/en/a.md", {}, sheet_parser(), "Lien").body, create_parent=True
    )


def test_formulas_in_a_line_and_between_lines():
    found = body("The length $L_1$ and\n\n$$\nT=\\begin{bmatrix}1&0\\\\0&1\\end{bmatrix}\n$$\n")
    inline, block = found.xpath(MATH)
    assert inline.get("display") == "inline"
    assert [one.text for one in inline.iter() if one.text] == ["L", "1"]
    assert block.get("display") == "block"
    assert len(block.xpath(".//*[local-name()='mtr']")) == 2


def test_a_price_is_no_formula():
    assert body("It costs 5 $ or 6 $ here, and `$x$` is code.").xpath(MATH) == []


def test_names_of_functions_stand_apart_and_powers_stay_whole():
    found = body(r"$2\cos\alpha\sin\theta+\cos^2 q-\sin(q)$")
    spaces = found.xpath(".//*[local-name()='mspace']")
    assert len(spaces) == 4
    (power,) = found.xpath(".//*[local-name()='msup']")
    assert [one.text for one in power] == ["cos", "2"]


def test_only_long_formulas_scroll():
    assert body("$a$").xpath(".//span") == []
    assert len(body(f"${'a+' * 20}a$").xpath(".//span[@class='long']")) == 1


def test_what_only_a_shell_can_do_is_not_put_into_a_sheet():
    with pytest.raises(UnknownCommand):
        body("```bash\nls | wc\n```\n")


def test_headings_are_labelled_in_the_language_of_the_sheet():
    assert body("## A\n").xpath(".//a/@aria-label") == ["Lien"]
