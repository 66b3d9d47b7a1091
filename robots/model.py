"""A checked description -> Pinocchio's model, joint by joint.

Pinocchio's own reader of URDF texts recurses once a link of a chain (300 links overflow a stack of
512 kB) and does not say what is wrong, or where. It is not used: Pinocchio gets numbers only.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from robots.urdf import URDFDescription, URDFJoint
from robots.urdf.description import Origin

_ALONG_AXIS = {
    (1.0, 0.0, 0.0): (pin.JointModelRX, pin.JointModelPX),
    (0.0, 1.0, 0.0): (pin.JointModelRY, pin.JointModelPY),
    (0.0, 0.0, 1.0): (pin.JointModelRZ, pin.JointModelPZ),
}


def build_model(description: URDFDescription) -> Any:
    """Build the model: one joint with one value a moving joint, one body frame a link.

    The parent of a link's frame is that of its parent link; the root's is the universe. Fixed
    joints are no joints of the model. A continuous joint takes its angle, not (cos, sin).
    Limits that the description does not have are infinite. The model is for kinematics: masses and
    inertias are in the canonical URDF only.
    """
    model = pin.Model()
    model.name = description.name
    carriers = {description.root: (0, pin.SE3.Identity())}
    for joint in description.parents_first():
        parent, placement = carriers[joint.parent]
        placement = placement * _placement(joint.origin)
        if joint.type == "fixed":
            carriers[joint.child] = parent, placement
        else:
            number = model.addJoint(parent, _motion(joint), placement, joint.name, *_limits(joint))
            carriers[joint.child] = number, pin.SE3.Identity()
    parents = {joint.child: joint.parent for joint in description.parents_first()}
    numbers: dict[str, int] = {}
    for link in (description.root, *parents):
        number, placement = carriers[link]
        above = numbers[parents[link]] if link in parents else 0
        frame = pin.Frame(link, number, above, placement, pin.FrameType.BODY, pin.Inertia.Zero())
        numbers[link] = model.addFrame(frame, False)
    return model


def _placement(origin: Origin) -> Any:
    return pin.SE3(pin.rpy.rpyToMatrix(*origin.rpy), np.array(origin.xyz))


def _motion(joint: URDFJoint) -> Any:
    assert joint.axis is not None
    slides = joint.type == "prismatic"
    along = _ALONG_AXIS.get(joint.axis)
    if along is not None:
        return along[slides]()
    general = pin.JointModelPrismaticUnaligned if slides else pin.JointModelRevoluteUnaligned
    return general(np.array(joint.axis))


def _limits(joint: URDFJoint) -> tuple[Any, ...]:
    """Return effort, speed, lower and upper, as Pinocchio takes them."""
    effort, velocity = (np.inf if v is None else v for v in (joint.effort, joint.velocity))
    lower = -np.inf if joint.lower is None else joint.lower
    upper = np.inf if joint.upper is None else joint.upper
    return tuple(np.array([value]) for value in (effort, velocity, lower, upper))
