"""Validation of URDF: an untrusted text -> a checked description and a canonical URDF.

urdfdom and other readers accept wrong robots (a zero axis, missing limits, two parents, half a
file) and refuse the rest with one message. Everything is therefore checked here, one aspect a
module: the text and its encoding, the XML, the places of elements, numbers and names, links,
joints, and the tree. The result is checked values for Pinocchio, and a canonical text with those
values only for all other readers. Strict where kinematics depends on it, forgiving elsewhere: what
may be another robot is a fault, and all faults are told at once; what draws, simulates or decorates
is left out and named in a warning. Mesh files are never opened.
"""

from robots.urdf.description import URDFDescription, URDFJoint
from robots.urdf.limits import (
    MAX_BYTES,
    MAX_DOF,
    MAX_ELEMENTS,
    MAX_JOINTS,
    MAX_LINKS,
    MAX_MAGNITUDE,
    MAX_SHAPES,
)
from robots.urdf.reading import read_urdf

__all__ = [
    "MAX_BYTES",
    "MAX_DOF",
    "MAX_ELEMENTS",
    "MAX_JOINTS",
    "MAX_LINKS",
    "MAX_MAGNITUDE",
    "MAX_SHAPES",
    "URDFDescription",
    "URDFJoint",
    "read_urdf",
]
