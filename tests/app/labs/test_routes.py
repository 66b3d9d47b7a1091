"""The lab sheets as they are served."""

import re
from urllib.parse import urljoin, urlsplit

import httpx
import pytest
from lxml import html

from app.access.keys import Scope, new_key
from app.guide.sources import source_root
from app.labs.sources import student_addresses, teacher_addresses
from tests.app.conftest import served
from tests.conftest import DENAVIT, PATIENCE

STUDENTS = {f"/{address}": path for path, address in student_addresses().items()}
TEACHERS = {f"/{address}": path for path, address in teacher_addresses().items()}
HERE = {"Host": "localhost:8000"}


@pytest.fixture(scope="module")
def teacher(tmp_path_factory):
    """A service with the teacher's edition, that needs no keys."""
    folder = tmp_path_factory.mktemp("teacher")
    with (
        served(folder, program=DENAVIT, teacher_edition="true") as server,
        httpx.Client(base_url=server.address, headers=HERE, timeout=PATIENCE) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def documents(teacher):
    """All pages, parsed."""
    addresses = STUDENTS | TEACHERS
    return {one: html.document_fromstring(teacher.get(one).content) for one in addresses}


def test_all_sheets_of_the_folder_are_served():
    folder = source_root() / "labs"
    there = {str(path.relative_to(folder.resolve())) for path in folder.resolve().rglob("*.md")}
    assert {f"labs/{path}" for path in there} == {*STUDENTS.values(), *TEACHERS.values()}


@pytest.mark.parametrize(
    ("headers", "language"),
    [({}, "en"), ({"Accept-Language": "fr-FR,fr;q=0.9,en;q=0.5"}, "fr")],
)
def test_labs_lead_to_the_language_of_the_reader(client, headers, language):
    answer = client.get("/labs", headers=headers, follow_redirects=False)
    assert answer.status_code == 307
    assert answer.headers["location"] == f"labs/{language}"
    assert "Accept-Language" in answer.headers["vary"]
    named = client.get("/labs?lang=fr", headers=headers, follow_redirects=False)
    assert named.headers["location"] == "labs/fr"
    text = client.get("/labs", headers={**headers, "Accept": "text/plain"}, follow_redirects=True)
    assert text.headers["content-type"] == "text/plain; charset=utf-8"


@pytest.mark.parametrize("address", STUDENTS)
def test_pages_and_their_markdown(client, address):
    page = client.get(address, headers=HERE)
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    language = address.split("/")[2]
    assert html.document_fromstring(page.content).get("lang") == language
    text = client.get(f"{address}?format=text", headers=HERE)
    assert text.headers["content-type"] == "text/plain; charset=utf-8"
    written = source_root().joinpath(STUDENTS[address]).read_text("utf-8")
    assert text.text.replace("http://localhost:8000", "localhost:8000") == written.replace(
        "http://localhost:8000", "localhost:8000"
    )
    again = client.get(address, headers={**HERE, "If-None-Match": page.headers["etag"]})
    assert again.status_code == 304


@pytest.mark.parametrize("address", STUDENTS | TEACHERS)
def test_nothing_comes_from_elsewhere_and_nothing_runs(teacher, documents, address):
    policy = teacher.get(address).headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "script" not in policy
    document = documents[address]
    assert document.xpath("//script | //iframe | //style | //@style | //img") == []
    for one in document.xpath("//link/@href"):
        if one != "data:,":
            assert not one.startswith("/")
            assert teacher.get(urljoin(address, one)).status_code == 200, one


@pytest.mark.parametrize("address", STUDENTS | TEACHERS)
def test_links_lead_somewhere(teacher, documents, address):
    links = documents[address].xpath("//a/@href")
    assert len(links) > 14
    for link in links:
        parts = urlsplit(link)
        if parts.scheme:
            assert parts.netloc == "localhost:8000", link
            assert not parts.path or teacher.get(parts.path).status_code < 500
            continue
        assert not link.startswith("/"), "a prefix of a reverse proxy would be lost"
        target = urljoin(address, link).partition("#")[0]
        if target in documents:
            if parts.fragment:
                assert documents[target].xpath("//*[@id=$id]", id=parts.fragment), link
        else:
            assert teacher.get(target).status_code == 200, link


def test_formulas_are_mathml_without_rests_of_latex(documents):
    count = 0
    for address, document in documents.items():
        formulas = document.xpath("//*[local-name()='math']")
        count += len(formulas)
        for one in formulas:
            assert "\\" not in one.text_content(), (address, one.text_content())
        prose = list(document.xpath("//article//text()[not(ancestor::pre|ancestor::code)]"))
        assert not [one for one in prose if "$" in one], address
    assert count > 500


@pytest.mark.parametrize("address", [*STUDENTS, *TEACHERS])
def test_every_item_of_a_list_is_one(documents, address):
    for paragraph in documents[address].xpath("//p"):
        assert not re.search(r"^\d+\. |\n- ", paragraph.text_content(), re.MULTILINE)
    for heading in documents[address].xpath("//h1 | //h2"):
        assert not heading.xpath(".//*[local-name()='math']"), "contents show its words only"


@pytest.mark.parametrize("address", [*STUDENTS, *TEACHERS])
def test_commands_are_there_in_three_languages(documents, address):
    for block in documents[address].xpath("//div[@class='commands']"):
        assert [one.text for one in block.xpath(".//summary")] == ["PowerShell", "Python"]


def test_commands_show_the_address_by_which_they_were_asked_for(client):
    asked = client.get("/labs/en/4-jacobian", headers={"Host": "localhost"})
    assert "http://localhost/v1/robots/planar_2r" in asked.text
    assert "localhost:8000" not in asked.text
    text = client.get("/labs/en/4-jacobian?format=text", headers={"Host": "127.0.0.1:99"}).text
    assert 'curl -s "http://127.0.0.1:99/v1/' in text


@pytest.mark.parametrize("host", ["a'; rm -rf ~ #", "<b>", "a b", "$(id)"])
def test_a_strange_address_is_not_repeated(client, host):
    answer = client.get("/labs/en", headers={"Host": host})
    assert answer.status_code in (200, 400, 421)
    assert host not in answer.text


def test_what_is_not_there(client):
    for path in ("/labs/", "/labs/de", "/labs/fr/", "/labs/fr/11-nothing", "/labs/en/README"):
        assert client.get(path).status_code == 404, path
    assert client.get("/labs/en", headers={"Accept": "image/png"}).status_code == 406
    assert client.post("/labs/en").status_code == 405


@pytest.mark.parametrize(
    "path", [*TEACHERS, "/labs//teacher/fr", "/labs/fr/../teacher/fr", "/labs/teacher%2Ffr"]
)
def test_solutions_are_not_there_unless_they_are_switched_on(client, path):
    assert client.get(path).status_code == 404
    assert client.get(f"{path}?format=text").status_code == 404


def test_students_pages_do_not_lead_to_solutions(client):
    for address in STUDENTS:
        assert "/teacher" not in client.get(address).text


def test_a_teachers_own_service_shows_them(teacher):
    for address in TEACHERS:
        assert teacher.get(address).status_code == 200
        assert "private" in teacher.get(address).headers["cache-control"]


def test_with_keys_only_those_of_scope_share_see_solutions(serve):
    keys = {scope: new_key(scope.value, scope) for scope in Scope}
    lines = ",".join(key.line for _, key in keys.values())
    with (
        serve(teacher_edition="true", api_keys=lines) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        assert client.get("/labs/en").status_code == 200
        assert client.get("/labs", follow_redirects=True).status_code == 200
        for path in ("/labs/teacher/en", "/labs/teacher/fr/4-jacobian"):
            assert client.get(path).status_code == 401
            found = {
                scope: client.get(path, headers={"X-API-Key": secret}).status_code
                for scope, (secret, _) in keys.items()
            }
            assert found == {Scope.READ: 403, Scope.WRITE: 403, Scope.SHARE: 200}


def test_the_index_of_the_service_names_them(client):
    assert client.get(client.get("/").json()["labs"], follow_redirects=True).status_code == 200
