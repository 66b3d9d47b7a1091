"""The page as a thing: languages, colours, screen readers, no WebGL, what is sent and how fast."""

import gzip
import json
import re
from pathlib import Path

import pytest

from app.page import TYPES

ROOT = Path(__file__).parents[2]
STATIC = ROOT / "app" / "static"
FIRST_SCREEN = 22_500
QUESTIONS = 4
FIRST_FETCHES = 16
FIRST_BYTES = 100_000
ALL_OPEN = "open=pose,links,jacobian,singularity,ik,path,reproduce"

MOVES = 30
MOVE = """async (moves) => {
    const slider = document.querySelector('.joint input[type=range]');
    const cell = document.querySelector('#section-jacobian .matrix td[data-value]');
    const pose = document.querySelector('#section-pose .matrix td[data-value]');
    for (let k = 1; k <= moves; k += 1) {
        const before = [cell.dataset.value, pose.dataset.value];
        slider.value = String(Number(slider.value) > 0 ? -2 * k : 2 * k);
        slider.dispatchEvent(new Event('input', {bubbles: true}));
        while (cell.dataset.value === before[0] || pose.dataset.value === before[1]) {
            await new Promise(done => setTimeout(done, 1));
        }
    }
}"""
"""Moves a slider as soon as the numbers of the last move are there."""

LOOKS = {
    "light": {},
    "dark": {"color_scheme": "dark"},
    "french": {"locale": "fr-FR"},
    "mobile": {"viewport": {"width": 390, "height": 844}, "has_touch": True},
    "tablet": {"viewport": {"width": 820, "height": 1180}, "has_touch": True},
}


def violations(page, axe: str) -> list[str]:
    # By the debugger's protocol, to which the page's policy does not apply.
    page.evaluate(axe)
    found = page.evaluate("() => axe.run(document, {resultTypes: ['violations']})")
    return [
        f"{one['id']}: {one['help']}: {[node['html'][:120] for node in one['nodes'][:4]]}"
        for one in found["violations"]
    ]


@pytest.mark.parametrize("look", LOOKS)
def test_axe_finds_nothing(look, open_page, axe):
    visit = open_page(f"robot=puma560&q=10,20,-100,30,0,40&row=2,2&{ALL_OPEN}", **LOOKS[look])
    page = visit.page
    page.wait_for_selector(".code:has-text('curl')")
    page.wait_for_selector("#section-path fieldset")
    # With all that unfolds and all that is listed on demand.
    page.locator(".card > details.fold > summary", has_text=re.compile("Base")).click()
    page.get_by_role("button", name=re.compile("^(Target here|Cible ici)$")).click()
    page.get_by_role("button", name=re.compile("^(All solutions|Toutes les solutions)$")).click()
    page.wait_for_selector(".solutions button")
    page.locator("#section-path").get_by_role("button", name=re.compile("^(Add|Ajouter)$")).click()
    page.get_by_role("button", name=re.compile("^(Compare the|Comparer les)")).click()
    page.wait_for_selector("#section-path .compared")
    assert violations(page, axe) == []
    page.get_by_role("button", name=re.compile("Coller|Paste")).click()
    page.get_by_role("dialog").wait_for()
    assert violations(page, axe) == []


def test_axe_finds_nothing_where_the_table_is_wrong(open_page, axe):
    visit = open_page("robot=puma560&q=0,0,0,0,0,0", refusals=True)
    visit.page.get_by_label("Row 2, a", exact=True).fill("apples")
    visit.page.wait_for_selector("[aria-invalid=true]")
    assert violations(visit.page, axe) == []


