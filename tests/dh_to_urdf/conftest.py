"""Random tables, and oracles made of elementary matrices only."""

import math
from dataclasses import fields
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import strategies as st

from dh_to_urdf import Convention, DHRow, DHTable, Inertial, JointType, Limits

PLANES = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}
NAMES = ("q", "J2", "base_to_frame_0", "frame_1", "tool", "link_1_to_frame_1", "a.b", "épaule", "8")


def turn(axis, angle):
    T = np.eye(4)
    i, j = PLANES[axis]
    T[i, i] = T[j, j] = math.cos(angle)
    T[j, i] = math.sin(angle)
    T[i, j] = -T[j, i]
    return T


def shift(x, y, z):
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


class Elementary:
    """One elementary 4x4 matrix a factor, straight from the definitions."""

    turn = staticmethod(turn)
    shift = staticmethod(shift)

    @staticmethod
    def placement(xyz, rpy):
        return shift(*xyz) @ turn("z", rpy[2]) @ turn("y", rpy[1]) @ turn("x", rpy[0])

    @staticmethod
    def branch(row):
        return turn("z", row.gamma) @ shift(0, 0, row.b)

    @classmethod
    def link(cls, convention, row, q):
        v = row.sign * q + row.offset
        theta = v if row.type in (JointType.REVOLUTE, JointType.CONTINUOUS) else row.theta
        d = v if row.type is JointType.PRISMATIC else row.d
        about_z, along_z = turn("z", theta), shift(0, 0, d)
        about_x, along_x = turn("x", row.alpha), shift(row.a, 0, 0)
        if convention is Convention.STANDARD:
            return about_z @ along_z @ along_x @ about_x
        if convention is Convention.MODIFIED:
            return along_x @ about_x @ about_z @ along_z
        return cls.branch(row) @ about_x @ along_x @ about_z @ along_z

    @classmethod
    def frames(cls, table, q):
        """0A_0 (the identity), 0A_1, …, 0A_n."""
        values = iter(q)
        frames = [np.eye(4)]
        for row in table.rows:
            value = 0.0 if row.type is JointType.FIXED else next(values)
            frames.append(frames[row.parent] @ cls.link(table.convention, row, value))
        return frames

    @classmethod
    def tip(cls, table, q):
        """The placement of the tool of a serial chain in the base."""
        return table.base @ cls.frames(table, q)[-1] @ table.tool

    @classmethod
    def origin(cls, element):
        """The ``<origin>`` below an element of a URDF."""
        origin = element.find("origin")
        if origin is None:
            return np.eye(4)
        return cls.placement(*([float(w) for w in origin.get(k).split()] for k in ("xyz", "rpy")))

    @classmethod
    def urdf_frames(cls, text):
        """Placement of every link of a URDF in its root, all joints at zero."""
        robot = ET.fromstring(text)
        joint_of = {joint.find("child").get("link"): joint for joint in robot.iter("joint")}

        def frame(link):
            if link not in joint_of:
                return np.eye(4)
            joint = joint_of[link]
            return frame(joint.find("parent").get("link")) @ cls.origin(joint)

        return {link.get("name"): frame(link.get("name")) for link in robot.findall("link")}


def numbers(bound):
    """Finite numbers up to a bound; a negative zero is the same table as a zero."""
    return st.floats(-bound, bound, allow_nan=False).map(lambda x: x + 0.0)


ANGLES = st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi]) | numbers(math.pi)
LENGTHS = st.sampled_from([0.0, 0.0, 0.4318, -0.15005, 1.0]) | numbers(2.0)
PLACEMENTS = st.just(np.eye(4)) | st.builds(
    Elementary.placement, st.tuples(*[LENGTHS] * 3), st.tuples(*[ANGLES] * 3)
)
OPTIONAL = st.none() | st.floats(0, 1000).map(abs)


@st.composite
def random_inertials(draw):
    """A body of point masses: every inertia drawn is one that a body can have."""
    points = np.array(draw(st.lists(st.tuples(*[numbers(0.5)] * 3), min_size=4, max_size=4)))
    masses = np.array(draw(st.lists(st.floats(0.1, 5.0), min_size=4, max_size=4)))
    com = masses @ points / masses.sum()
    arms = points - com
    inertia = sum(
        m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, arms, strict=True)
    )
    inertia = (inertia + inertia.T) / 2
    rows = tuple(tuple(float(x) for x in line) for line in inertia)
    return Inertial(float(masses.sum()), tuple(float(x) for x in com), rows)


@st.composite
def random_limits(draw, type_):
    lower = upper = None
    if type_ in (JointType.REVOLUTE, JointType.PRISMATIC) and draw(st.booleans()):
        lower, upper = sorted(draw(st.tuples(numbers(10), numbers(10))))
    return Limits(lower, upper, draw(OPTIONAL), draw(OPTIONAL))


@st.composite
def random_rows(draw, k, name, convention, trees, inertials):
    type_ = draw(st.sampled_from(["revolute", "prismatic", "continuous", "fixed"]).map(JointType))
    turns, fixed = type_ in ("revolute", "continuous"), type_ is JointType.FIXED
    khalil = convention is Convention.KHALIL
    return DHRow(
        name=name,
        type=type_,
        alpha=draw(ANGLES),
        a=draw(LENGTHS),
        d=0.0 if type_ is JointType.PRISMATIC else draw(LENGTHS),
        theta=0.0 if turns else draw(ANGLES),
        parent=draw(st.integers(0, k)) if khalil and trees else k,
        offset=0.0 if fixed else draw(ANGLES if turns else LENGTHS),
        sign=1 if fixed else draw(st.sampled_from([1, -1])),
        limits=draw(random_limits(type_)),
        gamma=draw(ANGLES) if khalil and trees else 0.0,
        b=draw(LENGTHS) if khalil and trees else 0.0,
        inertial=draw(random_inertials()) if inertials else None,
        visual=draw(st.booleans()),
    )


@st.composite
def random_tables(draw, conventions=tuple(Convention), trees=True, inertials=False, max_rows=7):
    convention = draw(st.sampled_from(conventions))
    names = draw(st.permutations(NAMES))[: draw(st.integers(1, max_rows))]
    return DHTable(
        name=draw(st.sampled_from(["r", "my robot", "ur-5.e"])),
        convention=convention,
        rows=tuple(
            draw(random_rows(k, name, convention, trees, inertials)) for k, name in enumerate(names)
        ),
        base=draw(PLACEMENTS),
        tool=draw(PLACEMENTS),
    )


@pytest.fixture(scope="session")
def elementary():
    return Elementary


@pytest.fixture(scope="session")
def tables():
    """Strategy of tables: ``data.draw(tables(conventions=…, trees=…, inertials=…))``."""
    return random_tables


@pytest.fixture(scope="session")
def configurations():
    """Strategy of q for a table."""
    return lambda table: st.lists(numbers(7.0), min_size=table.dof, max_size=table.dof)


@pytest.fixture(scope="session")
def assert_same_table():
    """Equal field by field, and the matrices bit by bit."""

    def check(left, right):
        for field in fields(DHTable):
            a, b = getattr(left, field.name), getattr(right, field.name)
            if isinstance(a, np.ndarray):
                assert a.tobytes() == b.tobytes(), field.name
            else:
                assert a == b, field.name

    return check
