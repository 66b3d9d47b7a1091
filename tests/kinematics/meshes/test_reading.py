"""Meshes as they are read in the process for them, against files whose content is known."""

import errno
import io
import math
import struct
import subprocess
import sys
import zipfile

import coal
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from kinematics.meshes.archived_robot import archived_robot
from kinematics.meshes.hulls import MAX_CORNERS, hull_of
from kinematics.meshes.names import MeshNames
from kinematics.meshes.preparation import SHOWN_TRIANGLES, MeshReader
from robots.errors import InvalidArchive, InvalidMesh
from tests.torture.mesh_files import (
    BOX,
    FACES,
    WRITERS,
    dae,
    glb,
    gltf,
    obj,
    ply,
    stl,
    stl_text,
    urdf,
    zipped,
)

MOST = 20_000_000
SIZE = (0.2, 0.3, 0.4)


@pytest.fixture(scope="module")
def reader():
    found = MeshReader(MOST, 400 << 20, 0)
    yield found
    found.close()


def read_archive(reader, files, **options):
    given = {"urdf": None, "base": None, "tip": None} | options
    with reader.archive(zipped(files)) as archive:
        return archived_robot(archive, **given)


def grid(n, height=lambda x, y: 0 * x):
    """A sheet of 2 (n - 1)² triangles over the unit square."""
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n)))
    k = np.arange(n * n).reshape(n, n)[:-1, :-1].ravel()
    faces = np.concatenate((np.c_[k, k + 1, k + n], np.c_[k + 1, k + n + 1, k + n]))
    return np.c_[x, y, height(x, y)], faces


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_same_box(reader, name):
    mesh, file = reader.mesh(name, WRITERS[name]())
    assert mesh.format == name.rpartition(".")[2]
    assert (mesh.vertices, mesh.triangles, mesh.shown_triangles) == (8, 12, 12)
    assert mesh.watertight
    np.testing.assert_allclose(mesh.lower, (0, 0, 0), atol=1e-7)
    np.testing.assert_allclose(mesh.upper, SIZE, rtol=1e-6)
    assert not mesh.warnings
    shown = trimesh.load_mesh(io.BytesIO(file), file_type="glb")
    assert shown.volume == pytest.approx(math.prod(SIZE), rel=1e-6)
    assert len(mesh.hull.vertices) == 8
    assert mesh.hull.excess == 0.0


def test_the_content_says_the_format_where_the_name_does_not(reader):
    assert reader.mesh("link.stl", ply())[0].format == "ply"
    assert reader.mesh("link", glb())[0].format == "glb"
    assert reader.mesh("LINK.STL", stl())[0].format == "stl"


def test_units_of_collada_count_and_its_axes_stay(reader):
    mesh, _ = reader.mesh("a.dae", dae(BOX * 1000, unit="0.001", up="Y_UP"))
    np.testing.assert_allclose(mesh.upper, SIZE, rtol=1e-9)
    assert "y is up" in mesh.warnings[0]


def test_placements_of_nodes_count_and_mirrored_ones_stay_outward(reader):
    nodes = [{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0], "scale": [-2, 1, 1]}]
    mesh, file = reader.mesh("a.glb", glb(nodes=nodes, scenes=[{"nodes": [0, 1]}]))
    np.testing.assert_allclose(mesh.upper, (5, 0.3, 0.4), rtol=1e-6)
    assert mesh.triangles == 24
    shown = trimesh.load_mesh(io.BytesIO(file), file_type="glb")
    assert shown.volume == pytest.approx(3 * math.prod(SIZE), rel=1e-5)


def test_colours_are_kept(reader):
    materials = [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}]
    meshes = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}]
    _, file = reader.mesh("a.glb", glb(materials=materials, meshes=meshes))
    found = trimesh.load_scene(io.BytesIO(file), file_type="glb")
    (part,) = found.geometry.values()
    assert part.visual.material.main_color.tolist() == [255, 0, 0, 255]