def test_the_browser_chooses_french_and_the_reader_may_switch(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0", locale="fr-CA")
    page = visit.page
    assert page.locator("html").get_attribute("lang") == "fr"
    assert page.get_by_role("heading", name="Tableau D-H").is_visible()
    assert "Rang 6" in page.locator("#section-singularity").inner_text()
    page.locator(".joint .value").nth(4).fill("0")
    page.get_by_text("Singulier : rang 5 au lieu de 6.").wait_for()
    page.get_by_label("Langue").select_option("en")
    page.get_by_role("heading", name="D-H table").wait_for()
    visit.settled()
    assert page.locator("html").get_attribute("lang") == "en"
    assert page.locator(".joint .value").nth(4).input_value() == "0"
    page.reload()
    page.get_by_role("heading", name="D-H table").wait_for()


def test_nothing_is_left_without_a_word(open_page):
    for locale in ("fr-FR", "en-GB"):
        visit = open_page(f"robot=puma560&q=0,45,-90,0,45,0&{ALL_OPEN}", locale=locale)
        visit.page.wait_for_selector(".code:has-text('curl')")
        everything = visit.page.evaluate("() => document.body.outerHTML")
        assert "undefined" not in everything
        assert "[object" not in everything


def test_dark_follows_the_system_and_the_switch(open_page):
    visit = open_page("robot=planar_2r&q=0,0", color_scheme="dark")
    page = visit.page

    def brightness() -> float:
        colour = page.evaluate("() => getComputedStyle(document.body).backgroundColor")
        return sum(float(one) for one in re.findall(r"[\d.]+", colour)[:3])

    assert brightness() < 200
    page.get_by_label("Light or dark").click()
    assert brightness() > 600
    page.reload()
    visit.settled()
    assert brightness() > 600


@pytest.mark.parametrize("width", [360, 390, 768, 1280])
def test_nothing_is_wider_than_the_screen(width, open_page):
    visit = open_page(
        f"robot=pa10&q=0,30,0,60,0,60,0&{ALL_OPEN}", viewport={"width": width, "height": 800}
    )
    visit.page.wait_for_selector("#section-path fieldset")
    wide = visit.page.evaluate("() => document.documentElement.scrollWidth")
    assert wide <= width


def test_all_of_it_is_reached_by_keyboard(open_page):
    visit = open_page("robot=planar_2r&q=0,0&open=pose")
    page = visit.page
    reached = set()
    for _ in range(120):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(
                "() => document.activeElement.getAttribute('aria-label') ?? "
                "document.activeElement.textContent"
            )
        )
    view = (
        "3D view of the robot: arrow keys turn it, + and − zoom."
        " What it shows is in the numbers beside it."
    )
    names = ("PUMA 560", "Row 1, a", "j1 (°)", "Fit", "Language", "Row 2, type of joint")
    for name in (*names, view):
        assert name in reached, sorted(reached)
    page.get_by_label("Row 1, a", exact=True).focus()
    page.keyboard.press("ArrowDown")
    assert page.evaluate("() => document.activeElement.getAttribute('aria-label')") == "Row 2, a"
    page.locator(".joint .value").nth(0).focus()
    page.keyboard.press("ArrowUp")
    assert page.locator(".joint .value").nth(0).input_value() == "1"


@pytest.mark.scene
def test_what_changes_is_told_to_screen_readers(open_page):
    visit = open_page("robot=planar_2r&q=0,0&task=xy")
    visit.page.locator(".joint .value").nth(0).fill("90")
    visit.page.wait_for_function(
        "() => document.querySelector('[role=status]').textContent.includes('0.000, 1.800, 0.000')"
    )


def test_first_screen_is_small(open_page):
    for language in ("en", "fr"):
        index = (STATIC / "index.html").read_text()
        scripts = set(re.findall(r"assets/[\w-]+\.js", index))
        scripts |= {f"assets/{p.name}" for p in (STATIC / "assets").glob(f"{language}-*.js")}
        total = sum((STATIC / f"{one}.gz").stat().st_size for one in scripts)
        assert 5_000 < total <= FIRST_SCREEN, (language, total, scripts)


@pytest.mark.scene
def test_numbers_follow_the_slider_at_once(open_page):
    """Each move gets its numbers by itself, for a few questions; how soon is the service's part."""
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0")
    asked = []
    visit.page.on("request", lambda request: asked.append(request.url))
    visit.page.evaluate(MOVE, MOVES)
    assert len(asked) <= QUESTIONS * MOVES, asked


def test_the_page_is_usable_soon(open_page):
    """Little is fetched before the first numbers are there; how fast is the network's part."""
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0")
    visit.page.add_init_script(
        """new MutationObserver((_, observer) => {
            if (!document.querySelector('#section-jacobian .matrix td[data-value]')) return;
            window.fetchedBefore = performance.getEntriesByType('resource').map(one =>
                [one.name, one.transferSize]);
            observer.disconnect();
        }).observe(document, {subtree: true, childList: true, attributes: true});"""
    )
    visit.page.reload()
    visit.page.wait_for_function("() => window.fetchedBefore")
    fetched = visit.page.evaluate("() => window.fetchedBefore")
    assert len(fetched) <= FIRST_FETCHES, fetched
    assert sum(size for _, size in fetched) <= FIRST_BYTES, fetched


