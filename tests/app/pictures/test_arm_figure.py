"""Pictures of arms and maps, as a client gets them."""

import io
from xml.etree import ElementTree as ET

import numpy as np
import png
import pytest

from app.pictures.camera import camera_for, view_of
from app.pictures.raster import colored

SVG = "{http://www.w3.org/2000/svg}"


def pixels(content):
    width, height, rows, info = png.Reader(bytes=content).read()
    values = np.vstack([np.asarray(row) for row in rows])
    return values.reshape(height, width, info["planes"]), info


@pytest.mark.scene
def test_a_picture_from_a_query(client):
    answer = client.get("/v1/robots/planar_3r/picture.svg?q=30,-45,60&angle=deg")
    assert answer.headers["content-type"].startswith("image/svg+xml")
    root = ET.fromstring(answer.text)
    texts = [element.text for element in root.iter(f"{SVG}text")]
    assert {"x₀", "z₃", "x tool"} <= set(texts)
    assert any("j2 = -45°" in text for text in texts)
    tip = client.get("/v1/robots/planar_3r/fk?q=30,-45,60&angle=deg").json()
    x, y, _ = tip["poses"]["tool"]["position"]
    assert any(f"tool at ({x:.4f}, {y:.4f}, 0.0000) m" in text for text in texts)


def test_the_joints_stand_where_they_are(client):
    """Joints of a planar arm are circles, as far apart as the links are long, in one scale."""
    root = ET.fromstring(client.get("/v1/robots/planar_3r/picture.svg?q=0.5,-0.8,1").text)
    joints = [
        (float(c.get("cx")), float(c.get("cy")))
        for c in root.iter(f"{SVG}circle")
        if c.get("r") == "7.00"
    ]
    poses = client.get("/v1/robots/planar_3r/fk?q=0.5,-0.8,1&frames=all").json()["poses"]
    places = np.array([poses[f"frame_{k}"]["position"][:2] for k in (1, 2, 3)])
    drawn = np.array(joints)
    ratio = np.linalg.norm(drawn[1] - drawn[0]) / np.linalg.norm(places[1] - places[0])
    expected = drawn[0] + ratio * (places - places[0]) * (1, -1)
    assert np.abs(drawn - expected).max() < 0.02


def test_a_png_shows_the_same_with_its_own_fonts(client):
    body = {"q": [0.3, -0.6, 0.4, 0.2, 0.5, 0], "width": 500, "height": 300}
    named = client.post("/v1/robots/puma560/picture.png", json=body)
    assert named.headers["content-type"] == "image/png"
    with_labels, _ = pixels(named.content)
    assert with_labels.shape[:2] == (300, 500)
    bare = client.post("/v1/robots/puma560/picture.png", json={**body, "labels": False})
    without, _ = pixels(bare.content)
    assert (with_labels != without).any(axis=2).sum() > 100
    assert len(np.unique(with_labels.reshape(-1, with_labels.shape[2]), axis=0)) > 50


def test_several_q_of_a_robot_in_the_body(client):
    rows = [
        {"type": "R", "alpha": "pi/2", "a": 0, "d": 0.3},
        {"type": "R", "alpha": 0, "a": 0.5, "d": 0},
    ]
    table = {"name": "arm", "convention": "standard", "joints": rows}
    body = {"robot": table, "q": [[0, 0], [0.2, 0.4], [0.4, 0.8]], "frames": "none"}
    root = ET.fromstring(client.post("/v1/picture.svg", json=body).text)
    assert len(root.findall(f".//{SVG}polyline[@opacity='0.30']")) >= 4


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"view": "top"}, "/view"),
        ({"width": 10}, "/width"),
        ({"frames": ["elbow"]}, "/frames/0"),
        ({"q": [[0, 0, 0]] * 33}, "/q"),
        ({"q": [0, 0]}, "/q"),
    ],
)
def test_what_cannot_be_drawn_is_refused(client, change, pointer):
    body = {"q": [0, 0, 0], **change}
    answer = client.post("/v1/robots/planar_3r/picture.svg", json=body)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == pointer
    assert answer.headers["content-type"] == "application/problem+json"


def test_no_other_form(client):
    answer = client.get("/v1/robots/planar_3r/picture.svg?q=0,0,0&format=json")
    assert answer.status_code == 422


@pytest.mark.scene
def test_maps_as_numbers_and_pictures(client):
    cloud = client.post("/v1/robots/panda/workspace", json={"samples": 500})
    assert np.array(cloud.json()["points"]).shape == (500, 3)
    array = np.load(
        io.BytesIO(client.get("/v1/robots/panda/workspace?samples=500&format=npy").content)
    )
    assert np.array_equal(array, np.array(cloud.json()["points"]))
    heat = "planar_3r/manipulability-map?q=0,0,0&joints=j2,j3&task=xy"
    for path in ("panda/workspace?samples=900", heat):
        answer = client.get(f"/v1/robots/{path}&format=png")
        assert answer.headers["content-type"] == "image/png"
        shown, _ = pixels(answer.content)
        assert len(np.unique(shown.reshape(-1, shown.shape[2]), axis=0)) > 100


def test_a_followed_path_as_png(client):
    body = {
        "q": [0.3, 0.4, 0.5],
        "target": {"position": [0.5, 0.5, 0]},
        "task": "xy",
        "samples": 11,
    }
    answer = client.post("/v1/robots/planar_3r/path?format=png", json=body)
    assert answer.headers["content-type"] == "image/png"
    assert pixels(answer.content)[0].shape[1] > 300


