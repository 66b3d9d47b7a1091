"""The shipped library: ``robots/library/*.yaml``, each a D-H table or a reference to a URDF.

A D-H file is a table as users write it, with ``title`` and ``source`` besides. A reference names
a ``urdf`` below example-robot-data, its default ``tip`` (and ``base``), and where the same arm is
also there as a table its ``twin``, with the link ``twin_tip`` that the table's tip stands for.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pinocchio as pin
from ruamel.yaml import YAML

from dh_to_urdf import read_yaml
from robots.errors import RobotNotFound
from robots.robot import Robot, robot_from_table, robot_from_urdf

LIBRARY = Path(__file__).parent / "library"
_ID = re.compile(r"[a-z0-9_]{1,64}")


@dataclass(frozen=True, slots=True)
class ShippedFile:
    """Content of a library file besides the geometry.

    Attributes:
        title: Name for people.
        source: Where the numbers come from.
        dof: Number of joints in q.
        urdf: Path below example-robot-data's ``robots`` folder, for references.
        base: Base link, for references.
        tip: Default tip link, for references.
        twin: Id of the D-H robot of the same arm.
        twin_tip: Link that stands for the twin's tip.
    """

    title: str
    source: str
    dof: int
    urdf: str | None = None
    base: str | None = None
    tip: str | None = None
    twin: str | None = None
    twin_tip: str | None = None


@cache
def shipped_ids() -> tuple[str, ...]:
    """Return the ids of the shipped robots whose files are installed, sorted."""
    return tuple(sorted(path.stem for path in LIBRARY.glob("*.yaml") if is_shipped(path.stem)))


def is_shipped(robot_id: str) -> bool:
    """Return True where the library has this robot and the URDF that it refers to."""
    try:
        urdf = shipped_file(robot_id).urdf
    except RobotNotFound:
        return False
    return urdf is None or urdf_path(urdf).is_file()


@cache
def shipped_file(robot_id: str) -> ShippedFile:
    """Return the head of a library file.

    Raises:
        RobotNotFound: There is no such file.
    """
    path = LIBRARY / f"{robot_id}.yaml"
    if _ID.fullmatch(robot_id) is None or not path.is_file():
        raise RobotNotFound(robot_id, ())
    data = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
    keys = ShippedFile.__dataclass_fields__
    found = {key: data[key].strip() for key in keys if isinstance(data.get(key), str)}
    dof = data.get("dof")
    if dof is None:
        dof = sum(
            joint.get("type") not in ("fixed", "F", "f") and "mimic" not in joint
            for joint in data["joints"]
        )
    return ShippedFile(dof=dof, **found)


@cache
def shipped_robot(robot_id: str) -> Robot:
    """Load a shipped robot; the same object on every call.

    Raises:
        RobotNotFound: There is no such robot.
    """
    head = shipped_file(robot_id)
    if head.urdf is None:
        return robot_from_table(read_yaml((LIBRARY / f"{robot_id}.yaml").read_text("utf-8")))
    text = urdf_path(head.urdf).read_bytes()
    # What the files hold besides was looked at when they joined the library.
    return robot_from_urdf(text, base=head.base, tip=head.tip, tell_left_out=False)


def urdf_path(relative: str) -> Path:
    """Return where a URDF of example-robot-data is installed."""
    prefix = next(p for p in Path(pin.__file__).parents if p.name == "cmeel.prefix")
    return prefix / "share" / "example-robot-data" / "robots" / relative