def test_without_webgl_there_is_a_picture(open_page):
    pictures: list[str] = []
    visit = open_page(None, webgl=False)
    visit.page.on(
        "response",
        lambda answer: (
            pictures.append(answer.headers["content-type"])
            if "/picture.svg" in answer.url
            else None
        ),
    )
    visit.go("robot=puma560&q=0,45,-90,0,45,0")
    visit.page.wait_for_selector("img.picture")
    visit.page.wait_for_function("() => document.querySelector('img.picture').naturalWidth > 100")
    first = visit.page.locator("img.picture").get_attribute("src")
    visit.page.locator(".joint .value").nth(0).fill("60")
    visit.page.wait_for_function("s => document.querySelector('img.picture').src !== s", arg=first)
    assert set(pictures) == {"image/svg+xml"}
    # What only the 3D view can show is not offered.
    assert not visit.page.locator(".toolbar").count()
    assert (
        visit.page.evaluate(
            """() => {
            const host = document.querySelector('.host'), image = host.querySelector('img');
            return Math.abs(image.naturalWidth / image.naturalHeight
                - host.clientWidth / host.clientHeight);
        }"""
        )
        < 0.02
    )


@pytest.mark.scene
def test_curl_gets_the_index_and_browsers_the_page(client):
    plain = client.get("/")
    assert plain.json()["service"] == "denavit"
    assert client.get("/", headers={"Accept": "text/plain"}).text.startswith("service: denavit")
    browser = "text/html,application/xhtml+xml,application/xml;q=0.9,image/webp,*/*;q=0.8"
    page = client.get("/", headers={"Accept": browser})
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert "Accept" in page.headers["vary"]
    assert page.headers["cache-control"] == "no-cache"
    again = client.get("/", headers={"Accept": browser, "If-None-Match": page.headers["etag"]})
    assert again.status_code == 304
    head = client.head("/", headers={"Accept": browser})
    assert head.status_code == 200


def test_parts_are_compressed_kept_for_ever_and_of_a_known_type(client):
    names = [p.name for p in (STATIC / "assets").iterdir() if p.suffix not in (".gz", ".br")]
    assert len(names) > 8
    for name in names:
        plain = client.get(f"/assets/{name}", headers={"Accept-Encoding": "identity"})
        assert plain.headers["content-type"] == TYPES[Path(name).suffix]
        assert plain.headers["cache-control"] == "public, max-age=31536000, immutable"
        assert "content-encoding" not in plain.headers
        assert re.search(r"-[\w-]{8}\.\w+$", name), f"{name} has no hash"
        packed = client.get(f"/assets/{name}", headers={"Accept-Encoding": "gzip"})
        assert packed.headers["content-encoding"] == "gzip"
        assert packed.content == plain.content
        with client.stream(
            "GET", f"/assets/{name}", headers={"Accept-Encoding": "gzip, deflate, br"}
        ) as best:
            assert best.headers["content-encoding"] == "br"
            assert int(best.headers["content-length"]) < max(len(plain.content), 200)
    assert client.get("/assets/nothing.js").status_code == 404
    assert client.get("/assets/..%2findex.html").status_code == 404


def test_the_policy_takes_nothing_inline_and_no_other_host(client):
    page = client.get("/", headers={"Accept": "text/html"})
    policy = page.headers["content-security-policy"]
    assert "unsafe" not in policy
    assert "http" not in policy
    assert "default-src 'none'" in policy
    assert not re.search(r"<script(?![^>]*src=)|<style| style=| on\w+=", page.text)
    assert not re.search(r'(?:src|href)="(?:/|https?:)', page.text), "absolute addresses"


def test_the_lock_names_no_registry():
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text())
    assert not [name for name, one in lock["packages"].items() if "resolved" in one]
    assert all("integrity" in one for name, one in lock["packages"].items() if name)
    assert set(lock["packages"][""]["dependencies"]) == {
        "@types/three",
        "three",
        "typescript",
        "urdf-loader",
        "vite",
    }


def test_gzip_forms_are_the_files(client):
    for packed in STATIC.rglob("*.gz"):
        assert gzip.decompress(packed.read_bytes()) == packed.with_suffix("").read_bytes()
