"""Comparison of what the joints of two chains depend on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dh_to_urdf.cells.notation import number_text, sum_text
from dh_to_urdf.couplings import JointMap, MovingJoint, joint_map
from dh_to_urdf.extraction.axes import ChainJoint, SerialChain
from dh_to_urdf.extraction.comparison_result import Comparison, Difference, Verdict
from dh_to_urdf.extraction.dependences import is_coupled
from dh_to_urdf.table import JointType

SAME = 1e-9
"""Largest difference of multipliers that count as one."""


def compared(
    found: Comparison, first: SerialChain, second: SerialChain, angle: float
) -> Comparison:
    """Return a comparison of two mechanisms, with what differs in their dependences."""
    if not (is_coupled(first) or is_coupled(second)):
        return found
    if len(found.joints) != len(first.joints) or len(first.joints) != len(second.joints):
        return found
    one, two = _map(first), _map(second)
    sense = np.array([-1.0 if joint.name in found.reversed else 1.0 for joint in second.joints])
    zeros = np.array([joint.zero_offset for joint in found.joints])
    differences = []
    for k in range(len(first.joints)):
        texts = _text(first, k), _text(second, k)
        if (k in one.free) is not (k in two.free):
            differences.append(_difference(first, k, "mimic", texts))
    if not differences:
        free = list(one.free)
        C, D = sense[:, None] * one.matrix, two.matrix * sense[free]
        wanted = sense * one.offset + zeros - two.offset
        shift, *_ = np.linalg.lstsq(two.matrix, wanted, rcond=None)
        off = np.abs(two.matrix @ shift - wanted) > max(angle, SAME)
        for k in range(len(first.joints)):
            if np.abs(C[k] - D[k]).max() > SAME or off[k]:
                field = "mimic" if first.joints[k].mimic is not None else "coupling"
                differences.append(
                    _difference(first, k, field, (_text(first, k), _text(second, k)))
                )
    if not differences:
        return found
    every = sorted((*found.differences, *differences), key=lambda one: one.joint)
    return replace(found, verdict=Verdict.DIFFERENT, differences=tuple(every))


def _map(chain: SerialChain) -> JointMap:
    return joint_map(
        [
            MovingJoint(j.name, j.type, j.limits, j.mimic, j.coupling)
            for j in map(_loose, chain.joints)
        ]
    )


def _loose(joint: ChainJoint) -> ChainJoint:
    """Return a joint that turns without being continuous: parts of a robot are compared."""
    turns = joint.type is not JointType.PRISMATIC
    return replace(joint, type=JointType.REVOLUTE if turns else JointType.PRISMATIC)


def _difference(chain: SerialChain, k: int, field: str, texts: tuple[str, str]) -> Difference:
    return Difference(k + 1, chain.joints[k].name, field, *texts, None, None)


def _text(chain: SerialChain, k: int) -> str:
    joint = chain.joints[k]
    variables = {other.name: f"q{n}" for n, other in enumerate(chain.joints, start=1)}
    if joint.mimic is None and not joint.coupling:
        return "free"
    first, constant = (variables[joint.name], 1.0), 0.0
    if joint.mimic is not None:
        first = (variables[joint.mimic.joint], joint.mimic.multiplier)
        constant = joint.mimic.offset
    terms = [first, *((variables[name], c) for name, c in joint.coupling)]
    return sum_text(terms, number_text(constant))
