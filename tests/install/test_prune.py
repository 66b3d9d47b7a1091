"""What is removed from site-packages, and that it is removed from no other environment."""

import sys
from pathlib import Path

import pytest

from robots.meshes import meshes_of
from robots.shipped import LIBRARY, shipped_ids, urdf_path

URDF = (
    '<robot><link><visual><geometry><mesh filename="package:///example-robot-data/robots/'
    'arm/meshes/seen.stl"/></geometry></visual><collision><geometry>'
    '<mesh filename="package://example-robot-data/robots/arm/meshes/hull.stl"/></geometry>'
    "</collision></link></robot>"
)


@pytest.fixture
def prune(script):
    return script("prune")


@pytest.fixture
def site(tmp_path):
    """Packages of an environment, some files of each kind."""
    prefix = tmp_path / "site" / "cmeel.prefix"
    files = {
        "include/boost/any.hpp": "header",
        "bin/tool": "tool",
        "lib/cmake/arm/armConfig.cmake": "build",
        "lib/python3.11/site-packages/pinocchio/__init__.py": "code",
        "lib/libarm.a": "static",
        "lib/libarm.so": "library",
        "lib/libarm.so.6": "library",
        "lib/libarm.so.6.0.5": "library",
        "lib/libother.so": "another",
        "lib64/libz.so": "z",
        "lib64/libz.so.1": "z",
        "lib64/pkgconfig/zlib.pc": "build",
        "share/doc/arm/index.html": "text",
        "share/example-robot-data/robots/arm/urdf/arm.urdf": URDF,
        "share/example-robot-data/robots/arm/LICENSE": "terms",
        "share/example-robot-data/robots/arm/meshes/seen.stl": "mesh",
        "share/example-robot-data/robots/arm/meshes/hull.stl": "mesh",
        "share/example-robot-data/robots/other/urdf/other.urdf": URDF,
        "../numpy/__init__.py": "code",
        "../numpy/lib/tests/test_io.py": "test",
        "../numpy/testing/__init__.py": "code",
        "../numpy.libs/libgfortran.so.5": "fortran",
        "../scipy.libs/libgfortran.so.5": "fortran",
        "../scipy.libs/libopenblas.so": "blas",
        "../unknown/tests/data.py": "code",
        "../arm-1.0.dist-info/RECORD": "list",
    }
    for name, text in files.items():
        path = prefix / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "site"


@pytest.fixture
def library(tmp_path):
    folder = tmp_path / "library"
    folder.mkdir()
    (folder / "arm.yaml").write_text("name: arm\nurdf: arm/urdf/arm.urdf\ntip: hand\n")
    (folder / "table.yaml").write_text("name: table\nconvention: modified\n")
    return folder


def test_what_nobody_reads_goes_and_the_rest_stays(prune, site, library):
    prune.prune(site, library)
    left = {path.relative_to(site).as_posix() for path in site.rglob("*") if not path.is_dir()}
    robots = "cmeel.prefix/share/example-robot-data/robots"
    assert left == {
        "cmeel.prefix/lib/python3.11/site-packages/pinocchio/__init__.py",
        "cmeel.prefix/lib/libarm.so",
        "cmeel.prefix/lib/libarm.so.6",
        "cmeel.prefix/lib/libarm.so.6.0.5",
        "cmeel.prefix/lib/libother.so",
        "cmeel.prefix/lib64/libz.so",
        "cmeel.prefix/lib64/libz.so.1",
        f"{robots}/arm/urdf/arm.urdf",
        f"{robots}/arm/LICENSE",
        f"{robots}/arm/meshes/seen.stl",
        "numpy/__init__.py",
        "numpy/testing/__init__.py",
        "numpy.libs/libgfortran.so.5",
        "scipy.libs/libgfortran.so.5",
        "scipy.libs/libopenblas.so",
        "unknown/tests/data.py",
        "arm-1.0.dist-info/RECORD",
    }


def test_copies_become_links_to_the_file_with_the_whole_name(prune, site, library):
    for _ in range(2):  # the second time finds links
        prune.prune(site, library)
        lib = site / "cmeel.prefix" / "lib"
        assert not (lib / "libarm.so.6.0.5").is_symlink()
        assert (lib / "libarm.so").readlink() == Path("libarm.so.6.0.5")
        assert (lib / "libarm.so.6").readlink() == Path("libarm.so.6.0.5")
        assert not (lib / "libother.so").is_symlink()
        linked = [path for path in site.glob("*.libs/*") if path.is_symlink()]
        assert len(linked) == 1
        assert linked[0].read_text() == "fortran"


def test_a_file_that_is_linked_elsewhere_keeps_its_content(prune, site, library, tmp_path):
    """As uv links the files of its cache into an environment."""
    cached = tmp_path / "cached"
    cached.hardlink_to(site / "cmeel.prefix" / "lib" / "libarm.so")
    prune.prune(site, library)
    assert cached.read_text() == "library"


def test_a_library_that_names_a_missing_file_is_told(prune, site, library):
    (library / "gone.yaml").write_text("urdf: gone/gone.urdf\n")
    with pytest.raises(SystemExit, match=r"not installed: .*gone\.urdf"):
        prune.prune(site, library)
    assert (site / "numpy" / "lib" / "tests" / "test_io.py").exists()


@pytest.mark.parametrize("prefix", ["/usr", "/usr/local", sys.base_prefix, "elsewhere/.venv"])
def test_no_other_environment_is_pruned(prune, prefix, tmp_path):
    with pytest.raises(SystemExit, match="nothing is removed"):
        prune.site_packages(tmp_path / prefix, tmp_path / prefix / "lib")


def test_no_folder_outside_the_environment_is_pruned(prune, tmp_path):
    with pytest.raises(SystemExit, match="nothing is removed"):
        prune.site_packages(prune.ROOT / ".venv", tmp_path)
    own = prune.ROOT / ".venv" / "lib"
    assert prune.site_packages(prune.ROOT / ".venv", own) == own


def test_every_file_that_the_service_reads_of_a_shipped_robot_is_kept(prune):
    robots = urdf_path(".")
    kept = prune.robot_files(robots, prune.named_urdfs(LIBRARY))
    read = {mesh.path for name in shipped_ids() for mesh in meshes_of(name).values()}
    assert len(read) > 400
    assert read <= kept
