"""A URDF to damage, tables to store, and forward kinematics that knows nothing of the source."""

import math
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

from dh_to_urdf import read_mapping
from robots.robot import robot_from_table

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="world"/>
  <link name="turret">
    <inertial>
      <origin xyz="0 0 0.1" rpy="0 0 0.3"/>
      <mass value="2.5"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.05"/>
    </inertial>
    <visual>
      <origin xyz="0 0 0.2"/>
      <geometry><mesh filename="package://arm/turret.stl" scale="0.001 0.001 0.001"/></geometry>
      <material name="grey"/>
    </visual>
    <collision><geometry><cylinder radius="0.1" length="0.4"/></geometry></collision>
  </link>
  <link name="boom"/>
  <link name="flange"/>
  <link name="finger"/>
  <joint name="turn" type="continuous">
    <parent link="world"/><child link="turret"/>
    <origin xyz="0.1 0 0.5" rpy="0.1 0.2 0.3"/>
    <axis xyz="0 0 -1"/>
  </joint>
  <joint name="reach" type="prismatic">
    <parent link="turret"/><child link="boom"/>
    <origin xyz="0 0.2 0"/>
    <axis xyz="0 0 2"/>
    <limit lower="0" upper="0.5" effort="100" velocity="1"/>
  </joint>
  <joint name="mount" type="fixed">
    <parent link="boom"/><child link="flange"/>
    <origin rpy="1.5707963267948966 0 0" xyz="0 0 0.1"/>
  </joint>
  <joint name="grip" type="revolute">
    <parent link="flange"/><child link="finger"/>
    <axis xyz="1 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="10" velocity="2"/>
  </joint>
</robot>
"""


def rotation(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4)
    T[:3, :3] += math.sin(angle) * K + (1 - math.cos(angle)) * K @ K
    return T


def translation(xyz):
    T = np.eye(4)
    T[:3, 3] = xyz
    return T


def origin(element):
    found = element.find("origin")
    if found is None:
        return np.eye(4)
    xyz, (roll, pitch, yaw) = (
        [float(word) for word in found.get(key, "0 0 0").split()] for key in ("xyz", "rpy")
    )
    about_z, about_y = rotation((0, 0, 1), yaw), rotation((0, 1, 0), pitch)
    return translation(xyz) @ about_z @ about_y @ rotation((1, 0, 0), roll)


def motion(joint, q):
    if joint.get("type") == "fixed":
        return np.eye(4)
    axis = np.array([float(word) for word in joint.find("axis").get("xyz").split()])
    axis /= np.linalg.norm(axis)
    return translation(q * axis) if joint.get("type") == "prismatic" else rotation(axis, q)


@pytest.fixture(scope="session")
def arm_urdf():
    return ARM


@pytest.fixture(scope="session")
def urdf_frames():
    """Placement of every link of a URDF in its root, for q by joint name."""

    def frames(text, q_by_joint):
        robot = ET.fromstring(text)
        joint_of = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}

        def frame(link):
            if link not in joint_of:
                return np.eye(4)
            joint = joint_of[link]
            q = q_by_joint.get(joint.get("name"), 0.0)
            return frame(joint.find("parent").get("link")) @ origin(joint) @ motion(joint, q)

        return {link.get("name"): frame(link.get("name")) for link in robot.findall("link")}

    return frames


@pytest.fixture(scope="session")
def poses():
    """Placements of frames of a Robot in its base frame, by Pinocchio."""

    def place(robot, q, frames=None):
        data = robot.data()
        pin.framesForwardKinematics(robot.model, data, robot.configuration(np.asarray(q)))
        base = data.oMf[robot.frame_id(robot.base_frame)]
        names = robot.frames if frames is None else frames
        return {
            name: base.actInv(data.oMf[robot.frame_id(name)]).homogeneous.copy() for name in names
        }

    return place


@pytest.fixture(scope="session")
def make_robot():
    """A small robot from a table; ``tool`` tells versions of it apart."""

    def make(tool=0.1, name="probe", dof=3):
        joints = [{"type": "R", "alpha": "pi/2", "a": 0.1 * k, "d": 0.2} for k in range(dof)]
        document = {"name": name, "convention": "dh", "joints": joints}
        return robot_from_table(read_mapping({**document, "tool": {"xyz": [0, 0, tool]}}))

    return make


@pytest.fixture(scope="session")
def assert_same_robot():
    """Equal in everything that is not Pinocchio's."""

    def check(left, right):
        names = ("name", "kind", "revision", "joints", "base_frame", "tip_frame", "frames", "urdf")
        for name in (*names, "warnings"):
            assert getattr(left, name) == getattr(right, name), name

    return check
