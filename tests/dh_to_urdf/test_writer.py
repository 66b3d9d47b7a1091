import io
import math
from collections import Counter
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from yourdfpy import URDF

from dh_to_urdf import Convention, DHRow, DHTable, JointType, Limits, read_mapping, table_to_urdf

TURNING = (JointType.REVOLUTE, JointType.CONTINUOUS)


class Pinocchio:
    """A URDF in Pinocchio, with q in the order of the table's rows."""

    def __init__(self, table, **options):
        self.model = pin.buildModelFromXML(table_to_urdf(table, **options))
        self.data = self.model.createData()
        moving = [row.name for row in table.rows if row.type is not JointType.FIXED]
        self.columns = [self.model.joints[self.model.getJointId(name)].idx_v for name in moving]

    def configuration(self, q):
        v = np.zeros(self.model.nv)
        v[self.columns] = q
        return pin.integrate(self.model, pin.neutral(self.model), v)

    def frames(self, q, names):
        pin.framesForwardKinematics(self.model, self.data, self.configuration(q))
        ids = [self.model.getFrameId(name, pin.FrameType.BODY) for name in names]
        return [self.data.oMf[i].homogeneous for i in ids]

    def mass_matrix(self, q):
        M = pin.crba(self.model, self.data, self.configuration(q))
        M = np.triu(M) + np.triu(M, 1).T
        return M[np.ix_(self.columns, self.columns)]


def joints_of(text):
    return {joint.get("name"): joint for joint in ET.fromstring(text).iter("joint")}


@settings(deadline=None, max_examples=60)
@given(st.data())
def test_every_frame_of_the_table_is_a_link_of_the_urdf(tables, configurations, elementary, data):
    table = data.draw(tables())
    q = data.draw(configurations(table))
    frames = elementary.frames(table, q)
    names = ["base_link", *(f"frame_{k}" for k in range(len(frames))), "tool"]
    found = Pinocchio(table).frames(q, names)
    assert np.array_equal(found[0], np.eye(4))
    expected = [table.base @ T for T in frames]
    assert np.abs(np.subtract(found[1:-1], expected)).max() < 1e-12
    assert np.abs(found[-1] - expected[table.tip_row] @ table.tool).max() < 1e-12


def test_reference_robots_agree_in_pinocchio(oracle_documents):
    for robot, document in oracle_documents:
        table = read_mapping(document)
        loaded = Pinocchio(table)
        names = [*(f"frame_{k}" for k in range(table.dof + 1)), "tool"]
        for config in robot["configs"]:
            found = loaded.frames(config["q"], names)
            expected = [*config["fkine_all"], config["fkine"]]
            assert np.abs(np.subtract(found, expected)).max() < 1e-12


def mass_matrix(table, q, frames):
    """Sum over the links of JᵀMJ, with Jacobians written column by column."""
    moving = [k for k, row in enumerate(table.rows, 1) if row.type is not JointType.FIXED]
    total = np.zeros((len(moving), len(moving)))
    for k, row in enumerate(table.rows, 1):
        chain, frame = [], k
        while frame:
            chain.append(frame)
            frame = table.rows[frame - 1].parent
        com = frames[k] @ [*row.inertial.com, 1.0]
        linear, angular = np.zeros((3, len(moving))), np.zeros((3, len(moving)))
        for column, joint in enumerate(moving):
            if joint not in chain:
                continue
            mover = table.rows[joint - 1]
            on_axis = frames[mover.parent if table.convention is Convention.STANDARD else joint]
            z = mover.sign * on_axis[:3, 2]
            if mover.type in TURNING:
                linear[:, column] = np.cross(z, com[:3] - on_axis[:3, 3])
                angular[:, column] = z
            else:
                linear[:, column] = z
        R = frames[k][:3, :3]
        inertia = R @ np.array(row.inertial.inertia) @ R.T
        total += row.inertial.mass * linear.T @ linear + angular.T @ inertia @ angular
    return total


