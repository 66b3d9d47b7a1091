"""The exercises as their files declare them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import msgspec
from ruamel.yaml import YAML

from app.http.problems import NOT_FOUND, RequestProblem
from dh_to_urdf.messages import say
from kinematics.checking.question import Quantity
from robots.errors import hint

Steps = tuple[float, float, float]
"""From, to (both included) and the step between the values that are drawn."""


class Part(msgspec.Struct, forbid_unknown_fields=True, kw_only=True, frozen=True):
    """One question of an exercise.

    Attributes:
        name: Its name.
        quantity: What is asked.
        marks: What a right answer is worth.
        index: Number of a matrix.
        frame: Frame; default the tip.
        reference_frame: Of a Jacobian.
        task: Rows of a Jacobian, or what of a target counts.
        euler: Sequence of angles.
        both: Whether both triples are asked.
        shape: What of a pose is asked: ``rotation``, ``xyz`` or ``xy``; default all.
        formula: Whether it is asked for every q.
        convention: Of the table that is meant, where it is another than that of the robot.
        solutions: ``all`` or ``any``.
        z: Whether the motion in the null space is added.
    """

    name: str
    quantity: Quantity
    marks: float
    index: int | None = None
    frame: str | None = None
    reference_frame: str | None = None
    task: str | None = None
    euler: str | None = None
    both: bool = False
    shape: str | None = None
    formula: bool = False
    convention: str | None = None
    solutions: str | None = None
    z: bool = False


class Declaration(msgspec.Struct, forbid_unknown_fields=True, kw_only=True, frozen=True):
    """One exercise.

    Attributes:
        robot: A document of a table, in degrees, with names for lengths.
        lengths: What these are drawn from, m.
        q: What joint values are drawn from, degrees.
        parts: The questions.
        delta_x: What the wanted motion is drawn from, m.
        z: What the wanted joint motion is drawn from, degrees.
        singular: Whether the posture may be singular.
    """

    robot: dict[str, Any]
    lengths: dict[str, Steps]
    q: list[Steps]
    parts: list[Part]
    delta_x: list[Steps] = []
    z: list[Steps] = []
    singular: bool = False

    @property
    def marks(self) -> float:
        """Return what all parts are worth together."""
        return sum(part.marks for part in self.parts)


def read_yaml_file(folder: str, name: str) -> Any:
    """Return what a file of this package holds."""
    text = (files("app.exercises") / folder / f"{name}.yaml").read_text(encoding="utf-8")
    return YAML(typ="safe", pure=True).load(text)


@cache
def exercises() -> Mapping[str, Declaration]:
    """Return all exercises by name."""
    names = sorted(
        entry.name.removesuffix(".yaml")
        for entry in (files("app.exercises") / "data").iterdir()
        if entry.name.endswith(".yaml")
    )
    return {
        name: msgspec.convert(read_yaml_file("data", name), Declaration, strict=False)
        for name in names
    }


def exercise_named(name: str) -> Declaration:
    """Return an exercise.

    Raises:
        RequestProblem: 404, there is none of this name.
    """
    known = exercises()
    if name not in known:
        raise RequestProblem(
            NOT_FOUND,
            say(
                "there is no exercise {name!r}; {hint}",
                name=name[:64],
                hint=hint(name, tuple(known)),
            ),
        )
    return known[name]
