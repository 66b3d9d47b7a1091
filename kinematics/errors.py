"""Exceptions of the kernel: what is wrong with a call, as a sentence and as data."""

from __future__ import annotations

from typing import TypedDict, Unpack

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say


class ErrorData(TypedDict, total=False):
    """Keyword arguments of every exception of this package; see :class:`KinematicsError`."""

    argument: str
    index: Location
    value: float | str | None
    lower: float | None
    upper: float | None
    known: tuple[str, ...]


class KinematicsError(ValueError):
    """Root of this package's errors.

    Attributes:
        argument: Name of the argument at fault, as the caller named it; empty where it is none.
        index: Place within the argument, such as ``(3, "center")``; empty for all of it.
        value: The value at fault; None where it is not one number or name.
        lower: Least value that is accepted; None where that is no matter of a bound.
        upper: Largest value that is accepted; likewise.
        known: Names that are accepted; empty where it is no matter of names.
    """

    def __init__(
        self,
        message: str,
        *,
        argument: str = "",
        index: Location = (),
        value: float | str | None = None,
        lower: float | None = None,
        upper: float | None = None,
        known: tuple[str, ...] = (),
    ) -> None:
        super().__init__(message)
        self.argument = argument
        self.index = index
        self.value = value
        self.lower = lower
        self.upper = upper
        self.known = known

    @property
    def location(self) -> Location:
        """Argument and index in one; empty where no argument is at fault."""
        return (self.argument, *self.index) if self.argument else ()


class WrongConfiguration(KinematicsError):
    """A q (or seed) of a wrong length, with a wrong name or without a finite value.

    Attributes:
        joint: Name of the joint whose value is at fault; None where it is not one.
        expected: Number of values that fit; None where the number is right.
        missing: Names of joints without a value.
    """

    def __init__(
        self,
        message: str,
        *,
        joint: str | None = None,
        expected: int | None = None,
        missing: tuple[str, ...] = (),
        **data: Unpack[ErrorData],
    ) -> None:
        super().__init__(message, **data)
        self.joint, self.expected, self.missing = joint, expected, missing


class WrongVector(KinematicsError):
    """A twist or wrench of a wrong length, or without a finite value.

    Attributes:
        rows: Names of the values that fit, such as ``("vx", "vy")``.
        expected: Number of values, or of rows of a batch, that fits; None where it is right.
    """

    def __init__(
        self,
        message: str,
        *,
        rows: tuple[str, ...] = (),
        expected: int | None = None,
        **data: Unpack[ErrorData],
    ) -> None:
        super().__init__(message, **data)
        self.rows, self.expected = rows, expected


class UnknownTask(KinematicsError):
    """A task space that is neither a known name nor a mask of six."""


class UnknownSequence(KinematicsError):
    """Three letters that are no Euler sequence."""


class RepresentationSingularity(KinematicsError):
    """An orientation where the chosen Euler angles have no rates.

    Attributes:
        sequence: The Euler sequence.
        determinant: Least |det E| of the orientations, where E maps rates to angular velocity.
    """

    def __init__(
        self, message: str, *, sequence: str, determinant: float, **data: Unpack[ErrorData]
    ) -> None:
        super().__init__(message, **data)
        self.sequence, self.determinant = sequence, determinant


class InvalidTarget(KinematicsError):
    """A target pose that cannot be read as one.

    Attributes:
        task: Name of the task that the target does not fit; None where it fits no task.
        expected: Number of values that fits; None where the number is right.
    """

    def __init__(
        self,
        message: str,
        *,
        task: str | None = None,
        expected: int | None = None,
        **data: Unpack[ErrorData],
    ) -> None:
        super().__init__(message, **data)
        self.task, self.expected = task, expected


class InvalidOption(KinematicsError):
    """An option of a solver out of its range."""


class InvalidAnswer(KinematicsError):
    """An answer to check that has another form than the quantity, or cannot be read.

    Attributes:
        position: Place of the fault in a formula, from 0; None where it is no matter of one.
    """

    def __init__(
        self, message: str, *, position: int | None = None, **data: Unpack[ErrorData]
    ) -> None:
        super().__init__(message, **data)
        self.position = position


class RankDeficient(KinematicsError):
    """A Jacobian without full row rank, where the pseudo-inverse Jᵀ(JJᵀ)⁻¹ does not exist.

    Attributes:
        rank: Its rank.
        wanted: Its number of rows.
        known: Tasks in which this arm can have full row rank, where it cannot in the given one.
    """

    def __init__(self, message: str, *, rank: int, wanted: int, **data: Unpack[ErrorData]) -> None:
        super().__init__(message, **data)
        self.rank, self.wanted = rank, wanted


class OutOfTime(KinematicsError):
    """A computation that takes longer than one may."""

    def __init__(self) -> None:
        super().__init__(say("this takes longer than one request may; ask for less at once"))


class OutOfMemory(KinematicsError):
    """A computation that needs more memory than it may take.

    Attributes:
        memory: What it may take, bytes.
    """

    def __init__(self, memory: int, message: str = "", **data: Unpack[ErrorData]) -> None:
        self.memory = memory
        text = say(
            "this needs more than the {memory:.0f} MB that it may take; ask for less",
            memory=memory / 1000000.0,
        )
        super().__init__(message or text, **data)


class WorkersBusy(KinematicsError):
    """Every process for some work is busy, or it was stopped from outside.

    Attributes:
        retry_after: Time after which to try again, s.
    """

    def __init__(self, message: str, retry_after: float) -> None:
        self.retry_after = retry_after
        super().__init__(message)


class MethodUnavailable(KinematicsError):
    """A method that needs a package that is not installed.

    Attributes:
        package: Name of the package.
        extra: The extra of this distribution that installs it.
    """

    def __init__(
        self, message: str, *, package: str, extra: str, **data: Unpack[ErrorData]
    ) -> None:
        super().__init__(message, **data)
        self.package, self.extra = package, extra


def dotted(argument: str, index: Location = ()) -> str:
    """Return an argument, or a place in it, as messages name it: ``targets.3.position``."""
    return ".".join((argument, *map(str, index)))