@settings(deadline=None, max_examples=40)
@given(st.data())
def test_masses_move_with_frame_k(tables, configurations, elementary, data):
    table = data.draw(tables(inertials=True))
    assume(table.dof)
    q = data.draw(configurations(table))
    expected = mass_matrix(table, q, elementary.frames(table, q))
    found = Pinocchio(table).mass_matrix(q)
    assert np.abs(found - expected).max() < 1e-12 * (1 + np.abs(expected).max())


def test_mass_and_centre_of_mass_are_those_of_the_table(elementary):
    joints = [
        {
            "type": "R",
            "theta": 0,
            "d": 0.4,
            "a": 0.3,
            "alpha": "-90deg",
            "inertial": {"mass": 3, "com": [-0.1, 0.2, 0.05]},
        },
        {
            "type": "P",
            "theta": "30deg",
            "d": "q2 + 0.2",
            "a": 0.1,
            "alpha": "20deg",
            "inertial": {"mass": 1.5, "com": [0, 0, -0.3]},
        },
        {
            "type": "F",
            "theta": 1,
            "d": 0.2,
            "a": 0,
            "alpha": 0,
            "inertial": {"mass": 0.5, "com": [0.01, 0, 0]},
        },
    ]
    table = read_mapping({"convention": "dh", "base": {"xyz": [1, 2, 3]}, "joints": joints})
    q = [0.7, 0.25]
    frames = elementary.frames(table, q)
    moments = [
        row.inertial.mass * (table.base @ T @ [*row.inertial.com, 1.0])[:3]
        for row, T in zip(table.rows, frames[1:], strict=True)
    ]
    loaded = Pinocchio(table)
    com = pin.centerOfMass(loaded.model, loaded.data, loaded.configuration(q))
    assert pin.computeTotalMass(loaded.model) == 5.0
    assert np.abs(com - sum(moments) / 5.0).max() < 1e-15


def coarse(table, placement):
    """The table in steps of 1/64: yourdfpy takes placements within 1e-8 of none for none."""
    columns = ("alpha", "a", "d", "theta", "offset", "gamma", "b")
    rows = [
        replace(row, **{column: round(getattr(row, column) * 64) / 64 for column in columns})
        for row in table.rows
    ]
    return replace(table, rows=tuple(rows), base=placement, tool=placement)


@settings(deadline=None, max_examples=30)
@given(st.data())
def test_an_independent_reader_agrees(tables, elementary, data):
    table = coarse(data.draw(tables()), elementary.placement((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)))
    steps = st.integers(-500, 500)
    q = [k / 64 for k in data.draw(st.lists(steps, min_size=table.dof, max_size=table.dof))]
    text = table_to_urdf(table)
    robot = URDF.load(io.BytesIO(text.encode()), load_meshes=False, build_scene_graph=True)
    assert robot.validate(), robot.errors
    moving = [row.name for row in table.rows if row.type is not JointType.FIXED]
    assert sorted(robot.actuated_joint_names) == sorted(moving)
    robot.update_cfg(dict(zip(moving, q, strict=True)))
    frames = elementary.frames(table, q)
    found = [robot.get_transform(f"frame_{k}", "base_link") for k in range(len(frames))]
    assert np.abs(np.subtract(found, [table.base @ T for T in frames])).max() < 1e-12
    tool = table.base @ frames[table.tip_row] @ table.tool
    assert np.abs(robot.get_transform("tool", "base_link") - tool).max() < 1e-12


def segments_of_table(table, elementary):
    """Where lines along a and d run at q = 0, in base_link."""
    frames = elementary.frames(table, np.zeros(table.dof))
    for k, row in enumerate(table.rows, 1):
        start, end = table.base @ frames[row.parent], table.base @ frames[k]
        if row.visual and table.convention is Convention.STANDARD:
            d = row.offset if row.type is JointType.PRISMATIC else row.d
            corner = start @ elementary.shift(0, 0, d)
            yield start[:3, 3], corner[:3, 3]
            yield corner[:3, 3], end[:3, 3]
        elif row.visual:
            foot = start @ elementary.branch(row)
            corner = foot @ elementary.shift(row.a, 0, 0)
            yield foot[:3, 3], corner[:3, 3]
            yield corner[:3, 3], end[:3, 3]


