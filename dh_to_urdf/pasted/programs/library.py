"""Names of libraries that programs of robots use: functions, classes, constants."""

from __future__ import annotations

from dh_to_urdf.pasted.programs import bodies, links, numbers, poses, robots

_ARRAYS_TEXT = """
    array asarray matrix mat Matrix eye zeros ones r_ concatenate vstack hstack horzcat vertcat
    column_stack diag inv transpose atleast_2d reshape trinv dot matmul
"""
ARRAYS = frozenset(_ARRAYS_TEXT.split())
"""Functions that make arrays, and of matrices."""
_LISTS_TEXT = """
    list tuple reversed range len enumerate zip fliplr flipud flip numel length deal isempty cat
    size arange sum max min round int symbols symbol Symbol dict repmat numcols numrows exist
    isa isinstance struct
"""
LISTS = frozenset(_LISTS_TEXT.split())
"""Functions of lists, and what else is read."""
COPIES = frozenset(("copy", "deepcopy"))
ONE_NUMBER = frozenset((*numbers.FUNCTIONS, *numbers.SAME, "abs", "fabs"))
CONSTRUCTORS = frozenset((*links.CLASSES, *robots.CLASSES, *bodies.CLASSES))
_OTHER_ROBOTS_TEXT = """
    ERobot Robot ETS ERobot2 Robot2 SerialLinkMDH URDF ELink Link2 PoERobot RobotArm importrobot
    loadrobot CodeGenerator
"""
OTHER_ROBOTS = frozenset(_OTHER_ROBOTS_TEXT.split())
"""Classes of robots that are not made of D-H links."""
KNOWN = frozenset(
    {
        *CONSTRUCTORS,
        *ARRAYS,
        *LISTS,
        *COPIES,
        *ONE_NUMBER,
        *poses.NAMES,
        *OTHER_ROBOTS,
        "atan2",
        "arctan2",
        "hypot",
        "pow",
        "power",
        "super",
        "DataFrame",
        "object",
        "handle",
    }
)
"""Names that stand for a function of a library where the program gives them no value."""
_REACHING_TEXT = """
    exec eval evalc evalin assignin feval globals locals setattr delattr getattr vars compile
    __import__ load run source execfile inputname keyboard importlib cellfun arrayfun
"""
REACHING = frozenset(_REACHING_TEXT.split())
"""Functions that reach variables by texts, or run other texts."""
PURE = frozenset(
    (*ARRAYS, *LISTS, *COPIES, *ONE_NUMBER, *poses.NAMES, "atan2", "arctan2", "hypot", "pow")
)
"""Functions that change nothing."""