def test_what_is_open_is_said_and_what_has_no_area_is_left_out(reader):
    faces = np.vstack((FACES[:-1], [[0, 0, 1], [2, 2, 2]]))
    mesh, _ = reader.mesh("a.stl", stl(faces=faces))
    assert (mesh.triangles, mesh.watertight) == (11, False)
    assert "not watertight" in mesh.warnings[0]


def test_many_triangles_become_few_and_the_shape_stays(reader):
    vertices, faces = grid(201, lambda x, y: 0.1 * np.sin(6 * x) * np.cos(5 * y))
    mesh, file = reader.mesh("a.stl", stl(vertices, faces))
    assert mesh.triangles == 80_000
    assert SHOWN_TRIANGLES * 0.9 < mesh.shown_triangles <= SHOWN_TRIANGLES
    shown = trimesh.load_mesh(io.BytesIO(file), file_type="glb").vertices
    away = shown[:, 2] - 0.1 * np.sin(6 * shown[:, 0]) * np.cos(5 * shown[:, 1])
    assert np.abs(away).max() < 1e-3


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.stl", b"", "no triangles|damaged"),
        ("a.stl", stl()[:-7], "no triangles|damaged"),
        ("a.stl", stl(count=2**32 - 1), "no triangles|damaged"),
        ("a.stl", stl(np.where(BOX == 0.4, np.nan, BOX)), "no finite number"),
        ("a.obj", obj(BOX * 1e9), "no finite number or beyond"),
        ("a.ply", ply(faces=FACES + 1), "vertex|damaged"),
        ("a.glb", glb(faces=FACES + 1), "vertex|damaged"),
        ("a.dae", dae(faces=FACES + 100), "vertex|damaged|no triangles"),
        ("a.dae", dae(unit="nan"), "unit|no length"),
        ("a.ply", ply()[:-25], "cut off"),
        ("a.ply", ply(counts=(8, 13)), "cut off|damaged"),
        *(
            (name, WRITERS[name](np.where(BOX == 0.4, wrong, BOX)), "no finite number|damaged")
            for name in ("text.stl", "box.obj", "box.ply", "box.glb", "box.dae")
            for wrong in (np.nan, np.inf, -np.inf)
        ),
        ("a.dae", dae(head='<!DOCTYPE COLLADA [<!ENTITY a "b">]>'), "entities"),
        ("a.stl", stl(faces=[[0, 0, 0], [1, 1, 1]]), "without area"),
        ("a.fbx", b"Kaydara FBX", "stl, obj, ply, gltf, glb, dae"),
        ("a.glb", stl_text(), "no glb file"),
    ],
)
def test_broken_files_are_refused_in_a_sentence(reader, name, content, says):
    with pytest.raises(InvalidMesh, match=says):
        reader.mesh(name, content)


@pytest.mark.parametrize("uri", ["box.bin", "/etc/hostname", "file:///etc/hostname", "../x.bin"])
def test_a_file_beside_a_mesh_is_never_opened(reader, uri):
    with pytest.raises(InvalidMesh, match="needs the file"):
        reader.mesh("a.gltf", gltf(uri=uri)[0])


def test_buffers_of_gltf_come_from_the_archive_only(reader):
    document, buffer = gltf(uri="data/box.bin")
    files = {"r.urdf": urdf("m/a.gltf"), "m/a.gltf": document, "m/data/box.bin": buffer}
    found = read_archive(reader, files)
    assert found.robot.meshes[0].triangles == 12
    found = read_archive(reader, files | {"m/a.gltf": gltf(uri="../../box.bin")[0]})
    assert not found.robot.meshes
    assert "is not there" in found.notes[0]


def test_a_process_that_needs_more_memory_than_it_may_is_refused_by_that():
    small = MeshReader(200_000_000, 0, 0)
    try:
        text = b"".join(b"v %d 0 0\nv 0 %d 1\nf 1 2 3\n" % (k, k) for k in range(900_000))
        with pytest.raises(InvalidMesh, match=r"more than the \d+ MB|longer than"):
            small.mesh("a.obj", text)
        assert small.mesh("a.stl", stl())[0].triangles == 12
    finally:
        small.close()


