"""Limits on the size of a URDF.

A URDF within these limits is read and built in a fraction of a second and some megabytes, without
recursion that grows with the robot (tests/robots/urdf/test_limits.py).
"""

MAX_BYTES = 2_000_000
MAX_ELEMENTS = 20_000
"""Elements of the document, including those left out; real robots have up to 4,000."""
MAX_ATTRIBUTES = 32
"""Attributes of one element; real robots have up to 12."""
MAX_DOF = 64
"""Joints of one chain, as Pinocchio's memory grows with their cube; and of a D-H table."""
MAX_JOINTS = 200
"""Joints that move, of a whole robot."""
MAX_LINKS = 300
MAX_SHAPES = 1000
MAX_MATERIALS = 300
MAX_NAME = 128
MAX_NUMBER = 64
"""Characters of one number."""
MAX_MAGNITUDE = 1e6
"""Largest length, angle, mass or moment of inertia."""
MAX_LIMIT = 1e20
"""Largest limit of a joint; what is beyond UNBOUNDED (1e6) stands for no limit."""