def segments_of_urdf(text, elementary):
    frames = elementary.urdf_frames(text)
    for link in ET.fromstring(text).findall("link"):
        for visual in link.findall("visual"):
            if visual.find("material").get("name") == "joint":
                continue
            half = float(visual.find("geometry/cylinder").get("length")) / 2
            T = frames[link.get("name")] @ elementary.origin(visual)
            yield tuple((T @ elementary.shift(0, 0, z))[:3, 3] for z in (-half, half))


def distance(left, right):
    """Between two segments whose ends may be given in either order."""
    return min(np.abs(np.subtract(left, ends)).max() for ends in (right, right[::-1]))


@settings(deadline=None, max_examples=40)
@given(st.data())
def test_rods_run_along_a_and_d_from_frame_to_frame(tables, elementary, data):
    table = replace(data.draw(tables()), tool=np.eye(4))
    assume(
        table.convention is not Convention.STANDARD
        or all(row.type is not JointType.FIXED for row in table.rows)
    )
    drawn = list(segments_of_urdf(table_to_urdf(table), elementary))
    segments = list(segments_of_table(table, elementary))
    for ends in segments:
        if np.ptp(ends, axis=0).max() > 2e-8:  # shorter ones need not be drawn
            assert min(distance(ends, rod) for rod in drawn) < 1e-12
    for rod in drawn:
        assert min(distance(ends, rod) for ends in segments) < 1e-12


@settings(deadline=None, max_examples=30)
@given(st.tuples(*[st.floats(-2, 2)] * 3))
def test_a_rod_runs_from_the_last_frame_to_the_tool(elementary, xyz):
    assume(np.linalg.norm(xyz) > 1e-3)
    row = DHRow("j", JointType.REVOLUTE, 0.0, 0.0, 0.0, 0.0, parent=0)
    table = DHTable("r", Convention.STANDARD, (row,), tool=elementary.shift(*xyz))
    (rod,) = segments_of_urdf(table_to_urdf(table), elementary)
    assert distance(rod, (np.zeros(3), xyz)) < 1e-7


def test_cylinders_have_positive_sizes_even_where_lengths_are_negative():
    row = {"type": "R", "alpha": 0, "a": -0.5, "d": -0.3}
    text = table_to_urdf(read_mapping({"convention": "dh", "joints": [row, row]}))
    cylinders = list(ET.fromstring(text).iter("cylinder"))
    assert len(cylinders) == 6
    assert all(float(c.get("length")) > 0 and float(c.get("radius")) > 0 for c in cylinders)


def test_nothing_is_drawn_without_visuals_or_for_rows_that_say_so():
    row = {"type": "R", "alpha": 0, "a": 0.5, "d": 0.3}
    document = {"convention": "dh", "joints": [row, {**row, "visual": False}]}
    table = read_mapping(document)
    bare = ET.fromstring(table_to_urdf(table, visuals=False))
    assert not list(bare.iter("visual"))
    assert not list(bare.iter("material"))
    drawn = ET.fromstring(table_to_urdf(table))
    with_visual = [e.get("name") for e in drawn.findall("link") if e.find("visual") is not None]
    assert with_visual == ["link_1"]


@settings(deadline=None, max_examples=25)
@given(st.data())
def test_names_are_unique_whatever_the_joints_are_called(tables, data):
    robot = ET.fromstring(table_to_urdf(data.draw(tables(max_rows=9))))
    for tag in ("link", "joint"):
        assert max(Counter(e.get("name") for e in robot.findall(tag)).values()) == 1


def test_a_long_chain_of_clashing_names_is_still_unique(elementary):
    names = ("base_to_frame_0", "base_to_frame_0_", "frame_2_to_tool", "link_1_to_frame_1")
    rows = [{"name": name, "type": "R", "alpha": 1, "a": 1, "d": 1} for name in names]
    table = read_mapping({"convention": "dh", "joints": rows})
    frames = elementary.frames(table, [0.1, 0.2, 0.3, 0.4])
    found = Pinocchio(table).frames([0.1, 0.2, 0.3, 0.4], ["tool"])
    assert np.abs(found[0] - frames[-1]).max() < 1e-14