def test_meshes_are_found_where_archives_have_them(reader):
    box = stl()
    cases = {
        # the workspace: packages side by side
        "package://arm_description/meshes/a.stl": "src/arm_description/meshes/a.stl",
        # the package itself, in a folder of another name
        "package://arm/meshes/b.stl": "src/arm_description/meshes/b.stl",
        # relative, upwards within the archive
        "../meshes/c.stl": "src/arm_description/meshes/c.stl",
        # another machine's path
        "file:///home/me/ws/src/arm_description/meshes/d.stl": "src/arm_description/meshes/d.stl",
        "C:\\ws\\arm_description\\meshes\\e.stl": "src/arm_description/meshes/e.stl",
        # where case did not matter
        "../meshes/F.STL": "src/arm_description/meshes/f.stl",
        "../meshes/my%20mesh.stl": "src/arm_description/meshes/my mesh.stl",
    }
    files = dict.fromkeys(cases.values(), box)
    files["src/arm_description/urdf/arm.urdf"] = urdf(*cases)
    found = read_archive(reader, files)
    assert not found.notes
    assert len(found.robot.meshes) == len(cases)
    names = MeshNames("src/arm_description/urdf/arm.urdf", files)
    for filename, path in cases.items():
        assert names.file_of(filename) == path


@pytest.mark.parametrize(
    "filename",
    [
        "../../../etc/hostname",
        "file:///etc/hostname",
        "/etc/hostname",
        "package://../a.stl",
        "a.stl",
    ],
)
def test_names_outside_the_archive_are_missing(reader, filename):
    found = read_archive(reader, {"r.urdf": urdf(filename), "x/a.stl": stl(), "y/a.stl": stl()})
    assert not found.robot.meshes
    assert "not in the archive" in found.notes[0]


def test_the_urdf_is_found_or_named(reader):
    with pytest.raises(InvalidArchive, match=r"no \.urdf"):
        read_archive(reader, {"readme.txt": "x"})
    two = {"a/x.urdf": urdf(name="x"), "b/y.urdf": urdf(name="y")}
    with pytest.raises(InvalidArchive, match=r"2 URDFs: 'a/x\.urdf', 'b/y\.urdf'"):
        read_archive(reader, two)
    assert read_archive(reader, two, urdf="y.urdf").robot.name == "y"
    assert read_archive(reader, {"r.xml": urdf(name="z"), "package.xml": "<a/>"}).robot.name == "z"
    with pytest.raises(InvalidArchive, match=r"'z\.urdf'"):
        read_archive(reader, two, urdf="z.urdf")


def test_one_bad_mesh_leaves_the_others(reader):
    files = {
        "r.urdf": urdf("a.stl", "b.stl", "c.stl"),
        "a.stl": stl(),
        "b.stl": b"x",
        "c.stl": stl(),
    }
    found = read_archive(reader, files)
    assert [mesh.name for mesh in found.robot.meshes] == ["a.stl", "c.stl"]
    (note,) = found.notes
    assert "mesh 'b.stl' is left out" in note


def test_millimetres_are_noticed_unless_the_urdf_scales_them(reader):
    files = {"a.stl": stl(BOX * 1000)}
    (note,) = read_archive(reader, files | {"r.urdf": urdf("a.stl")}).notes
    assert "probably in mm" in note
    scaled = urdf("a.stl", scale=' scale="0.001 0.001 0.001"')
    assert not read_archive(reader, files | {"r.urdf": scaled}).notes


@pytest.mark.parametrize("seed", range(5))
def test_hulls_are_those_of_scipy_and_accepted_by_coal(seed):
    points = np.random.default_rng(seed).normal(size=(300, 3)) * [1, 2, 0.1]
    hull = hull_of(points)
    oracle = ConvexHull(points)
    assert len(hull.vertices) == len(oracle.vertices)
    solid = trimesh.Trimesh(hull.vertices, hull.triangles)
    assert solid.volume == pytest.approx(oracle.volume, rel=1e-9)
    assert solid.is_watertight
    vertices, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    vertices.extend(list(hull.vertices))
    triangles.extend([coal.Triangle(*map(int, one)) for one in hull.triangles])
    assert coal.Convex(vertices, triangles).num_points == len(hull.vertices)


