"""Bounds of options: the one place from which checks, messages and schemas take them."""

from __future__ import annotations

from dataclasses import dataclass

from dh_to_urdf.errors import Location
from kinematics.errors import InvalidOption

MAX_VALUE = 1e6
"""Largest magnitude of a joint value, a coordinate or a velocity, in rad, m, rad/s or m/s."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """Interval of the values that an option takes.

    Attributes:
        lower: Least value, included.
        upper: Largest value.
        upper_included: Whether the largest value itself is accepted.
    """

    lower: float
    upper: float
    upper_included: bool = True

    def __contains__(self, value: float) -> bool:
        """Return whether a value is accepted; NaN is not."""
        return self.lower <= value < self.upper or (self.upper_included and value == self.upper)

    def refusal(
        self, message: str, value: float, argument: str, index: Location = ()
    ) -> InvalidOption:
        """Return the exception for a value that is not accepted.

        Args:
            message: What is wrong and what to give instead.
            value: The value.
            argument: Name of the option.
            index: Place within it.
        """
        return InvalidOption(
            message,
            argument=argument,
            index=index,
            value=value,
            lower=self.lower,
            upper=self.upper,
        )
