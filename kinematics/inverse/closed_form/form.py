"""What a solver needs to know of an arm that it solves in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from robots.robot import FloatArray

Kind = Literal[
    "three_joints",
    "spherical_wrist",
    "parallel_axes",
    "planar_2r",
    "planar_3r",
    "planar",
    "scara",
    "srs",
]

Names = tuple[str, ...]

FRONT: Names = ("front", "back")
ELBOW: Names = ("up", "down")
SIGN: Names = ("positive", "negative")
EXTENDED: Names = ("extended", "retracted")
RANKS: Names = ("first", "second", "third", "fourth")
ONE: Names = ("",)
"""Of a choice that there is not."""


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """What a solver needs to know of a chain.

    Attributes:
        kind: The class of arm.
        constants: Numbers for the compiled solver of this class, shape (n,).
        description: For people: what was recognised.
        tasks: Names of the tasks it solves.
        postures: The choices, each with the names of its values 0, 1, …
        most: Largest number of solutions (for one swivel angle).
        ranked: The joint by whose values solutions get the first choice's names, smallest first;
            None where the first choice is decided by geometry.
    """

    kind: Kind
    constants: FloatArray
    description: str
    tasks: tuple[str, ...]
    postures: tuple[Names, ...]
    most: int
    ranked: int | None = None


def types_of(turning: list[bool]) -> str:
    """Return joint types in a word: ``RRP``."""
    return "".join("R" if one else "P" for one in turning)
