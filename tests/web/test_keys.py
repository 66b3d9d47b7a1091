"""The page on a service that asks for keys."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Page

from app.access.keys import Key, Scope, new_key
from tests.app.conftest import Server, served
from tests.conftest import DENAVIT, PATIENCE, until
from tests.web.test_page import violations

PLANAR = "robot=planar_2r&q=10,20"


@dataclass(frozen=True)
class Doors:
    """A service with a key to read and one to write."""

    server: Server
    file: Path
    keys: dict[str, tuple[str, Key]]

    def accept(self, *names: str) -> None:
        """Accept these keys only, from now on."""
        self.file.write_text("\n".join(self.keys[name][1].line for name in names) + "\n")
        until(lambda: all((self._status(name) == 200) == (name in names) for name in self.keys))

    def _status(self, name: str) -> int:
        headers = {"X-API-Key": self.keys[name][0]}
        address = f"{self.server.address}/v1/robots/planar_2r"
        return httpx.get(address, headers=headers, timeout=PATIENCE).status_code


@pytest.fixture(scope="module")
def service(tmp_path_factory) -> Iterator[Doors]:
    folder = tmp_path_factory.mktemp("keyed")
    keys = {
        "reader": new_key("reader", Scope.READ),
        "writer": new_key("writer", Scope.WRITE),
    }
    file = folder / "keys"
    file.write_text("".join(f"{key.line}\n" for _, key in keys.values()))
    with served(folder, program=DENAVIT, api_keys_file=file) as server:
        yield Doors(server, file, keys)


@pytest.fixture
def doors(service) -> Doors:
    service.accept("reader", "writer")
    return service


@pytest.fixture
def opened(open_page, doors):
    """Opens the page, which asks for a key; notes each request of the API with its key."""

    def visit(fragment: str = PLANAR, **options: object):
        found = open_page(None, address=doors.server.address, refusals=True, **options)
        found.asked = []
        found.page.on(
            "request",
            lambda one: (
                found.asked.append((one.url, one.headers.get("x-api-key")))
                if "/v1/" in one.url
                else None
            ),
        )
        found.page.goto(f"{doors.server.address}/#{fragment}")
        found.page.get_by_role("dialog").wait_for()
        return found

    return visit


def give(page: Page, key: str) -> None:
    dialog = page.get_by_role("dialog").last
    dialog.get_by_role("textbox").fill(key)
    dialog.get_by_role("textbox").press("Enter")


def moved(visit, value: str) -> None:
    visit.page.locator(".joint .value").nth(0).fill(value)


def test_the_key_is_shown_with_each_request_and_kept_in_the_session_only(opened, doors):
    visit = opened(f"{PLANAR}&open=pose,reproduce")
    page, (secret, _) = visit.page, doors.keys["reader"]
    assert page.get_by_role("dialog").count() == 1, "it asks once for all requests"
    give(page, "dnv_wrong")
    page.get_by_text("The service does not know this key.").wait_for()
    give(page, "dnv wröng")
    page.get_by_text("A key has letters, digits and signs without blanks").wait_for()
    del visit.asked[:]
    give(page, secret)
    page.get_by_role("dialog").wait_for(state="detached")
    visit.settled()
    moved(visit, "35")
    visit.settled()
    assert page.locator("option", has_text="PUMA").count(), "the robots are listed"
    assert len(visit.asked) > 5
    assert [url for url, key in visit.asked if key != secret] == []
    assert [url for url, _ in visit.asked if secret in url] == []
    stored = page.evaluate("() => [{...localStorage}, {...sessionStorage}, document.cookie]")
    assert secret not in str(stored[0])
    assert secret in str(stored[1])
    assert stored[2] == ""
    until(lambda: "35" in page.url or page.wait_for_timeout(50))
    assert secret not in page.url
    for form in ("curl", "Python", "PowerShell"):
        page.get_by_role("button", name=form, exact=True).click()
        assert "DENAVIT_KEY" in page.locator(".code").inner_text()
    assert secret not in page.evaluate("() => document.documentElement.outerHTML")
    page.reload()
    visit.settled()
    assert not page.get_by_role("dialog").count()
    # Another tab is another session.
    other = page.context.new_page()
    other.goto(f"{doors.server.address}/#{PLANAR}")
    other.get_by_role("dialog").wait_for()


@pytest.mark.parametrize("webgl", [True, False])
def test_meshes_and_pictures_are_fetched_with_the_key(webgl, opened, doors):
    visit = opened("robot=panda_urdf&q=0,0,0,-90,0,90,0", webgl=webgl)
    page, (secret, _) = visit.page, doors.keys["reader"]
    del visit.asked[:]
    give(page, secret)
    visit.settled()
    if webgl:
        page.wait_for_function("() => document.querySelector('.host').probe?.meshes() > 5")
        assert any("/meshes/" in url for url, _ in visit.asked)
    else:
        page.wait_for_function("() => document.querySelector('img.picture')?.naturalWidth > 100")
    assert {key for _, key in visit.asked} == {secret}
    page.get_by_role("button", name="Download").click()
    with page.expect_download() as download:
        page.get_by_role("button", name="YAML").click()
    assert "convention" in download.value.path().read_text()


def test_a_key_that_is_revoked_is_asked_for_again_and_the_work_stays(opened, doors):
    visit = opened()
    page = visit.page
    give(page, doors.keys["reader"][0])
    visit.settled()
    page.get_by_label("Row 1, a", exact=True).fill("0.77")
    visit.settled()
    doors.accept("writer")
    moved(visit, "55")
    page.get_by_text("no longer accepts the key").wait_for()
    assert page.get_by_role("dialog").count() == 1
    give(page, doors.keys["reader"][0])
    page.get_by_text("The service does not know this key.").wait_for()
    give(page, doors.keys["writer"][0])
    page.get_by_role("dialog").wait_for(state="detached")
    visit.settled()
    assert page.get_by_label("Row 1, a", exact=True).input_value() == "0.77"
    assert page.locator(".joint .value").nth(0).input_value() == "55"
    assert not page.locator(".stale").count()
    page.get_by_role("button", name="Undo").click()
    visit.settled()
    assert page.locator(".joint .value").nth(0).input_value() == "10"


@pytest.mark.parametrize(
    ("locale", "save", "key", "words"),
    [
        ("en-GB", "Save …", "Key …", "This key reads and computes only"),
        ("fr-FR", "Enregistrer …", "Clé …", "Cette clé ne permet que de lire et de calculer"),
    ],
)
def test_a_key_that_only_reads_saves_nothing_and_says_so(locale, save, key, words, opened, doors):
    visit = opened(locale=locale)
    page = visit.page
    give(page, doors.keys["reader"][0])
    visit.settled()
    page.locator("table input").nth(1).fill("0.6")
    visit.settled()
    name = f"saved-{locale.lower()}"

    def store() -> None:
        page.get_by_role("button", name=save, exact=True).click()
        page.get_by_role("dialog").get_by_role("textbox").fill(name)
        page.get_by_role("dialog").get_by_role("button", name=save, exact=True).click()

    store()
    page.get_by_text(words).wait_for()
    page.keyboard.press("Escape")
    page.get_by_role("button", name=key).click()
    give(page, doors.keys["writer"][0])
    page.get_by_role("dialog").wait_for(state="detached")
    store()
    headers = {"X-API-Key": doors.keys["reader"][0]}
    until(
        lambda: (
            page.wait_for_timeout(50)
            or httpx.get(f"{doors.server.address}/v1/robots/{name}", headers=headers).is_success
        )
    )


def test_who_gives_no_key_is_told_and_may_give_it_later(opened, doors, axe):
    visit = opened()
    page = visit.page
    assert violations(page, axe) == []
    page.keyboard.press("Escape")
    page.get_by_text("This service asks for a key").first.wait_for()
    page.wait_for_timeout(500)
    assert not page.get_by_role("dialog").count(), "it is not asked again and again"
    page.get_by_role("button", name="Key …").click()
    give(page, doors.keys["reader"][0])
    visit.settled()
    assert not page.locator(".stale").count()
    # It can be forgotten, too: on a machine that others use.
    page.get_by_role("button", name="Key …").click()
    page.get_by_role("button", name="Forget the key").click()
    page.get_by_text("This service asks for a key. Whoever runs it").wait_for()
    assert page.evaluate("() => sessionStorage.length") == 0


def test_a_service_without_keys_speaks_of_none(open_page):
    visit = open_page(PLANAR)
    assert visit.page.get_by_role("button", name="Key …").count() == 0
