"""Meshes of one's own on the page: a zip is opened, stored and drawn."""

import numpy as np
import pytest

from tests.torture.mesh_files import BOX, FACES, glb, stl, urdf, zipped

NAME = "boxed_arm"
RED = [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}]
COLOURED = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}]


@pytest.fixture
def archive(tmp_path, client):
    file = tmp_path / f"{NAME}.zip"
    meshes = {"red.glb": glb(materials=RED, meshes=COLOURED), "grey.stl": stl(BOX * 2)}
    file.write_bytes(zipped({"arm.urdf": urdf(*meshes, name=NAME)} | meshes))
    yield file
    client.delete(f"/v1/robots/{NAME}")


def test_a_zip_is_stored_and_its_meshes_are_drawn(open_page, client, archive):
    visit = open_page("robot=puma560")
    asked = []
    visit.page.on("response", lambda r: asked.append(r.url) if "/meshes/" in r.url else None)
    visit.page.locator("input[type=file]").set_input_files(str(archive))
    # one for the visual, one for the collision where the page draws that
    visit.page.wait_for_function("() => document.querySelector('.host')?.probe?.meshes() >= 2")
    listed = client.get(f"/v1/robots/{NAME}/meshes").json()
    assert [line["format"] for line in listed["meshes"]] == ["stl", "glb"]
    assert {url.rpartition("/")[2] for url in asked} >= {"red.glb", "grey.stl"}
    assert f"robot={NAME}" in visit.page.url


def test_meshes_of_a_stored_robot_are_drawn(open_page, client):
    n = 60
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(0, 0.4, n), np.linspace(0, 0.4, n)))
    k = np.arange(n * n).reshape(n, n)[:-1, :-1].ravel()
    faces = np.concatenate((np.c_[k, k + 1, k + n], np.c_[k + 1, k + n + 1, k + n]))
    sheet = stl(np.c_[x, y, 0.05 * np.sin(20 * x)], faces)
    files = {"a.urdf": urdf("a.stl", "b.stl", name=NAME), "a.stl": sheet, "b.stl": stl(faces=FACES)}
    made = client.post(
        "/v1/robots", content=zipped(files), headers={"Content-Type": "application/zip"}
    )
    assert made.status_code == 201
    try:
        visit = open_page(f"robot={NAME}")
        visit.page.wait_for_function("() => document.querySelector('.host')?.probe?.meshes() >= 2")
    finally:
        client.delete(f"/v1/robots/{NAME}")
