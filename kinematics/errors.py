"""What can be wrong with a request for a computation; each exception carries its field."""

from __future__ import annotations


class KinematicsError(ValueError):
    """Root of this package's errors.

    Attributes:
        pointer: JSON pointer to the field at fault.
    """

    def __init__(self, message: str, pointer: str) -> None:
        self.pointer = pointer
        super().__init__(message)


class WrongConfiguration(KinematicsError):
    """A q (or seed) of a wrong length, with a wrong name or without a finite value."""


class WrongVector(KinematicsError):
    """A twist or wrench of a wrong length, or without a finite value."""


class UnknownTask(KinematicsError):
    """A task space that is neither a known name nor a mask of six."""


class UnknownSequence(KinematicsError):
    """Three letters that are no Euler sequence."""


class RepresentationSingularity(KinematicsError):
    """An orientation where the chosen Euler angles have no rates."""


class InvalidTarget(KinematicsError):
    """A target pose that cannot be read as one."""


class InvalidOption(KinematicsError):
    """An option of a solver out of its range."""


class RankDeficient(KinematicsError):
    """A Jacobian without full row rank, where the pseudo-inverse Jᵀ(JJᵀ)⁻¹ does not exist.

    Attributes:
        rank: Its rank.
        wanted: Its number of rows.
    """

    def __init__(self, message: str, pointer: str, rank: int, wanted: int) -> None:
        self.rank, self.wanted = rank, wanted
        super().__init__(message, pointer)


class OutOfTime(KinematicsError):
    """A computation that takes longer than one may."""

    def __init__(self) -> None:
        super().__init__("this takes longer than one request may; ask for less at once", "")


class MethodUnavailable(KinematicsError):
    """A method that needs a package that is not installed."""
