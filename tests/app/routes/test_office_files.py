"""Workbooks, and texts in the encodings of Windows, over HTTP: uploads and conversions."""

import asyncio

import httpx
import numpy as np
import pytest

from app.dependencies import Services
from app.http.problems import RequestProblem
from app.settings import Settings
from dh_to_urdf.pasted.workbooks import WORKBOOK_BYTES
from tests.dh_to_urdf.pasted.test_workbooks import ROWS, TITLE, ods, xlsx

XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
ODS = "application/vnd.oasis.opendocument.spreadsheet"
Q = [0.3, -0.4]
WORKBOOKS = {"xlsx": (XLSX, xlsx([[TITLE], [], *ROWS])), "ods": (ODS, ods([[TITLE], [], *ROWS]))}
NAMES = {"iso-8859-1": "épaule", "windows-1252": "cœur", "utf-16": "α_1", "utf-16-le": "α_1"}
LETTERS = {"iso-8859-1": "é°", "windows-1252": "é°–€", "utf-16": "é°α€", "utf-16-le": "é°α€"}
DEGREES = "% {letters}\nL(1) = Link([0 0.4 0 pi/2]);\nL(2) = Link([0 0 0.3 0 0 -90*pi/180]);\n"
ROBOT = "r = SerialLink(L, 'name', 'bras {letters}');\n"
CSV = "name,type,alpha,a,d,theta\n{letters},R,90deg,0,0.4,0\ny,R,0,0.3,0,-90deg\n"


def expected_pose(q):
    """The product of the link matrices of the table, written out."""
    pose = np.eye(4)
    for alpha, a, d, theta in ((np.pi / 2, 0, 0.4, q[0]), (0, 0.3, 0, q[1] - np.pi / 2)):
        (ct, st), (ca, sa) = (np.cos(theta), np.sin(theta)), (np.cos(alpha), np.sin(alpha))
        pose = pose @ [
            [ct, -st * ca, st * sa, a * ct],
            [st, ct * ca, -ct * sa, a * st],
            [0, sa, ca, d],
            [0, 0, 0, 1],
        ]
    return pose


def assert_right(client, robot="office"):
    answer = client.post("/v1/fk", json={"robot": robot, "q": Q})
    assert answer.status_code == 200, answer.text
    (pose,) = answer.json()["poses"].values()
    np.testing.assert_allclose(pose["matrix"], expected_pose(Q), rtol=0, atol=1e-12)


def assert_read_everywhere(client, content, kind, query=""):
    """Uploaded both ways and converted both ways, it is the same robot."""
    headers = {"content-type": kind}
    for send, path in ((client.put, "/office?name=office&"), (client.post, "?name=office&")):
        uploaded = send(
            f"/v1/robots{path}convention=standard{query}", content=content, headers=headers
        )
        try:
            assert uploaded.status_code == 201, uploaded.text
            assert_right(client)
        finally:
            client.delete("/v1/robots/office")
    given = f"convention=standard&name=office{query}"
    table = client.post(f"/v1/convert-dh?to=modified&{given}", content=content, headers=headers)
    assert table.status_code == 200, table.text
    assert_right(client, robot=table.json())
    urdf = client.post(f"/v1/dh-to-urdf?{given}", content=content, headers=headers)
    assert urdf.status_code == 200, urdf.text
    assert_right(client, robot={"urdf": urdf.text, "tip": "tool"})
    return table.json()


@pytest.mark.parametrize("name", WORKBOOKS)
def test_a_workbook_is_a_document(client, name):
    kind, content = WORKBOOKS[name]
    table = assert_read_everywhere(client, content, kind)
    assert any("plain numbers are in deg, mm" in one for one in table["warnings"])


@pytest.mark.parametrize("kind", [XLSX, ODS])
def test_what_is_no_workbook_is_refused(client, kind):
    answer = client.post(
        "/v1/convert-dh?to=modified&convention=standard",
        content=b"PK\x03",
        headers={"content-type": kind},
    )
    assert answer.status_code == 422
    assert "no .xlsx or .ods workbook" in answer.json()["detail"]


@pytest.mark.parametrize("charset", LETTERS)
def test_a_text_is_read_in_the_encoding_that_is_named(client, charset):
    letters = LETTERS[charset]
    script = (DEGREES + ROBOT).format(letters=letters).encode(charset)
    assert_read_everywhere(client, script, f"text/plain; charset={charset}")
    rows = CSV.format(letters=NAMES[charset]).encode(charset)
    table = assert_read_everywhere(client, rows, f'text/csv; charset="{charset.upper()}"')
    assert table["joints"][0]["name"] == NAMES[charset]
    assert not table.get("warnings")


def test_another_encoding_than_is_named_is_refused(client):
    script = (DEGREES + ROBOT).format(letters="é").encode("iso-8859-1")
    for charset, words in (("utf-8", "is not in utf-8"), ("zip", "'zip' is unknown")):
        headers = {"content-type": f"text/plain; charset={charset}"}
        answer = client.post(
            "/v1/convert-dh?to=modified&convention=standard", content=script, headers=headers
        )
        assert answer.status_code == 422
        assert words in answer.json()["detail"]


def test_one_long_text_that_many_cells_name_is_refused(client):
    content = ods([["x" * 3000]], repeated=100)
    assert len(content) < 10_000
    answer = client.post(
        "/v1/convert-dh?to=modified&convention=standard",
        content=content,
        headers={"content-type": ODS},
    )
    assert answer.status_code == 422
    assert "too many cells" in answer.json()["detail"]


def test_a_workbook_waits_for_the_memory_of_its_process(tmp_path):
    """A service with too little memory for it says so; small documents are read beside."""

    async def scene(most):
        services = Services(Settings(data_dir=tmp_path, max_wait_seconds=0.05))
        services.memory.most = most
        held = services.memory.reservation()
        held.settle(most - WORKBOOK_BYTES + 1 if most > WORKBOOK_BYTES else 0)
        try:
            await services.loaded(lambda: None, 1000)
            await services.loaded(lambda: None, 1000, WORKBOOK_BYTES)
        finally:
            held.end()
            services.close()

    for most, status in ((WORKBOOK_BYTES // 2, 413), (2 * WORKBOOK_BYTES, 503)):
        with pytest.raises(RequestProblem) as refused:
            asyncio.run(scene(most))
        assert refused.value.type.status == status


def test_each_way_of_a_workbook_reserves_its_memory(serve):
    """The least memory is less than a workbook needs: each route refuses it, and no other."""
    kind, content = WORKBOOKS["xlsx"]
    with serve(max_worker_bytes=100_000_000) as server, httpx.Client(timeout=600) as client:
        for method, path in (
            ("PUT", "/v1/robots/office?name=office&convention=standard"),
            ("POST", "/v1/robots?name=office&convention=standard"),
            ("POST", "/v1/convert-dh?to=modified&convention=standard"),
            ("POST", "/v1/dh-to-urdf?convention=standard"),
        ):
            url = server.address + path
            answer = client.request(method, url, content=content, headers={"content-type": kind})
            assert answer.status_code == 413, path
            assert "does not fit on this service" in answer.json()["detail"]
            script = (DEGREES + ROBOT).format(letters="a").encode()
            plain = {"content-type": "text/plain"}
            answer = client.request(method, url, content=script, headers=plain)
            assert answer.status_code in (200, 201), answer.text
            client.delete(f"{server.address}/v1/robots/office")
