"""Meshes of one's own over HTTP: in a zip with the URDF, and one by one; kept, listed, deleted."""

import gzip
import hashlib
import io
import subprocess
import zipfile

import httpx
import pytest
import trimesh

from app.mesh_bundle import bundled
from tests.conftest import DENAVIT, PATIENCE, running_server
from tests.torture.mesh_files import BOX, WRITERS, dae, stl, urdf, zipped

ZIP = {"Content-Type": "application/zip"}
XML = {"Content-Type": "application/xml"}
FILES = {
    "my_arm/urdf/arm.urdf": urdf("package://my_arm/meshes/link.dae", name="boxy"),
    "my_arm/meshes/link.dae": dae(),
}


@pytest.fixture
def boxy(client):
    """A robot that came with its mesh."""
    answer = client.post("/v1/robots", content=zipped(FILES), headers=ZIP)
    assert answer.status_code == 201, answer.text
    yield answer.json()
    client.delete("/v1/robots/boxy")


@pytest.fixture
def bare(client):
    """A robot whose meshes are missing."""
    text = urdf("package://p/a/link.stl", "package://p/b/link.stl", "package://p/b/tool.stl")
    answer = client.put("/v1/robots/bare", content=text, headers=XML)
    assert answer.status_code == 201
    yield answer.json()
    client.delete("/v1/robots/bare")


def test_a_zip_brings_robot_and_meshes(client, boxy):
    assert boxy["id"] == "boxy"
    assert not boxy["warnings"]
    (line,) = boxy["meshes"]
    assert line["filename"] == "package://my_arm/meshes/link.dae"
    assert (line["format"], line["triangles"], line["links"]) == ("dae", 12, ["arm"])
    assert line["bounds"]["upper"] == pytest.approx([0.2, 0.3, 0.4])
    assert client.get("/v1/robots/boxy/meshes").json() == {"meshes": [line], "missing": []}
    plain = {"Accept-Encoding": "identity"}
    answer = client.get("/" + line["href"], headers=plain)
    assert answer.headers["content-type"] == "model/gltf-binary"
    assert answer.headers["cache-control"] == "private, no-cache"
    assert len(answer.content) == line["bytes"]
    assert answer.headers["etag"] == f'"{hashlib.sha256(answer.content).hexdigest()}"'
    assert trimesh.load_mesh(io.BytesIO(answer.content), file_type="glb").is_watertight
    again = client.get("/" + line["href"], headers={"If-None-Match": answer.headers["etag"]})
    assert again.status_code == 304
    with client.stream("GET", "/" + line["href"], headers={"Accept-Encoding": "gzip"}) as packed:
        assert gzip.decompress(b"".join(packed.iter_raw())) == answer.content


def test_a_robot_with_meshes_computes_as_without(client, boxy, bare):
    answer = client.get("/v1/robots/boxy/fk?q=0.5").json()
    assert answer["poses"] == client.get("/v1/robots/bare/fk?q=0.5").json()["poses"]


def test_put_of_a_zip_replaces_the_robot_and_its_meshes(client, boxy):
    other = {"r.urdf": urdf("a.stl", name="boxy"), "a.stl": stl()}
    answer = client.put("/v1/robots/boxy?overwrite=true", content=zipped(other), headers=ZIP).json()
    assert [line["filename"] for line in answer["meshes"]] == ["a.stl"]
    assert answer["revision"] != boxy["revision"]
    plain = client.put(
        "/v1/robots/boxy?overwrite=true", content=urdf("a.stl", name="boxy"), headers=XML
    )
    assert plain.status_code == 200
    listed = client.get("/v1/robots/boxy/meshes").json()
    assert listed == {"meshes": [], "missing": ["a.stl"]}


def test_meshes_are_put_one_by_one_by_their_name_or_its_end(client, bare):
    missing = ["p/a/link.stl", "p/b/link.stl", "p/b/tool.stl"]
    assert client.get("/v1/robots/bare/meshes").json() == {"meshes": [], "missing": missing}
    base = "/v1/robots/bare/meshes"
    first = client.put(f"{base}/tool.stl", content=stl())
    assert first.status_code == 201
    assert first.headers["location"] == f"{base}/p/b/tool.stl"
    assert first.json()["filename"] == "package://p/b/tool.stl"
    assert client.put(f"{base}/package://p/a/link.stl", content=stl()).status_code == 201
    assert client.put(f"{base}/package:/p/b/link.stl", content=stl()).status_code == 201
    assert client.put(f"{base}/tool.stl", content=WRITERS["box.ply"]()).status_code == 200
    listed = client.get(base).json()
    assert [line["format"] for line in listed["meshes"]] == ["stl", "stl", "ply"]
    assert listed["missing"] == []
    several = client.put(f"{base}/link.stl", content=stl())
    assert several.status_code == 422
    assert several.json()["type"].endswith("/ambiguous-mesh")
    assert "p/a/link.stl" in several.json()["detail"]
    assert client.delete(f"{base}/tool.stl").status_code == 204
    assert client.get(f"{base}/tool.stl").status_code == 404
    assert client.get(base).json()["missing"] == ["p/b/tool.stl"]


