"""Result of a comparison of two chains: verdict, differences, joints, and their wording."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from dh_to_urdf.extraction.extract import Residual
from dh_to_urdf.messages import chained, say


class Verdict(StrEnum):
    """Verdict of a comparison."""

    IDENTICAL = "identical"
    EQUIVALENT = "equivalent"
    DIFFERENT = "different"


@dataclass(frozen=True, slots=True)
class Difference:
    """One parameter that differs.

    Attributes:
        joint: Number of the joint, from 1.
        name: Its name in the first chain.
        parameter: alpha, a, d or theta of the standard row; type; or joints, for their number.
        first: Value in the first chain, rad or m; the type; the number.
        second: Value in the second chain.
        difference: second - first, rad (within ±π) or m; None where it is no number.
        absorbed_by: ``base`` or ``tool`` where a change of it would hide the difference.
    """

    joint: int
    name: str
    parameter: str
    first: float | str
    second: float | str
    difference: float | None
    absorbed_by: str | None


@dataclass(frozen=True, slots=True)
class JointComparison:
    """One joint in both chains.

    Attributes:
        first: Its name in the first chain.
        second: Its name in the second chain.
        is_revolute: True where zero_offset is an angle.
        zero_offset: What to add to q of the first chain to get q of the second, rad or m.
        position: Largest distance between the frames after this joint, m, over random q, with
            frames 0 and zero offsets made equal.
        orientation: Largest angle between them, rad.
    """

    first: str
    second: str
    is_revolute: bool
    zero_offset: float
    position: float
    orientation: float


@dataclass(frozen=True)
class Comparison:
    """Result of a comparison of two chains.

    Attributes:
        verdict: identical; equivalent, up to base, tool and zero offsets; or different.
        differences: What differs beyond the tolerances, base first.
        joints: Joint by joint, as far as both chains have the same kinds of joints.
        reversed: Joints of the second chain that run the other way, if that is all.
        residual: Largest deviation of the tips over random q with base, tool and zero offsets
            made equal; None where the kinds of joints differ.
        same_poses: Whether the tips have the same poses at the same q, nothing made equal.
    """

    verdict: Verdict
    differences: tuple[Difference, ...]
    joints: tuple[JointComparison, ...]
    reversed: tuple[str, ...]
    residual: Residual | None
    same_poses: bool = False

    @property
    def words(self) -> str:
        """Return the verdict in one or two sentences."""
        if self.verdict is Verdict.IDENTICAL:
            return (
                say("The same arm.")
                if self.same_poses
                else say("The same arm, on another base or tool.")
            )
        said = []
        if self.reversed:
            said.append(
                say("Joint {reversed} runs the other way.", reversed=", ".join(self.reversed))
            )
        if self.differences:
            said.append(
                say(
                    "They diverge first at {difference}.", difference=_sentence(self.differences[0])
                )
            )
            inner = next((d for d in self.differences if d.absorbed_by is None), None)
            if self.verdict is Verdict.EQUIVALENT and not self.reversed:
                said.append(say("Otherwise the same arm") + self._offsets() + ".")
            elif inner is not None and inner is not self.differences[0]:
                said.append(
                    say(
                        "What neither base nor tool can hide begins at {inner}.",
                        inner=_sentence(inner),
                    )
                )
        if not said and self.verdict is Verdict.DIFFERENT and self.residual is not None:
            said.append(
                say(
                    "No parameter differs by more than the tolerances, but the tips drift"
                    " apart by {position:.3g} m and {orientation:.3g} rad.",
                    position=self.residual.position,
                    orientation=self.residual.orientation,
                )
            )
        if (
            self.verdict is Verdict.DIFFERENT
            and sum(not one.is_revolute for one in self.joints) > 1
        ):
            said.append(
                say(
                    "(Several joints slide: zeros that fit better may exist, and with them"
                    " a later divergence.)"
                )
            )
        return chained(" ", said) or say("The same arm") + self._offsets() + "."

    def _offsets(self) -> str:
        moved = sum(abs(joint.zero_offset) > 1e-9 for joint in self.joints)
        return say(", with {moved} other zero(s) of the joints", moved=moved) if moved else ""


def _sentence(difference: Difference) -> str:
    what = say(
        "joint {joint} ({difference}): {parameter} is",
        joint=difference.joint,
        difference=difference.name,
        parameter=difference.parameter,
    )
    if difference.difference is None:
        return say(
            "{what} {first} in the first and {second} in the second",
            what=what,
            first=difference.first,
            second=difference.second,
        )
    unit = "m" if difference.parameter in ("a", "d") else "rad"
    hidden = (
        say(", which another {absorbed_by} hides", absorbed_by=difference.absorbed_by)
        if difference.absorbed_by
        else ""
    )
    return say(
        "{what} {first:.9g} {unit} in the first and {second:.9g} {unit} in the"
        " second, a difference of {difference:.3g} {unit}{hidden}",
        what=what,
        first=difference.first,
        unit=unit,
        second=difference.second,
        difference=abs(difference.difference),
        hidden=hidden,
    )