def test_cameras_look_at_the_plane_of_planar_arms():
    z, turns = np.array([[0.0, 0, 1]] * 3), np.ones(3, dtype=bool)
    assert view_of(z, turns) == "xy"
    assert view_of(np.roll(z, 1, axis=1), turns) == "yz"
    assert view_of(z, np.array([True, True, False])) == "iso"
    assert view_of(np.array([[0.0, 0, 1], [0, 1, 0]]), np.ones(2, dtype=bool)) == "iso"


@pytest.mark.parametrize("view", ["iso", "xy", "xz", "yz"])
def test_every_point_is_in_the_box(view):
    points = np.random.default_rng(0).normal(size=(50, 3))
    camera = camera_for(view, points, (10, 20, 300, 200))
    assert np.abs(camera.rows @ camera.rows.T - np.eye(3)).max() < 1e-15
    assert np.linalg.det(camera.rows) == pytest.approx(1)
    seen = camera.place(points)
    assert (seen >= (10 - 1e-9, 20 - 1e-9)).all()
    assert (seen <= (310 + 1e-9, 220 + 1e-9)).all()


def test_colours_grow_lighter():
    grey = colored(np.linspace(0, 1, 50)) @ (0.299, 0.587, 0.114)
    assert (np.diff(grey) > 0).all()


def revolute(count, **cells):
    return [
        {"type": "R", "alpha": 90 * (k % 2), "a": 0.1, "d": 0.02, **cells, "name": f"j{k}"}
        for k in range(count)
    ]


TREE = """<robot name="tree"><link name="base"/><link name="a"/><link name="b"/><link name="c"/>
<link name="end"/><joint name="lift" type="prismatic"><parent link="base"/><child link="a"/>
<origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.4" effort="1" velocity="1"/></joint>
<joint name="left" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0 0.2 0.1"/></joint>
<joint name="right" type="continuous"><parent link="a"/><child link="c"/>
<origin xyz="0 -0.2 0.1"/></joint>
<joint name="hand" type="fixed"><parent link="b"/><child link="end"/>
<origin xyz="0.3 0 0.2"/></joint></robot>"""
ODD = {
    "tiny": revolute(3, a=1e-3, d=2e-3),
    "huge": revolute(3, a=3e3, d=2e3),
    "without lengths": revolute(3, a=0, d=0),
    "thin": [*revolute(1, d=5.0), *revolute(2, a=0.01)[1:]],
    "64 joints": revolute(64),
    "slides": [{"type": "P", "alpha": 90, "a": 0, "theta": 0}] * 3,
    "long names": [
        {**row, "name": f"a_very_long_name_of_joint_{k}"} for k, row in enumerate(revolute(12))
    ],
}


def drawn(client, body):
    answer = client.post("/v1/picture.svg?angle=deg", json=body)
    assert answer.status_code == 200, answer.text
    assert "nan" not in answer.text
    return ET.fromstring(answer.text)


def boxes(root):
    """x, y, half width and half height of each text, by the widest estimate of its font."""
    found = []
    for element in root.iter(f"{SVG}text"):
        size = float(element.get("font-size"))
        wide = 0.6 * size * len(element.text)
        x = float(element.get("x")) + (0 if element.get("text-anchor") == "middle" else wide / 2)
        found.append((element.text, x, float(element.get("y")) - 4, wide / 2, 0.45 * size))
    return found


@pytest.mark.parametrize("size", [(640, 480), (300, 240)])
@pytest.mark.parametrize("name", [*ODD, "tree", "talos"])
def test_odd_robots_can_be_read(name, size, client):
    """No text upon another or out of the picture; the arm fills what is left of it."""
    robot = {
        "name": "odd",
        "convention": "standard",
        "units": {"angle": "deg"},
        "joints": ODD.get(name),
    }
    dof = len(ODD.get(name, [0] * 3))
    body = {"robot": robot, "q": [0.3, 0.4, 0.5] if name == "slides" else [20] * dof}
    if name == "tree":
        body["robot"] = {"urdf": TREE}
    elif name == "talos":
        dof = client.get("/v1/robots/talos").json()["dof"]
        body = {"robot": "talos", "q": [0] * dof, "frames": "all"}
    root = drawn(client, {**body, "width": size[0], "height": size[1]})
    found = boxes(root)
    for text, x, y, wide, tall in found:
        assert wide - 2 <= x <= size[0] - wide + 2, text
        assert tall - 2 <= y <= size[1] - tall + 2, text
    for k, (text, x, y, wide, tall) in enumerate(found):
        for other, u, v, half, high in found[k + 1 :]:
            # Captions stand on lines of their own, as close as lines are.
            apart = max(abs(x - u) - wide - half, abs(y - v) - 0.9 * (tall + high))
            assert apart > -1, (text, other)
    # In a plane that is seen from its side, or as a bundle of arrows, one extent is enough.
    lines = [line for line in root.iter(f"{SVG}polyline") if line.get("stroke") != "#dddddd"]
    bones = [
        np.array([pair.split(",") for pair in line.get("points").split()], dtype=float)
        for line in lines
    ]
    extents = np.ptp(np.concatenate(bones), axis=0) / size
    assert extents.max() > 0.4, extents


def test_links_of_a_urdf_are_drawn(client):
    root = drawn(client, {"robot": {"urdf": TREE}, "q": [0.1, 20, 30]})
    bones = [line for line in root.iter(f"{SVG}polyline") if line.get("stroke") == "#7a8794"]
    assert len(bones) == 4


def test_a_long_caption_says_that_it_is_cut(client):
    root = drawn(
        client,
        {
            "robot": {"name": "odd", "convention": "standard", "joints": ODD["long names"]},
            "q": [0] * 12,
        },
    )
    texts = [element.text for element in root.iter(f"{SVG}text")]
    assert sum("very_long" in text for text in texts) == 3
    assert any(text.endswith("…") for text in texts)