def test_a_mesh_changes_the_revision_of_its_robot_and_gives_it_back(client, bare):
    client.put("/v1/robots/bare/meshes/tool.stl", content=stl())
    changed = client.get("/v1/robots/bare")
    assert changed.json()["revision"] != bare["revision"]
    client.delete("/v1/robots/bare/meshes/tool.stl")
    assert client.get("/v1/robots/bare").json()["revision"] == bare["revision"]


def test_conditions_on_a_mesh_hold_for_it_and_its_robot(client, bare):
    path = "/v1/robots/bare/meshes/tool.stl"

    def status(method, **conditions):
        headers = {name.replace("_", "-"): value for name, value in conditions.items()}
        content = stl() if method == "PUT" else None
        answer = client.request(method, path, content=content, headers=headers)
        if answer.status_code == 412:
            assert answer.json()["type"].endswith("/revision-mismatch")
        return answer.status_code

    revision = f'"{bare["revision"]}"'
    assert status("PUT", If_Match='"wrong"') == 412
    assert status("PUT", If_Match="*") == 412
    assert status("PUT", If_None_Match=revision) == 412
    assert client.get(path).status_code == 404
    assert status("PUT", If_Match=revision, If_None_Match="*") == 201
    mesh = client.get(path).headers["etag"]
    for method in ("PUT", "DELETE"):
        for wrong in (
            {"If_Match": revision},
            {"If_Match": '"wrong"'},
            {"If_None_Match": "*"},
            {"If_None_Match": f"{revision}, {mesh}"},
        ):
            assert status(method, **wrong) == 412, (method, wrong)
    assert status("PUT", If_Match=mesh) == 200
    assert status("PUT", If_Match="*", If_None_Match=revision) == 200
    assert status("DELETE", If_Match=client.get("/v1/robots/bare").headers["etag"]) == 204


def test_what_is_doubtful_of_a_mesh_is_said(client, bare):
    answer = client.put("/v1/robots/bare/meshes/tool.stl", content=stl(BOX * 1000)).json()
    assert "probably in mm" in answer["warnings"][0]
    french = client.put("/v1/robots/bare/meshes/tool.stl?lang=fr", content=stl(BOX * 1000)).json()
    assert "mm" in french["warnings"][0]
    assert french["warnings"] != answer["warnings"]


@pytest.mark.parametrize(
    ("method", "path", "content", "status", "kind"),
    [
        ("PUT", "/v1/robots/bare/meshes/other.stl", b"x", 404, "mesh-not-found"),
        ("PUT", "/v1/robots/bare/meshes/tool.stl", b"x", 422, "invalid-mesh"),
        ("PUT", "/v1/robots/bare/meshes/tool.stl", b"", 422, "invalid-mesh"),
        ("PUT", "/v1/robots/panda_urdf/meshes/link0.dae", b"x", 409, "read-only-robot"),
        ("DELETE", "/v1/robots/panda_urdf/meshes/link0.dae", None, 409, "read-only-robot"),
        ("PUT", "/v1/robots/nobody/meshes/a.stl", b"x", 404, "robot-not-found"),
        ("DELETE", "/v1/robots/bare/meshes/tool.stl", None, 404, "mesh-not-found"),
        ("PUT", "/v1/robots/puma560/meshes/a.stl", b"x", 409, "read-only-robot"),
    ],
)
def test_refusals(client, bare, method, path, content, status, kind):
    answer = client.request(method, path, content=content)
    assert answer.status_code == status
    assert answer.json()["type"].endswith(f"/{kind}")


@pytest.mark.parametrize(
    ("content", "query", "says"),
    [
        (b"PK\x03\x04 nothing", "", "no zip archive"),
        (zipped({"readme": "x"}), "", "no .urdf"),
        (zipped({"a.urdf": urdf(), "b.urdf": urdf()}), "", "?urdf="),
        (zipped({"a.urdf": urdf()}), "?urdf=c.urdf", "c.urdf"),
    ],
)
def test_archives_that_are_refused(client, content, query, says):
    answer = client.post(f"/v1/robots{query}", content=content, headers=ZIP)
    assert answer.status_code == 422
    assert answer.json()["type"].endswith("/invalid-archive")
    assert says in answer.json()["detail"]


def test_a_bad_urdf_of_an_archive_is_refused_as_any(client):
    content = zipped({"a.urdf": urdf().replace("<axis", '<axis rpy="1"').replace("0 0 0.5", "x")})
    answer = client.post("/v1/robots", content=content, headers=ZIP)
    assert answer.status_code == 422
    assert answer.json()["type"].endswith("/invalid-urdf")


