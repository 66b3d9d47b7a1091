"""Values of a URDF that are read as they stand, rad and m, and are probably meant otherwise."""

from __future__ import annotations

from collections.abc import Sequence

from dh_to_urdf.cells.doubts import Doubts, Remedies, is_like_degree_limit, is_like_degrees
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import chained, say
from robots.urdf.description import URDFJoint
from robots.urdf.values import Element

_REMEDIES = Remedies(
    say("a URDF is in rad: write 1.5707963267948966 for 90°"),
    say("a URDF is in rad"),
    say("a URDF is in m: write 0.3 for 300 mm"),
    say("a URDF is in m"),
)
_TOLD = 3
"""Joints that a warning names."""


def doubts_of(joints: Sequence[URDFJoint]) -> tuple[str, ...]:
    """Return a warning for each kind of values of joints that looks wrong.

    Args:
        joints: The joints, as read.
    """
    doubts = Doubts(_REMEDIES)
    for joint in joints:
        where = say("joint {joint}", joint=quoted(joint.name, 64))
        for name, angle in zip(("roll", "pitch", "yaw"), joint.origin.rpy, strict=True):
            if is_like_degrees(angle):
                doubts.angle(angle, say("{name} of {where}", name=name, where=where))
        for name, length in zip("xyz", joint.origin.xyz, strict=True):
            doubts.length(length, say("{name} of {where}", name=name, where=where))
        for name, limit in (("lower", joint.lower), ("upper", joint.upper)):
            if limit is None:
                continue
            if joint.type == "prismatic":
                doubts.length(
                    limit, say("{name} limit of {where}", name=name, where=where), limit=True
                )
            elif is_like_degree_limit(limit):
                doubts.angle(
                    limit, say("{name} limit of {where}", name=name, where=where), limit=True
                )
    return doubts.sentences()


def limits_left_out(elements: Sequence[Element]) -> tuple[str, ...]:
    """Return a warning that names the continuous joints whose limits are left out.

    Args:
        elements: The <joint> elements.
    """
    found = []
    for element in elements:
        limit = element.find("limit")
        if element.get("type") == "continuous" and limit is not None:
            lower, upper = limit.get("lower"), limit.get("upper")
            if (lower, upper) != (None, None) and not _no_range(lower, upper):
                found.append(
                    say(
                        "{joint} ({lower} to {upper})",
                        joint=quoted(element.get("name", ""), 64),
                        lower=_shown(lower),
                        upper=_shown(upper),
                    )
                )
    if not found:
        return ()
    more = say(" and {count} more", count=len(found) - _TOLD) if len(found) > _TOLD else ""
    return (
        say(
            "lower and upper limits of continuous joints are left out, as URDF"
            " says: {found}{more}; make them revolute to keep the limits",
            found=chained(", ", found[:_TOLD]),
            more=more,
        ),
    )


def _shown(limit: str | None) -> str:
    if not limit:
        return say("none")
    return limit if set(limit) <= set("0123456789+-.eE") and len(limit) < 32 else quoted(limit, 24)


def _no_range(lower: str | None, upper: str | None) -> bool:
    """Return whether limits say nothing: writers put zeros where there are none."""
    return not set(f"{lower or ''}{upper or ''}") & set("123456789")
