"""Meshes of shipped robots: complete, compressed, cached, and nothing else of the disk."""

import gzip
import hashlib

import pytest

LINK = "/v1/robots/panda_urdf/meshes/panda_description/meshes/visual/link0.dae"


def test_every_visual_mesh_of_the_urdf_is_listed_and_read(client):
    urdf = client.get("/v1/robots/panda_urdf/urdf").text
    lines = client.get("/v1/robots/panda_urdf/meshes").json()["meshes"]
    assert len(lines) == 10
    for line in lines:
        assert line["filename"] in urdf
        answer = client.get("/" + line["href"])
        assert answer.headers["content-encoding"] == "gzip"
        assert len(answer.content) == line["bytes"]
        assert answer.headers["etag"] == f'"{hashlib.sha256(answer.content).hexdigest()}"'


@pytest.mark.scene
def test_a_mesh_is_compressed_for_those_who_take_it_and_kept(client):
    plain = client.get(LINK, headers={"Accept-Encoding": "identity"})
    assert "content-encoding" not in plain.headers
    assert plain.headers["cache-control"] == "public, max-age=86400"
    with client.stream("GET", LINK, headers={"Accept-Encoding": "gzip"}) as packed:
        raw = b"".join(packed.iter_raw())
    assert gzip.decompress(raw) == plain.content
    assert len(raw) < 0.5 * len(plain.content)
    again = client.get(LINK, headers={"If-None-Match": plain.headers["etag"]})
    assert again.status_code == 304


@pytest.mark.parametrize(
    "name",
    [
        "../../../../../etc/passwd",
        "..%2f..%2f..%2fetc%2fpasswd",
        "%2fetc%2fpasswd",
        "panda_description/urdf/panda.urdf",
        "ur_description/meshes/ur5/visual/base.dae",
        "link0.dae%00",
    ],
)
def test_no_other_file_is_read(client, name):
    answer = client.get(f"/v1/robots/panda_urdf/meshes/{name}")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"
    assert "root:" not in answer.text


def test_an_upload_has_no_meshes_whatever_it_names(client):
    urdf = client.get("/v1/robots/panda_urdf/urdf").text
    client.put("/v1/robots/my_panda", content=urdf, headers={"Content-Type": "application/xml"})
    listed = client.get("/v1/robots/my_panda/meshes").json()
    assert listed["meshes"] == []
    assert len(listed["missing"]) == 19
    name = LINK.partition("meshes/")[2]
    assert client.get(f"/v1/robots/my_panda/meshes/{name}").status_code == 404
    client.delete("/v1/robots/my_panda")
