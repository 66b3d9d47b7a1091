"""The lab sheets in a browser: formulas, telephone, paper, and the links to the page's states."""

import pytest

from app.labs.sources import SHEETS
from tests.web.test_guide import TELEPHONE, brightness

ADDRESSES = tuple(
    f"/labs/{language}{name}"
    for language in ("en", "fr")
    for name in ("", *(f"/{sheet}" for sheet in SHEETS))
)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_sheets_fit_a_telephone(open_page, scheme):
    visit = open_page(None, viewport=TELEPHONE, color_scheme=scheme)
    for address in ADDRESSES:
        visit.page.goto(visit.server + address)
        assert visit.page.evaluate("document.documentElement.scrollWidth") <= TELEPHONE["width"]
    ink, paper = visit.page.evaluate(
        "() => { const style = getComputedStyle(document.querySelector('math'));"
        " return [style.color, getComputedStyle(document.body).backgroundColor]; }"
    )
    assert (brightness(ink) < brightness(paper)) == (scheme == "light")


def test_formulas_are_drawn(open_page):
    visit = open_page(None)
    visit.page.goto(f"{visit.server}/labs/fr/1-sixteen-steps")
    matrix = visit.page.locator(".formula math").first
    heights = matrix.evaluate("one => [one.getBoundingClientRect().height, 20]")
    assert heights[0] > 4 * heights[1], "four rows stand above each other"
    fraction = visit.page.goto(f"{visit.server}/labs/en/6-inverse-model")
    assert fraction.ok
    box = visit.page.locator("mfrac").first.bounding_box()
    assert box["height"] > 25


def test_other_languages_of_a_command_unfold(open_page):
    visit = open_page(None)
    visit.page.goto(f"{visit.server}/labs/en/4-jacobian")
    first = visit.page.locator(".commands").first
    assert not first.get_by_text("from urllib.request import").is_visible()
    first.get_by_text("Python", exact=True).click()
    assert first.get_by_text("from urllib.request import").is_visible()
    visit.page.emulate_media(media="print")
    assert not visit.page.locator("header").is_visible()
    assert not first.get_by_text("PowerShell", exact=True).is_visible()
    assert first.locator("pre.code").first.is_visible()


@pytest.mark.parametrize("name", SHEETS)
def test_links_to_the_page_show_what_the_sheet_speaks_of(open_page, name):
    visit = open_page(None)
    visit.page.goto(f"{visit.server}/labs/fr/{name}")
    links = visit.page.locator("a[href*='#robot=']").evaluate_all("all => all.map(a => a.href)")
    assert links
    robot, q = (part.split("=")[1] for part in links[0].split("#")[1].split("&")[:2])
    visit.page.goto(links[0])
    visit.page.wait_for_function("document.querySelector('main, canvas, table') !== null")
    visit.page.wait_for_function(
        "robot => [...document.querySelectorAll('select')].some(one => one.value === robot)",
        arg=robot,
    )
    assert f"q={q}" in visit.page.evaluate("location.hash")


def test_the_page_leads_to_the_sheets(open_page):
    visit = open_page()
    visit.page.get_by_role("link", name="Labs", exact=True).click()
    visit.page.wait_for_url("**/labs/en")
    visit.page.get_by_role("link", name="Français", exact=True).click()
    visit.page.wait_for_url("**/labs/fr")
    assert visit.page.locator("h1").inner_text().startswith("Travaux pratiques")