PATH = {
    "q": [0.1],
    "waypoints": [{"position": [0.49, 0.05]}, {"position": [0.4, 0.3]}],
    "task": "xy",
    "link_geometry": "urdf",
    "obstacles": [{"type": "sphere", "center": [0, 1, 0.5], "radius": 0.1}],
}


def test_hulls_count_for_clearances_and_it_is_said(client, boxy):
    answer = client.post("/v1/robots/boxy/path", json=PATH)
    assert answer.status_code == 200, answer.text
    (part,) = answer.json()["links"]  # the collision shapes alone
    assert (part["link"], part["shape"]) == ("arm", "mesh")
    assert any("convex hulls" in one for one in answer.json()["warnings"])


def test_meshes_survive_a_restart_and_go_with_their_robot(tmp_path):
    with running_server(tmp_path) as (address, _):
        made = httpx.post(
            f"{address}/v1/robots", content=zipped(FILES), headers=ZIP, timeout=PATIENCE
        )
        (line,) = made.json()["meshes"]
        content = httpx.get(f"{address}/{line['href']}").content
    kept = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert {path.name for path in kept} == {"boxy.json", "robots.lock"}
    with running_server(tmp_path) as (address, _):
        assert httpx.get(f"{address}/{line['href']}").content == content
        listed = httpx.get(f"{address}/v1/robots/boxy/meshes").json()["meshes"]
        assert listed == [line]
        assert httpx.get(f"{address}/v1/robots/boxy").json()["revision"] == made.json()["revision"]
        assert httpx.delete(f"{address}/v1/robots/boxy").status_code == 204
        assert httpx.get(f"{address}/{line['href']}").status_code == 404
    assert not any((tmp_path / "robots").iterdir())


def test_limits_and_quotas_hold_for_meshes(serve):
    with serve(max_mesh_bytes=2_000, max_archive_bytes=5_000, max_stored_bytes=8_000) as server:
        url = server.address
        put = {"content": urdf("a.stl", name="r"), "headers": XML}
        assert httpx.put(f"{url}/v1/robots/r", **put).status_code == 201
        large = httpx.put(f"{url}/v1/robots/r/meshes/a.stl", content=stl() + b"\0" * 2_000)
        assert large.status_code == 413
        archive = httpx.post(f"{url}/v1/robots", content=b"\0" * 5_001, headers=ZIP)
        assert archive.status_code == 413
        answers = [
            httpx.put(f"{url}/v1/robots/r/meshes/a.stl", content=stl(), timeout=PATIENCE),
            *(httpx.put(f"{url}/v1/robots/r{k}", **put) for k in range(9)),
        ]
        assert answers[0].status_code == 201
        assert {one.status_code for one in answers[1:]} <= {201, 409}
        assert answers[-1].json()["type"].endswith("/quota-reached")
        before = httpx.get(f"{url}/v1/robots/r").json()["revision"]
        packed = zipped({"r.urdf": urdf("a.stl", name="q"), "a.stl": stl()})
        refused = httpx.post(f"{url}/v1/robots", content=packed, headers=ZIP, timeout=PATIENCE)
        assert refused.json()["type"].endswith("/quota-reached")
        assert httpx.get(f"{url}/v1/robots/r").json()["revision"] == before


def test_push_takes_the_meshes_along(server, client, tmp_path):
    package = tmp_path / "ws" / "my_arm"
    (package / "urdf").mkdir(parents=True)
    (package / "meshes").mkdir()
    names = ("package://my_arm/meshes/a.stl", "../meshes/b.obj", "package://gone/c.stl")
    (package / "urdf" / "arm.urdf").write_text(urdf(*names, name="pushed_boxy"))
    (package / "meshes" / "a.stl").write_bytes(stl())
    (package / "meshes" / "b.obj").write_bytes(WRITERS["box.obj"]())
    command = [*DENAVIT, "push", str(package), "--url", server]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "'package://gone/c.stl'" in done.stdout
        listed = client.get("/v1/robots/pushed_boxy/meshes").json()
        assert {line["format"] for line in listed["meshes"]} == {"stl", "obj"}
        assert listed["missing"] == ["gone/c.stl"]
        again = subprocess.run(
            [*command, "--no-meshes", "--overwrite"], capture_output=True, text=True, timeout=300
        )
        assert again.returncode == 0
        assert client.get("/v1/robots/pushed_boxy/meshes").json()["meshes"] == []
    finally:
        client.delete("/v1/robots/pushed_boxy")


def test_push_takes_only_meshes_along(tmp_path):
    (tmp_path / "id_rsa").write_text("secret")
    (tmp_path / "a.stl").write_bytes(stl())
    text = urdf("id_rsa", f"file://{tmp_path}/id_rsa", "a.stl").encode()
    packed = bundled(tmp_path / "r.urdf", text)
    assert packed is not None
    assert zipfile.ZipFile(io.BytesIO(packed)).namelist() == ["r.urdf", "a.stl"]
    assert bundled(tmp_path / "r.urdf", urdf("id_rsa").encode()) is None
