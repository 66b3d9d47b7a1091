"""SYMORO ``.par`` files -> :class:`DHTable` in the khalil convention.

The format of SYMORO+ and OpenSYMORO (Khalil, Vijayalingam, Khomutenko, Mukhanov, Lemoine and
Ecorchard, *OpenSYMORO: An open-source software package for symbolic modelling of robots*, AIM
2014): NL links, NJ joints and NF frames; one list a parameter, one entry a frame. What the format
lacks (names, limits, which frame is the tool) is read from comments such as
``(* Joint 1: name = 'shoulder', lower = -2, upper = 2 *)``, which SYMORO skips.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from dh_to_urdf.cells.expressions import CellError, Quantity, parse_cell
from dh_to_urdf.cells.notation import rounding_warnings
from dh_to_urdf.cells.values import Values, read_values
from dh_to_urdf.documents.checks import Units
from dh_to_urdf.documents.mapping import DEFAULT_NAME, MAX_ROWS, read_mapping
from dh_to_urdf.documents.placements import read_inertial
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.matrices import link_matrix
from dh_to_urdf.messages import plural, say
from dh_to_urdf.par.inertia import PARAMETERS, from_parameters
from dh_to_urdf.par.text import DYNAMICS, GEOMETRY, ParText, parse_par
from dh_to_urdf.table import Convention, DHTable, JointType

_REQUIRED = ("sigma", "alpha", "d", "theta", "r")
_JOINT_NOTE = re.compile(r"Joint\s+([0-9]{1,4})\s*:\s*(\S.*)", re.DOTALL)
_TOOL_NOTE = re.compile(r"Frame\s+([0-9]{1,4})\s*:\s*tool")
_ITEM = re.compile(r"(\w+)\s*=\s*(?:'([^']*)'|([^',=]+))")
_LIMITS = ("lower", "upper", "velocity", "effort")
_TRUTH = {"0": False, "1": True, "false": False, "true": True}


def read_par(
    text: str | bytes,
    name: str | None = None,
    values: Mapping[str, Any] | None = None,
    *,
    cut_loops: bool = False,
    default_name: str | None = DEFAULT_NAME,
) -> DHTable:
    """Read a ``.par`` file; angles are rad, lengths m.

    In θ of a revolute joint and r of a prismatic one, ``t2``, ``th2``, ``q2`` and ``r3`` are the
    joint variables. Other names (``D3``, ``RL4``) need a value. Inertial values are read of the
    links where all ten are numbers.

    Args:
        text: The file; bytes are UTF-8 or Latin-1.
        name: Name of the robot, instead of that in the file.
        values: Numbers, or texts such as ``450mm``, for the names in the cells.
        cut_loops: Reads the spanning tree of a robot with closed loops: its links and the joints
            that carry them, each independent, without the joints that close a loop.
        default_name: Name for a file that gives none; None requires one.

    Raises:
        DHError: Not a ``.par`` file, a name without a value, or a closed loop.
    """
    par = parse_par(text)
    warnings: list[str] = []
    frames = _frames(par, cut_loops, warnings)
    given = read_values(values)
    notes, tool_frames = _notes(par)
    rows = [_row(par, k, notes.get(k, {})) for k in range(1, frames + 1)]
    for k, row in enumerate(rows, start=1):
        inertial = _inertial(par, k, given, warnings)
        if inertial is not None:
            row["inertial"] = inertial
    _use_elsewhere(par, frames, given)
    document: dict[str, Any] = {"convention": "khalil", "joints": rows, "values": given}
    robot_name = name or par.robot_name
    if robot_name:
        document["name"] = robot_name
    base = _base(par, given)
    if base is not None:
        document["base"] = {"matrix": base}
    table = _with_tool(read_mapping(document, default_name), tool_frames)
    return replace(table, warnings=(*table.warnings, *warnings, *rounding_warnings(table)))


def _frames(par: ParText, cut_loops: bool, warnings: list[str]) -> int:
    """Return the number of frames to read, after checking the lengths of the lists."""
    for key in ("is_floating", "is_mobile"):
        if _TRUTH.get(par.scalars.get(key, "0").lower(), True):
            raise DHError.single(
                (key,),
                say(
                    "{key} is {scalar}: a base that moves is not computed; set {key} = 0"
                    " (and list no link 0) for the arm on a base that stands still",
                    key=key,
                    scalar=quoted(par.scalars[key]),
                ),
            )
    missing = [key for key in _REQUIRED if key not in par.lists]
    if missing:
        raise DHError.single(
            (missing[0],), say("the list {missing} is missing; give it", missing=missing[0])
        )
    counts = {key: _count(par, key) for key in ("NL", "NJ", "NF", "Type")}
    links = counts["NL"] or counts["NJ"] or counts["NF"] or len(par.lists["sigma"])
    joints = counts["NJ"] or links
    frames = counts["NF"] or 2 * joints - links
    if not 1 <= links <= joints <= frames <= MAX_ROWS or frames != 2 * joints - links:
        raise DHError.single(
            ("NF",),
            say(
                "NL = {links}, NJ = {joints}, NF = {frames} fit no robot; NL ≤ NJ, NF ="
                " 2 NJ - NL ≤ {max_rows}",
                links=links,
                joints=joints,
                frames=frames,
                max_rows=MAX_ROWS,
            ),
        )
    for key in GEOMETRY:
        found = len(par.lists.get(key, ()))
        if key in par.lists and found != frames:
            raise DHError.single(
                (key,),
                say(
                    "{key} has {found} entries; NF = {frames} frames need {frames}",
                    key=key,
                    found=found,
                    frames=frames,
                ),
            )
    for key in DYNAMICS:
        found = len(par.lists.get(key, ()))
        if key in par.lists and found != links:
            raise DHError.single(
                (key,),
                say(
                    "{key} has {found} entries; NL = {links} links need {links}",
                    key=key,
                    found=found,
                    links=links,
                ),
            )
    _check_loops(par, links, joints, frames, cut_loops, warnings)
    return links


def _check_loops(
    par: ParText, links: int, joints: int, frames: int, cut_loops: bool, warnings: list[str]
) -> None:
    sigma, mu = par.lists["sigma"], par.lists.get("mu", ["1"] * frames)
    for k, text in enumerate(mu, start=1):
        if text not in ("0", "1"):
            raise DHError.single(
                ("mu",),
                say("entry {k} of mu is {text}; give 1 (moved) or 0", k=k, text=quoted(text)),
            )
    passive = [k for k in range(1, links + 1) if mu[k - 1] == "0" and sigma[k - 1] in ("0", "1")]
    if joints == links:
        if passive:
            warnings.append(
                say(
                    "mu = 0 at {passive}: without a closed loop every joint is independent,"
                    " and is taken so",
                    passive=_joints(passive),
                )
            )
        return
    loops = joints - links
    if not cut_loops:
        raise DHError.single(
            ("NJ",),
            say(
                "the robot has {loops} closed loop{which} (NJ = {joints} joints on NL ="
                " {links} links), whose joints depend on each other; closed loops are"
                " not computed. Ask for the spanning tree with loops=cut: frames"
                " {links_2} to {frames} are left out and every joint is independent",
                loops=loops,
                which="s" if loops > 1 else "",
                joints=joints,
                links=links,
                links_2=links + 1,
                frames=frames,
            ),
        )
    also = (
        say("; {passive}, passive by mu = 0, taken as independent", passive=_joints(passive))
        if passive
        else ""
    )
    warnings.append(
        say(
            "closed loops are cut: {links} and frames {joints} are left out{also}",
            links=_joints(list(range(links + 1, joints + 1))),
            joints=", ".join(map(str, range(joints + 1, frames + 1))),
            also=also,
        )
    )


def _joints(numbers: list[int]) -> str:
    listed = ", ".join(map(str, numbers[:12])) + (", …" if len(numbers) > 12 else "")
    return plural("joint {listed}", "joints {listed}", count=max(1, len(numbers)), listed=listed)


def _count(par: ParText, key: str) -> int | None:
    text = par.scalars.get(key)
    if text is None:
        return None
    if re.fullmatch(r"[0-9]{1,4}", text) is None:
        raise DHError.single(
            (key,), say("{key} is {text}; give an integer", key=key, text=quoted(text))
        )
    return int(text)


def _row(par: ParText, k: int, note: dict[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = dict(note)
    for key in GEOMETRY:
        if key != "mu" and key in par.lists:
            row[key] = par.lists[key][k - 1]
    return row


def _use_elsewhere(par: ParText, frames: int, values: Values) -> None:
    """Accept values for names in the parts of the file that are not read."""
    for key, cells in par.lists.items():
        for cell in cells[frames:] if key in GEOMETRY else cells:
            for word in re.findall(r"[^\W\d_]\w*", cell[:200]):
                values.get(word.replace("_", ""))


def _notes(par: ParText) -> tuple[dict[int, dict[str, Any]], list[int]]:
    """Read the comments on joints, and the frames that they call the tool."""
    notes: dict[int, dict[str, Any]] = {}
    tool_frames = []
    for comment in par.comments:
        tool = _TOOL_NOTE.fullmatch(comment)
        if tool:
            tool_frames.append(int(tool[1]))
        match = _JOINT_NOTE.fullmatch(comment)
        if not match:
            continue
        items = [_ITEM.fullmatch(item.strip()) for item in match[2].split(",")]
        note = copy.deepcopy(notes.get(int(match[1]), {}))
        for item in items:
            if item is None or item[1] not in ("name", "type", "visual", *_LIMITS):
                break
            if item[1] in (note | note.get("limits", {})):
                raise DHError.single(
                    (),
                    say(
                        "the comments on joint {match} say {item} twice; keep one",
                        match=match[1],
                        item=item[1],
                    ),
                )
            word = item[2] if item[2] is not None else item[3].strip()
            if item[1] in _LIMITS:
                note.setdefault("limits", {})[item[1]] = word
            else:
                note[item[1]] = _TRUTH.get(word, word) if item[1] == "visual" else word
        else:
            notes[int(match[1])] = note
    return notes, tool_frames


def _inertial(par: ParText, k: int, values: Values, warnings: list[str]) -> dict[str, Any] | None:
    """Return the inertial of link k as a document, if its ten parameters fit a body."""
    if any(key not in par.lists for key in PARAMETERS):
        return None
    parameters: dict[str, float] = {}
    unknown: list[str] = []
    for key in PARAMETERS:
        text = par.lists[key][k - 1]
        try:
            parameters[key] = parse_cell(text, Quantity.NUMBER, 1.0, values).value
        except CellError:
            unknown.append(text)
    if not unknown and not any(parameters.values()):
        return None
    if unknown:
        if len(unknown) < len(PARAMETERS) or unknown != [f"{key}{k}" for key in PARAMETERS]:
            warnings.append(
                say(
                    "link {k}: its inertial values are left out, since {unknown} is no number",
                    k=k,
                    unknown=quoted(unknown[0]),
                )
            )
        return None
    problems: list[str] = []
    if parameters["M"] == 0.0:
        problems.append(say("a mass of 0 with moments"))
    else:
        body = from_parameters(parameters)
        document = {
            "mass": body.mass,
            "com": list(body.com),
            "inertia": [list(line) for line in body.inertia],
        }
        read_inertial(document, (), Units().length, lambda _, text: problems.append(text))
        if not problems:
            return document
    warnings.append(
        say(
            "link {k}: its inertial values are left out, since no body has them"
            " ({problem}); base parameters of an identification are of this"
            " kind",
            k=k,
            problem=problems[0],
        )
    )
    return None


def _base(par: ParText, values: Values) -> list[list[float]] | None:
    """Read Z, the placement of frame 0, 4x4; lengths in m."""
    if "Z" not in par.lists:
        return None
    cells = par.lists["Z"]
    if len(cells) != 16:
        raise DHError.single(
            ("Z",), say("Z has {count} entries; give the 16 of a 4x4 matrix", count=len(cells))
        )
    numbers = []
    for index, text in enumerate(cells, start=1):
        try:
            cell = parse_cell(text, Quantity.NUMBER, 1.0, values)
        except CellError as error:
            raise DHError.single(
                ("Z",), say("entry {index} of Z {error}", index=index, error=error)
            ) from None
        if cell.variable is not None:
            raise DHError.single(
                ("Z",),
                say("entry {index} of Z is {text}; give a number", index=index, text=quoted(text)),
            )
        numbers.append(cell.value)
    return [numbers[i : i + 4] for i in range(0, 16, 4)]


def _with_tool(table: DHTable, tool_frames: list[int]) -> DHTable:
    """Return the table with its last fixed frames as the tool, if comments say so."""
    rows, tool = table.rows, np.eye(4)
    for k in sorted(tool_frames, reverse=True):
        row = rows[k - 1] if k == len(rows) and k > 1 else None
        if row is None or row.type is not JointType.FIXED:
            return table
        tool = link_matrix(row, Convention.KHALIL, 0.0) @ tool
        parent, rows = row.parent, rows[:-1]
    cut = replace(table, rows=rows, tool=tool)
    if not tool_frames or cut.tip_row != parent:
        return table
    return cut
