"""The guide in a browser: nothing is cut on a telephone, and the page leads to it."""

import pytest

from app.guide.sources import PAGES

TELEPHONE = {"width": 390, "height": 844}
ADDRESSES = ("/guide", *(f"/guide/{name}" for name in PAGES))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_fit_a_telephone(open_page, scheme):
    visit = open_page(None, viewport=TELEPHONE, color_scheme=scheme)
    for address in ADDRESSES:
        visit.page.goto(visit.server + address)
        assert visit.page.evaluate("document.documentElement.scrollWidth") <= TELEPHONE["width"]
        ink, paper = visit.page.evaluate(
            "() => { const style = getComputedStyle(document.body);"
            " return [style.color, style.backgroundColor]; }"
        )
        assert brightness(ink) < brightness(paper) if scheme == "light" else True
        assert brightness(ink) > brightness(paper) if scheme == "dark" else True


def brightness(colour: str) -> int:
    """Of a computed colour, rgb(r, g, b)."""
    return sum(int(part) for part in colour[4:-1].split(","))


def test_pages_are_linked_with_their_sections(open_page):
    visit = open_page(None)
    visit.page.goto(visit.server + "/guide")
    visit.page.get_by_role("link", name="errors", exact=True).click()
    visit.page.wait_for_url("**/guide/api#errors")
    heading = visit.page.locator("#errors")
    assert heading.evaluate("one => one.getBoundingClientRect().top") < 100
    visit.page.get_by_role("link", name="Tutorial", exact=True).first.click()
    visit.page.wait_for_url("**/guide/tutorial")
    assert visit.page.evaluate(
        "() => [...document.images].every(one => one.complete && one.naturalWidth > 100)"
    )


def test_paper_has_no_menu(open_page):
    visit = open_page(None)
    visit.page.goto(visit.server + "/guide/settings")
    visit.page.emulate_media(media="print")
    assert not visit.page.locator("header").is_visible()
    assert not visit.page.locator(".contents").is_visible()
    assert visit.page.locator("table").first.is_visible()


def test_the_page_leads_to_the_guide(open_page):
    visit = open_page()
    visit.page.get_by_role("link", name="Guide", exact=True).click()
    visit.page.wait_for_url("**/guide")
    assert visit.page.locator("h1").inner_text().startswith("Guide")