@settings(deadline=None)
@given(
    st.tuples(*[st.floats(-1e6, 1e6)] * 2).map(sorted),
    st.floats(0, 1e6).map(abs),
    st.tuples(*[st.floats(-1e6, 1e6)] * 3),
)
def test_numbers_are_written_with_all_their_digits(bounds, velocity, xyz):
    limits = Limits(bounds[0], bounds[1], velocity, velocity / 3)
    row = DHRow("j", JointType.REVOLUTE, 0.0, 0.0, 0.0, 0.0, parent=0, limits=limits)
    tool = np.eye(4)
    tool[:3, 3] = xyz
    joints = joints_of(table_to_urdf(DHTable("r", Convention.MODIFIED, (row,), tool=tool)))
    written = {key: float(value) for key, value in joints["j"].find("limit").items()}
    assert written == {
        "lower": limits.lower,
        "upper": limits.upper,
        "velocity": limits.velocity,
        "effort": limits.effort,
    }
    words = joints["frame_1_to_tool"].find("origin").get("xyz").split()
    assert tuple(map(float, words)) == xyz


NEAR_UPRIGHT = st.builds(
    lambda sign, tilt: sign * math.pi / 2 + tilt,
    st.sampled_from([1, -1]),
    st.sampled_from([0.0, 1e-16, 1e-9, -1e-8, 1e-4]) | st.floats(-1e-6, 1e-6),
)


@settings(deadline=None, max_examples=300)
@given(st.floats(-math.pi, math.pi), NEAR_UPRIGHT, st.floats(-math.pi, math.pi))
def test_rotations_survive_as_rpy_at_a_pitch_of_ninety_degrees(elementary, roll, pitch, yaw):
    tool = elementary.placement((0, 0, 0), (roll, pitch, yaw))
    row = DHRow("j", JointType.REVOLUTE, 0.0, 0.0, 0.0, 0.0, parent=0)
    joints = joints_of(table_to_urdf(DHTable("r", Convention.MODIFIED, (row,), tool=tool)))
    written = elementary.origin(joints["frame_1_to_tool"])
    upright = abs(math.cos(pitch)) < 1.1e-12  # only roll ± yaw is determined
    assert np.abs(written - tool).max() < (1e-12 if upright else 1e-15)


@pytest.mark.parametrize(
    ("row", "type_", "limit"),
    [
        ({"type": "R"}, "continuous", {"effort": 1e6, "velocity": 1e6}),
        ({"type": "C"}, "continuous", {"effort": 1e6, "velocity": 1e6}),
        (
            {"type": "R", "limits": {"velocity": 2, "effort": 3}},
            "continuous",
            {"effort": 3, "velocity": 2},
        ),
        (
            {"type": "R", "limits": {"lower": -1, "upper": 2}},
            "revolute",
            {"effort": 1e6, "velocity": 1e6, "lower": -1, "upper": 2},
        ),
        ({"type": "P"}, "prismatic", {"effort": 1e6, "velocity": 1e6, "lower": -1e6, "upper": 1e6}),
        (
            {"type": "P", "limits": {"lower": 0, "upper": 0.5, "velocity": 1}},
            "prismatic",
            {"effort": 1e6, "velocity": 1, "lower": 0, "upper": 0.5},
        ),
    ],
)
def test_every_moving_joint_has_the_limits_that_urdf_demands(row, type_, limit):
    row = {"name": "j", "alpha": 0, "a": 0, "d": 0, "theta": 0, "sign": -1, **row}
    joint = joints_of(table_to_urdf(read_mapping({"convention": "dh", "joints": [row]})))["j"]
    assert joint.get("type") == type_
    assert {key: float(value) for key, value in joint.find("limit").items()} == limit
    assert joint.find("axis").get("xyz") == "0 0 -1"
