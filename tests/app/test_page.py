"""The address of the page, before there is one and when another one comes."""

import asyncio

import httpx
import pytest
from fastapi import FastAPI

from app import page
from app.page import Page
from app.routes import health

BROWSER = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}


@pytest.fixture
def visit(tmp_path):
    """A function that asks for an address, of an application whose page is in a folder."""
    app = FastAPI()
    app.state.page = Page(tmp_path / "static")
    app.include_router(health.router)
    page.install(app, app.state.page)
    transport = httpx.ASGITransport(app)

    async def asked(path, headers):
        async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as client:
            return await client.get(path, headers=headers)

    return lambda path="/", headers=BROWSER: asyncio.run(asked(path, headers))


def put(tmp_path, name, text):
    """Puts a page in its place, as the build does: a whole folder."""
    made = tmp_path / name
    (made / "assets").mkdir(parents=True)
    (made / "index.html").write_text(text)
    (made / "assets" / f"{name}.js").write_text(name)
    if (tmp_path / "static").exists():
        (tmp_path / "static").rename(tmp_path / f"before {name}")
    made.rename(tmp_path / "static")


def test_a_browser_is_told_that_the_page_is_to_come_and_asks_again(visit):
    answer = visit()
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert answer.headers["cache-control"] == "no-store"
    assert 'http-equiv="refresh"' in answer.text
    assert "not built yet" in answer.text
    others = visit(headers={"Accept": "*/*"})
    assert others.json()["service"] == "denavit"


def test_a_page_that_comes_is_shown_and_so_is_the_next_one(visit, tmp_path):
    assert visit("/assets/one.js").status_code == 404
    put(tmp_path, "one", "first")
    # Its parts may be asked of a process that was not asked for the page.
    assert visit("/assets/one.js").text == "one"
    assert visit().text == "first"
    put(tmp_path, "two", "second")
    assert visit().text == "second"
    assert visit("/assets/two.js").text == "two"
    assert visit("/assets/one.js").status_code == 404


def test_while_one_page_takes_the_place_of_another_the_old_one_is_shown(visit, tmp_path):
    put(tmp_path, "one", "first")
    assert visit().text == "first"
    (tmp_path / "static").rename(tmp_path / "away")
    assert visit().text == "first"
