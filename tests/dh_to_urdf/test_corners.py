import math
import time

import numpy as np
import pytest

from dh_to_urdf import (
    DHError,
    read_mapping,
    read_yaml,
    table_to_urdf,
)
from robots.errors import RobotError
from robots.robot import robot_from_table, robot_from_urdf
from robots.store import RobotStore
from robots.urdf import read_urdf
from tests.cost import within

ROW = {"type": "R", "alpha": 0, "a": 1, "d": 0, "theta": 0}


def table_of(row, **fields):
    return read_mapping({"convention": "dh", "joints": [{**ROW, **row}], **fields})


def test_a_huge_antecedent_is_refused_without_echo():
    text = "convention: khalil\njoints: [{sigma: 0, alpha: 0, d: 0, r: 0, ant: 0x%s}]"
    with pytest.raises(DHError) as caught:
        read_yaml(text % ("f" * 5000))
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    ("row", "fields"),
    [
        ({"offset": -0.0, "theta": -0.0}, {}),
        ({"type": "P", "offset": -0.0, "d": -0.0}, {}),
        ({}, {"base": {"xyz": [0, 0, -0.0]}}),
        ({}, {"tool": {"xyz": [0, -0.0, 0]}}),
    ],
)
def test_a_negative_zero_keeps_its_revision_in_the_store(tmp_path, row, fields):
    robot = robot_from_table(table_of(row, **fields))
    RobotStore(tmp_path).put("r", robot)
    assert RobotStore(tmp_path).get("r").robot.revision == robot.revision


@pytest.mark.parametrize(
    "row", [{"offset": 1e6, "theta": 1e6}, {"type": "P", "offset": 6e5, "d": 6e5}]
)
def test_what_is_stored_can_be_read_again(tmp_path, row):
    try:
        robot = robot_from_table(table_of(row))
    except ValueError:
        return
    RobotStore(tmp_path).put("r", robot)
    RobotStore(tmp_path).get("r")


@pytest.mark.parametrize(
    "extra", ["# " + "]" * 4000 + "\n" + "[" * 4000, 'a: "' + "]" * 2000 + '"\nb: ' + "[" * 2000]
)
def test_deep_yaml_is_refused_at_once(extra):
    started = time.thread_time()
    with pytest.raises(DHError):
        read_yaml(extra)
    assert within(time.thread_time() - started, 2)


def test_merge_keys_do_not_multiply():
    text = "a0: &a0 {x: 1}\n" + "".join(
        f"a{i}: &a{i} {{<<: [*a{i - 1}, *a{i - 1}]}}\n" for i in range(1, 20)
    )
    started = time.thread_time()
    with pytest.raises(DHError):
        read_yaml(text)
    assert within(time.thread_time() - started, 2)


def test_a_fixed_row_does_not_lose_its_offset_in_silence():
    table = table_of({"type": "F", "offset": 0.5})
    assert table.rows[0].offset == 0.0
    assert "offset is ignored" in table.warnings[0]


def test_a_passive_joint_of_a_chain_is_read_with_a_warning():
    row = {"type": "R", "mu": 0, "alpha": 0, "d": 0, "theta": 0, "r": 0}
    table = read_mapping({"convention": "khalil", "joints": [row]})
    assert table.dof == 1
    assert "mu = 0 is a passive joint" in table.warnings[0]


URDF = (
    '<robot name="r">%s<link name="a"/><link name="b"/><joint name="j" type="continuous">'
    '<parent link="a"/><child link="b"/></joint></robot>'
)


def test_a_material_given_twice_is_read_or_refused_by_name():
    material = '<material name="m"><color rgba="1 0 0 1"/></material>'
    try:
        robot_from_urdf(URDF % (material * 2))
    except RobotError as error:
        message = str(error)
    else:
        return
    assert "material 'm'" in message


def test_a_text_with_a_lone_surrogate_is_refused():
    with pytest.raises(RobotError):
        read_urdf(URDF % "\ud800")


def test_a_revision_tells_a_continuous_joint_from_an_unlimited_one():
    assert (
        robot_from_table(table_of({"type": "C"})).revision
        != robot_from_table(table_of({})).revision
    )


def test_a_revision_tells_gamma_from_theta():
    row = {"name": "j", "type": "R", "alpha": 0, "d": 0, "r": 0}
    gamma, theta = ({**row, "theta": 0, "gamma": 0.5}, {**row, "theta": 0.5})
    revisions = {
        robot_from_table(read_mapping({"convention": "khalil", "joints": [r]})).revision
        for r in (gamma, theta)
    }
    assert len(revisions) == 2


def test_a_rod_to_the_tool_is_exact():
    from xml.etree import ElementTree as ET

    xyz = (0.0, 5.960464477539063e-08, 0.4318)
    text = table_to_urdf(table_of({"a": 0}, tool={"xyz": list(xyz)}))
    visual = [
        v for v in ET.fromstring(text).iter("visual") if v.find("material").get("name") == "a"
    ][-1]
    _roll, pitch, yaw = map(float, visual.find("origin").get("rpy").split())
    half = float(visual.find("geometry/cylinder").get("length")) / 2
    x, y, z = map(float, visual.find("origin").get("xyz").split())
    end = (
        x + half * math.cos(yaw) * math.sin(pitch),
        y + half * math.sin(yaw) * math.sin(pitch),
        z + half * math.cos(pitch),
    )
    assert np.abs(np.subtract(end, xyz)).max() < 1e-12


def test_fixed_rows_are_drawn_in_the_standard_convention_as_in_the_modified():
    for convention in ("dh", "mdh"):
        rows = [{**ROW, "a": 0}, {**ROW, "type": "F", "d": 0.5}]
        text = table_to_urdf(read_mapping({"convention": convention, "joints": rows}))
        assert text.count('<material name="d"') == 2, convention


@pytest.mark.parametrize("cell", ["1,234mm", "1,234deg", "(1,234)"])
def test_thousands_are_ambiguous_with_a_unit_too(cell):
    from dh_to_urdf.cells.expressions import CellError, Quantity, parse_cell

    with pytest.raises(CellError, match="two numbers"):
        parse_cell(cell, Quantity.LENGTH if "m" in cell else Quantity.ANGLE)


def test_upright_rotations_are_exact():

    from dh_to_urdf.poses import to_rpy

    c, s = math.cos(1.0), math.sin(1.0)
    p = math.pi / 2 + 5e-13
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ [
        [math.cos(p), 0, math.sin(p)],
        [0, 1, 0],
        [-math.sin(p), 0, math.cos(p)],
    ]
    roll, pitch, yaw = to_rpy(R)
    from scipy.spatial.transform import Rotation

    assert np.abs(Rotation.from_euler("xyz", [roll, pitch, yaw]).as_matrix() - R).max() < 1e-15


@pytest.mark.parametrize("name", ["tool", "base", "modified", "name", "mdh"])
def test_the_name_of_a_robot_in_matlab_is_no_argument(name):
    from dh_to_urdf import read_pasted

    text = (
        f"L(1) = Link('revolute', 'd', 0, 'a', 1, 'alpha', 0);\nr = SerialLink(L, 'name', '{name}')"
    )
    table = read_pasted(text, "standard")
    assert (table.name, table.convention) == (name, "standard")
