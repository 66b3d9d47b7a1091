"""The guide as it is served."""

import re
from urllib.parse import urljoin, urlsplit

import pytest
from lxml import html

from app.guide.sources import INDEX, PAGES, PICTURES, source_root

ADDRESSES = {"/guide": INDEX} | {f"/guide/{name}": path for name, path in PAGES.items()}
BROWSER = {"Accept": "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"}


@pytest.fixture(scope="module")
def documents(client):
    """All pages, parsed."""
    return {one: html.document_fromstring(client.get(one).content) for one in ADDRESSES}


@pytest.mark.parametrize("address", ADDRESSES)
def test_pages_answer_browsers_and_everybody_else(client, address):
    page = client.get(address, headers=BROWSER)
    assert page.status_code == 200
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.content == client.get(address).content
    assert "text/html" in page.headers["content-type"]


@pytest.mark.parametrize("address", ADDRESSES)
def test_pages_as_text_are_their_markdown(client, address):
    text = source_root().joinpath(ADDRESSES[address]).read_text("utf-8")
    for answer in (
        client.get(f"{address}?format=text"),
        client.get(address, headers={"Accept": "text/plain"}),
    ):
        assert answer.headers["content-type"] == "text/plain; charset=utf-8"
        assert answer.text == text


@pytest.mark.parametrize("address", [*ADDRESSES, "/guide/guide.css", "/guide/page.png"])
def test_what_a_browser_has_is_not_sent_again(client, address):
    first = client.get(address)
    again = client.get(address, headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert again.headers["etag"] == first.headers["etag"]
    assert client.get(address, headers={"If-None-Match": '"other"'}).status_code == 200


def test_html_text_and_compressed_forms_have_tags_of_their_own(client):
    plain = {"Accept-Encoding": "identity"}
    forms = [
        client.get("/guide/api", headers=plain),
        client.get("/guide/api", headers={"Accept-Encoding": "gzip"}),
        client.get("/guide/api?format=text", headers=plain),
    ]
    assert len({one.headers["etag"] for one in forms}) == 3
    assert forms[1].headers["content-encoding"] == "gzip"
    assert forms[1].content == forms[0].content
    assert "Accept-Encoding" in forms[0].headers["vary"]


@pytest.mark.parametrize("address", ["/guide", "/guide/api", "/guide/guide.css"])
def test_head(client, address):
    asked = client.head(address, headers={"Accept-Encoding": "identity"})
    assert (asked.status_code, asked.content) == (200, b"")
    got = client.get(address, headers={"Accept-Encoding": "identity"})
    assert asked.headers["content-length"] == str(len(got.content))
    assert asked.headers["etag"] == got.headers["etag"]


@pytest.mark.parametrize("address", ADDRESSES)
def test_nothing_comes_from_elsewhere_and_nothing_runs(client, documents, address):
    policy = client.get(address).headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "script" not in policy
    document = documents[address]
    assert document.xpath("//script | //iframe | //style | //@style | //@onclick") == []
    loaded = document.xpath("//img/@src | //link/@href")
    assert len(loaded) >= 2
    for one in loaded:
        assert one == "data:," or not urlsplit(one).scheme, one
        if one != "data:,":
            assert not one.startswith("/"), "a prefix of a reverse proxy would be lost"
            assert client.get(urljoin(address, one)).status_code == 200, one


def test_the_stylesheet_loads_nothing(client):
    style = client.get("/guide/guide.css")
    assert style.headers["content-type"] == "text/css; charset=utf-8"
    assert not re.search(r"url\(|@import", style.text)


@pytest.mark.parametrize("address", ADDRESSES)
def test_links_lead_somewhere(client, documents, address):
    links = documents[address].xpath("//a/@href")
    assert len(links) > 10
    for link in links:
        parts = urlsplit(link)
        if parts.scheme:
            assert parts.netloc == "localhost:8000", link
            continue
        assert not link.startswith("/"), "a prefix of a reverse proxy would be lost"
        target = urljoin(address, link).partition("#")[0]
        if target in documents:
            if parts.fragment:
                assert documents[target].xpath("//*[@id=$id]", id=parts.fragment), link
        else:
            assert client.get(target).status_code == 200, link


def test_every_page_and_picture_is_linked(documents):
    linked = {
        urljoin(one, link) for one, page in documents.items() for link in page.xpath("//a/@href")
    }
    assert set(ADDRESSES) <= {link.partition("#")[0] for link in linked}
    shown = {
        urljoin(one, link) for one, page in documents.items() for link in page.xpath("//img/@src")
    }
    assert shown == {f"/guide/{name}" for name in PICTURES}


def test_all_pages_of_docs_are_in_the_guide():
    folder = source_root() / "docs"
    there = {f"docs/{one.name}" for one in folder.iterdir() if one.name.endswith(".md")}
    assert there <= {INDEX, *PAGES.values()}


def test_headings_of_a_page_are_listed_on_it(documents):
    page = documents["/guide/api"]
    assert page.xpath("//nav[@class='contents']//a/text()") == [
        one.text_content().removesuffix(" #") for one in page.xpath("//h2")
    ]


def test_what_is_not_there(client):
    answer = client.get("/guide/nothing")
    assert answer.status_code == 404
    assert answer.json()["type"] == "/problems/not-found"
    assert client.get("/guide/").status_code == 404
    assert client.get("/guide/api", headers={"Accept": "image/png"}).status_code == 406
    assert client.post("/guide/api").status_code == 405


def test_the_index_of_the_service_names_it(client):
    index = client.get("/").json()
    assert client.get(index["guide"]).status_code == 200
