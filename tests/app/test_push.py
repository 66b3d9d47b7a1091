"""``denavit push``: files and folders of the user, all faults at once, and the first pose."""

import subprocess
import sys

import pytest

from app.push import robots_in
from app.xacro import XacroError, expanded
from tests.app.routes.test_urdf_faults import PLAIN
from tests.conftest import DENAVIT
from tests.robots.urdf.test_faults import THIRTEEN, TOLD

TABLE = """name: pushed_table
convention: standard
joints:
- {name: j1, type: R, alpha: 0, a: 1, d: 0}
"""
JOINTS = "".join(f"<link name='${{n}}_{k}'/>" for k in "ab") + (
    "<joint name='${n}_j' type='revolute'><parent link='${n}_a'/><child link='${n}_b'/>"
    "<origin xyz='0 0 ${0.5*h}'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
)
MACRO = (
    "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>"
    f"<xacro:macro name='arm' params='n h'>{JOINTS}</xacro:macro></robot>"
)
XACRO = (
    "<robot name='pushed' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arg name='name'"
    " default='a'/><xacro:include filename='$(find macros)/arm.xacro'/>"
    "<xacro:arm n='$(arg name)' h='3'/></robot>"
)


@pytest.fixture
def push(server, client):
    def run(*arguments):
        command = [*DENAVIT, "push", *map(str, arguments), "--url", server]
        return subprocess.run(command, capture_output=True, text=True, timeout=300)

    yield run
    for name in ("pushed", "pushed_table"):
        client.delete(f"/v1/robots/{name}")


@pytest.fixture
def workspace(tmp_path):
    for package in ("macros", "arm"):
        (tmp_path / package).mkdir()
        (tmp_path / package / "package.xml").write_text(
            f"<package><name>{package}</name><version>1.0.0</version><description>d</description>"
            "<maintainer email='a@example.org'>m</maintainer><license>MIT</license></package>"
        )
    (tmp_path / "macros" / "arm.xacro").write_text(MACRO)
    (tmp_path / "arm" / "robot.urdf.xacro").write_text(XACRO)
    return tmp_path


def test_a_folder_is_uploaded_and_its_first_poses_shown(push, client, tmp_path):
    (tmp_path / "sub").mkdir()
    odd = PLAIN.replace('name="r"', 'name="pushed"').replace("<axis", '<axis rpy="0 0 0"')
    (tmp_path / "sub" / "arm.urdf").write_text(odd)
    (tmp_path / "arm.yaml").write_text(TABLE)
    (tmp_path / "settings.yaml").write_text("rate: 100\n")
    done = push(tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0].startswith(f"[1/2] {tmp_path}/arm.yaml … robot pushed_table, 1 joints, ")
    assert "  warning: joint 'j': the attribute 'rpy' of <axis> is left out" in lines
    assert any("position: [1.0" in line for line in lines)
    assert any("position: [0.000000000  0.000000000  1.0" in line for line in lines)
    assert client.get("/v1/robots/pushed").json()["dof"] == 1
    again = push(tmp_path / "sub")
    assert again.returncode == 1
    assert "exists already" in again.stdout
    assert push(tmp_path / "sub", "--overwrite").returncode == 0


def test_every_fault_is_shown_with_its_line(push, tmp_path):
    (tmp_path / "arm.urdf").write_text(THIRTEEN)
    done = push(tmp_path / "arm.urdf")
    assert done.returncode == 1
    first, *lines = done.stdout.splitlines()
    assert first.endswith("refused")
    assert [line.split(":")[0].strip() for line in lines[:10]] == [
        f"line {line}" for line, _, _ in TOLD[:10]
    ]
    assert lines[0].endswith("[/robot/joint[@name='j1']/axis]")
    assert lines[10].strip() == "and 2 more"
    assert "1 of 1 not uploaded" in done.stderr


def test_what_is_not_there_or_not_known_is_said(push, tmp_path, free_port):
    (tmp_path / "arm.stl").write_text("solid")
    assert "not known by its ending" in push(tmp_path / "arm.stl").stdout
    (tmp_path / "empty").mkdir()
    assert "no robots there" in push(tmp_path / "empty").stderr
    (tmp_path / "arm.urdf").write_text(PLAIN)
    command = [
        *DENAVIT,
        "push",
        str(tmp_path / "arm.urdf"),
        "--url",
        f"http://127.0.0.1:{free_port}",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 1
    assert "start it: denavit serve" in done.stdout


def test_of_a_workspace_only_robots_are_taken(workspace):
    (workspace / ".git").mkdir()
    (workspace / ".git" / "old.urdf").write_text(PLAIN)
    assert robots_in(workspace) == [workspace / "arm" / "robot.urdf.xacro"]


def test_xacro_is_expanded_where_its_packages_are(workspace):
    text = expanded(workspace / "arm" / "robot.urdf.xacro", ["name:=ur5e"], [])
    assert 'name="ur5e_j"' in text
    assert 'xyz="0 0 1.5"' in text
    with pytest.raises(XacroError, match="xacro fails"):
        expanded(workspace / "macros" / "none.xacro", [], [])


def test_an_argument_of_xacro_is_a_name_and_a_value(workspace):
    with pytest.raises(XacroError, match="name:=ur5e"):
        expanded(workspace / "arm" / "robot.urdf.xacro", ["name=ur5e"], [])


def test_a_workspace_with_xacro_is_uploaded(push, workspace):
    assert push(workspace).returncode == 0


def test_without_xacro_it_is_said_how_to_get_it(workspace, monkeypatch):
    monkeypatch.setitem(sys.modules, "xacrodoc", None)
    words = r"expanded here and never by the service: pip install 'denavit\[xacro\]'"
    with pytest.raises(XacroError, match=words):
        expanded(workspace / "arm" / "robot.urdf.xacro", [], [])
