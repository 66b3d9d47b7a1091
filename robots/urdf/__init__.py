"""The gate for URDF: a text from anyone -> a checked description and a canonical URDF.

urdfdom and other readers accept much that lies (a zero axis, missing limits, two parents, half a
file) and refuse the rest with one and the same message. Everything is therefore checked here, one
thing a module: the text and its encoding, the XML, which elements stand where, numbers and names,
links, joints, and whether they are one tree. What leaves is plain checked values for Pinocchio,
and a canonical text with nothing but those for everybody else. Mesh files are never opened.
"""

from robots.urdf.description import URDFDescription, URDFJoint
from robots.urdf.limits import (
    MAX_BYTES,
    MAX_DOF,
    MAX_ELEMENTS,
    MAX_LINKS,
    MAX_MAGNITUDE,
    MAX_SHAPES,
)
from robots.urdf.reading import read_urdf

__all__ = [
    "MAX_BYTES",
    "MAX_DOF",
    "MAX_ELEMENTS",
    "MAX_LINKS",
    "MAX_MAGNITUDE",
    "MAX_SHAPES",
    "URDFDescription",
    "URDFJoint",
    "read_urdf",
]
