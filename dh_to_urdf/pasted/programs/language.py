"""Whether a pasted text is a program, and in which language."""

from __future__ import annotations

import re

from dh_to_urdf.errors import DHError, DHSyntaxError
from dh_to_urdf.pasted.grids import is_latex
from dh_to_urdf.pasted.headings import read_heading
from dh_to_urdf.pasted.placement_notes import without_notes
from dh_to_urdf.pasted.programs.matlab_source import read_matlab
from dh_to_urdf.pasted.programs.python_source import read_python
from dh_to_urdf.pasted.programs.tree import Program

MATRIX = re.compile(
    r"(?:^|[=(\s])\[\s*(?:[-+\d.\[(]|(?:np\.|math\.)?(?:pi|PI|M_PI\w*|sqrt|deg2rad)\b|q\d)"
    r"|\.array\s*\(|^[ \t]*\[|[=(\[]\s*\{\s*['\"]"
    r"|^[ \t]*\{\s*['\"]|\bDataFrame\s*\(",
    re.MULTILINE,
)
"""A matrix in brackets, or a dictionary of columns."""
CALL = re.compile(
    r"\b(?:Link|LinkDH|DHLink|Revolute|Prismatic|RevoluteDH|PrismaticDH|RevoluteMDH|PrismaticMDH"
    r"|SerialLink|DHRobot|rigidBodyJoint|setFixedTransform)\s*\((?!\s*[ijkn]\s*\))"
)
"""A call that makes a link or a robot."""
COLUMNS = re.compile(r"^[ \t]*(?:a|d|alpha|theta)s?[ \t]*=[ \t]*\[", re.MULTILINE | re.IGNORECASE)
PAIRS = re.compile(r"\balpha_?[01][ \t]*:[^\n]{0,200}\ba_?[01][ \t]*:")
"""A dictionary of D-H parameters."""
_PYTHON = re.compile(
    r"^[ \t]*(?:from[ \t]+[\w.]+[ \t]+import|import[ \t]+\w)"
    r"|^[ \t]*(?:def|class)[ \t][^\n]*:[ \t]*$"
    r"|\b(?:RevoluteDH|PrismaticDH|DHRobot|DHLink)\b|\bnp\.|\bself\.\w+[ \t]*=[ \t]*\["
    r"|\(\s*(?:d|a|alpha|theta|offset)[ \t]*=|\b(?:True|False|None)\b|^[ \t]*#|\*\*|\[\[|\],[ \t]*$"
    r"|\b(?:append|extend|insert)\(|^>>> |\bSE3\.(?:Trans|T[xyz])\b|^[ \t]*del[ \t]",
    re.MULTILINE,
)
_PYTHON_ALONE = re.compile(
    r"^[ \t]*(?:from[ \t]+[\w.]+[ \t]+import|import[ \t]+\w|def[ \t]|class[ \t])|\bnp\."
    r"|\b(?:DHRobot|RevoluteDH|PrismaticDH)\b",
    re.MULTILINE,
)
"""What MATLAB never holds."""
_MATLAB = re.compile(
    r"\bSerialLink\b|\b(?:Link|Revolute|Prismatic)[ \t]*\(|\brigidBody"
    r"|\b(?:Revolute|Prismatic)MDH[ \t]*\([ \t]*'|^[ \t]*%|[ \t]%|;[ \t]*$|\.\.\.[ \t]*$"
    r"|^[ \t]*end\b|^[ \t]*(?:function|classdef|syms|clear|clc|close|hold|addpath)\b"
    r"|^[ \t]*\w{1,40}\([\d:end+ ,]{1,40}\)[ \t]*=|\.[*/^]"
    r"|\[[^\],\n\[]{0,60}\d[ \t]{1,20}[-\d]",
    re.MULTILINE,
)


def read_program(text: str) -> Program:
    """Return the syntax tree of a program, in the language that it looks like.

    Raises:
        DHSyntaxError: It is neither Python nor MATLAB, with the line of the fault.
        DHError: It is too long.
    """
    python = sum(1 for _ in _PYTHON.finditer(text))
    matlab = sum(1 for _ in _MATLAB.finditer(text))
    readers = [read_python, read_matlab] if python >= matlab else [read_matlab, read_python]
    try:
        return readers[0](text)
    except DHSyntaxError as error:
        if readers[0] is read_python and _PYTHON_ALONE.search(text):
            raise
        try:
            return readers[1](text)
        except DHError:
            raise error from None


def is_program(text: str) -> bool:
    """Return whether a text makes links or a robot, or holds a matrix or lists in brackets."""
    if is_latex(text):
        return False
    if CALL.search(text):
        return True
    text = without_notes(text)
    lines = [line for line in text.splitlines() if line.strip()]
    piped = sum(line.count("|") >= 2 and line.lstrip()[:1] not in "%#" for line in lines)
    headed = any(
        len(words) > 2 and all(read_heading(word) for word in words)
        for line in lines[:3]
        if line.lstrip()[:1] not in "%#[" and (words := line.split())
    )
    written = MATRIX.search(text) or PAIRS.search(text)
    return written is not None and piped < 2 and not headed
