"""Who changes stored robots, and what of others is spared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from robots.errors import AnothersRobot, Change


@dataclass(frozen=True, slots=True)
class Writer:
    """Who changes a store, and what of others may be changed unasked.

    Attributes:
        name: Name of the key; None where nobody has one.
        spares: Whether what others have stored is spared.
    """

    name: str | None = None
    spares: bool = False

    def check(self, robot_id: str, maker: str | None, change: Change = "replace") -> None:
        """Refuse to change the robot of another.

        Raises:
            AnothersRobot: It is spared, and not known to be this writer's.
        """
        if self.spares and (self.name is None or self.name != maker):
            raise AnothersRobot(robot_id, change)


ANYBODY: Final = Writer()
"""Changes whatever is stored."""
