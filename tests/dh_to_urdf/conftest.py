"""Random tables, and oracles made of elementary matrices only."""

import math
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
    """Products of one elementary 4x4 matrix a factor, straight from the definitions."""

    turn = staticmethod(turn)
    shift = staticmethod(shift)

    @staticmethod
    def placement(xyz, rpy):
        return shift(*xyz) @ turn("z", rpy[2]) @ turn("y", rpy[1]) @ turn("x", rpy[0])

    @staticmethod
    def link(convention, row, q):
        v = row.sign * q + row.offset
        theta = v if row.type in (JointType.REVOLUTE, JointType.CONTINUOUS) else row.theta
        d = v if row.type is JointType.PRISMATIC else row.d
        about_z, along_z = turn("z", theta), shift(0, 0, d)
        about_x, along_x = turn("x", row.alpha), shift(row.a, 0, 0)
        if convention is Convention.STANDARD:
            return about_z @ along_z @ along_x @ about_x
        if convention is Convention.MODIFIED:
            return along_x @ about_x @ about_z @ along_z
        branch = turn("z", row.gamma) @ shift(0, 0, row.b)
        return branch @ about_x @ along_x @ about_z @ along_z

    @staticmethod
    def values(table, q):
        """One q a row, 0 for fixed rows."""
        values = iter(q)
        return [0.0 if row.type is JointType.FIXED else next(values) for row in table.rows]

    @classmethod
    def frames(cls, table, q):
        """0A_0 (the identity), 0A_1, …, 0A_n."""
        frames = [np.eye(4)]
        for row, value in zip(table.rows, cls.values(table, q), strict=True):
            frames.append(frames[row.parent] @ cls.link(table.convention, row, value))
        return frames

    @classmethod
    def urdf_frames(cls, text, q_by_joint):
        """Placement of every link of a URDF in its root."""
        joints = {joint.find("child").get("link"): joint for joint in ET.fromstring(text)[::-1]}
        joints = {
            joint.find("child").get("link"): joint for joint in ET.fromstring(text).iter("joint")
        }
        frames = {}

        def frame(link):
            if link not in joints:
                return np.eye(4)
            if link not in frames:
                joint = joints[link]
                q = q_by_joint.get(joint.get("name"), 0.0)
                frames[link] = (
                    frame(joint.find("parent").get("link"))
                    @ cls.origin(joint)
                    @ cls._motion(joint, q)
                )
            return frames[link]

        return {link.get("name"): frame(link.get("name")) for link in ET.fromstring(text) if link.tag == "link"}

    @classmethod
    def origin(cls, element):
        origin = element.find("origin")
        if origin is None:
            return np.eye(4)
        return cls.placement(*([float(w) for w in origin.get(k).split()] for k in ("xyz", "rpy")))

    @staticmethod
    def _motion(joint, q):
        """Motion along or about z, the only axis that the writer uses."""
        if joint.get("type") == "fixed":
            return np.eye(4)
        x, y, z = (float(word) for word in joint.find("axis").get("xyz").split())
        assert (x, y, abs(z)) == (0, 0, 1)
        return shift(0, 0, z * q) if joint.get("type") == "prismatic" else turn("z", z * q)