def test_a_hull_with_many_corners_gets_a_simpler_one_about_it():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(20_000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull = hull_of(points)
    assert len(ConvexHull(points).vertices) > MAX_CORNERS
    assert len(hull.vertices) < 1.5 * MAX_CORNERS
    equations = ConvexHull(hull.vertices).equations
    heights = equations[:, :3] @ points.T + equations[:, 3:]
    assert heights.max() <= 0.0
    farthest = np.linalg.norm(hull.vertices, axis=1).max() - 1
    assert farthest < hull.excess < 0.03


@pytest.mark.parametrize(
    ("points", "corners"),
    [
        (np.c_[grid(5)[0][:, :2], np.full(25, 0.3)], 4),
        (np.outer(np.linspace(0, 1, 7), [1, 2, 3]), 2),
        (np.array([[1.0, 2.0, 3.0]] * 3), 1),
        (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), 3),
        (BOX * [1, 1, 1e-13], None),
    ],
)
def test_flat_meshes_have_flat_hulls(points, corners):
    hull = hull_of(points)
    assert corners is None or len(hull.vertices) == corners
    size = np.ptp(points, axis=0).max() + 1e-300
    assert (hull.vertices.min(axis=0) <= points.min(axis=0) + 1e-8 * size).all()
    assert (hull.vertices.max(axis=0) >= points.max(axis=0) - 1e-8 * size).all()


def test_a_zip_that_lies_about_sizes_is_no_way_around_the_limit(reader):
    content = bytearray(zipped({"r.urdf": urdf("a.stl"), "a.stl": b"\0" * 30_000_000}))
    size = struct.pack("<I", 30_000_000)
    assert content.count(size) == 2
    found = bytes(content).replace(size, struct.pack("<I", 500))
    with reader.archive(found) as archive:
        robot = archived_robot(archive, None, None, None)
    assert not robot.robot.meshes
    assert "left out" in robot.notes[0]


SHUT = """
import os, socket
os.dup(1)  # as the worker's answers
from kinematics.meshes.tasks import MeshTask, parted
from kinematics.meshes.worker import prepare
work = prepare()
(answer,) = work(MeshTask(MESH, (), "a.obj", 10**6, 100))
assert "mesh" in parted(answer)[0]
for attempt in (lambda: open("/etc/hostname"), socket.socket, os.pipe):
    try:
        attempt()
    except OSError as error:
        print(error.errno)
"""


def test_nothing_can_be_opened_once_a_task_has_begun():
    code = SHUT.replace("MESH", repr(obj()))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert done.stdout.split() == [str(errno.EMFILE)] * 3, done.stderr


def test_entries_of_other_methods_are_named(reader):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("r.urdf", urdf("a.stl"), zipfile.ZIP_LZMA)
        archive.writestr("a.stl", stl(), zipfile.ZIP_BZIP2)
    with (
        reader.archive(packed.getvalue()) as archive,
        pytest.raises(InvalidArchive, match=r"r\.urdf.*deflate"),
    ):
        archived_robot(archive, None, None, None)


def test_a_name_of_several_files_is_ambiguous(reader):
    files = {"r.urdf": urdf("package://w/a.stl"), "x/a.stl": stl(), "y/a.stl": stl()}
    (note,) = read_archive(reader, files).notes
    assert "ambiguous" in note
    assert "'x/a.stl', 'y/a.stl'" in note


def test_the_content_says_which_of_stl_and_obj_a_mesh_is(reader):
    text = trimesh.creation.box().export(file_type="obj")
    solid = trimesh.creation.box().export(file_type="stl_ascii")
    files = {"r.urdf": urdf("a.stl", "b.obj", "c.obj"), "a.stl": text, "b.obj": solid}
    found = read_archive(reader, files | {"c.obj": stl()})
    kinds = {mesh.name: mesh.format for mesh in found.robot.meshes}
    assert kinds == {"a.stl": "obj", "b.obj": "stl", "c.obj": "stl"}
