"""Exceptions of the packages below -> problems: type, places, and the remedy in words of the API.

The exceptions carry data and say what is wrong; routes, headers and settings are named here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from app.http.pointers import json_pointer
from app.http.problems import (
    BUSY,
    GENERIC_TYPES,
    MALFORMED_BODY,
    TOO_LARGE,
    ErrorEntry,
    ProblemType,
)
from dh_to_urdf import DHError
from dh_to_urdf.errors import DHSyntaxError
from kinematics import errors as kinematics
from kinematics.symbolic import SymbolicUnavailable
from robots import errors as robots


@dataclass(frozen=True, slots=True)
class Rendering:
    """How an exception leaves the service.

    Attributes:
        type: The kind of problem.
        message: Writes what is wrong and what to send instead; for a ``DHError``, whose faults
            are written one by one, not called.
    """

    type: ProblemType
    message: Callable[[Any], str] = str


def _robot_exists(error: robots.RobotExists) -> str:
    return f"{error}; choose another name, or repeat the request with ?overwrite=true to replace it"


def _robot_of_another(error: robots.AnothersRobot) -> str:
    return (
        f"{error}; to {error.change} it, send If-Match with its ETag (GET"
        f" /v1/robots/{error.robot_id}), or add ?overwrite=true"
        + ("; else choose another id" if error.change == "replace" else "")
    )


def _shared_robot(error: robots.SharedRobot) -> str:
    return f"{error}; one of scope share changes it; PUT stores a robot of your own under this id"


def _revision_mismatch(error: robots.RevisionMismatch) -> str:
    if error.current == robots.DAMAGED:
        return f"{error}; upload it without If-Match"
    return f"{error}; read it again and repeat the request"


def _damaged_robot(error: robots.DamagedRobot) -> str:
    return f"{error}; upload the robot again (PUT /v1/robots/{error.robot_id}), or delete it"


def _quota_reached(error: robots.QuotaReached) -> str:
    counted, setting = {
        ("robots", "store"): ("uploaded robots", "DENAVIT_MAX_ROBOTS"),
        ("bytes", "store"): ("bytes of uploaded robots", "DENAVIT_MAX_STORED_BYTES"),
        ("robots", "namespace"): ("uploaded robots", "DENAVIT_MAX_NAMESPACE_ROBOTS"),
        ("bytes", "namespace"): ("bytes of uploaded robots", "DENAVIT_MAX_NAMESPACE_BYTES"),
    }[error.quota, error.holder]
    whose = "store" if error.holder == "store" else "namespace of a key"
    return (
        f"the {whose} takes {error.limit} {counted} at most ({setting}), and this robot would"
        " exceed that; delete robots (DELETE /v1/robots/{id}), or send the robot in the body of a"
        " computation: that stores nothing"
    )


def _storage_full(_: robots.StorageFull) -> str:
    return (
        "the disk of the service is full and the robot was not stored; what was stored before is"
        " intact; delete robots, or have the operator make room, then repeat the request"
    )


def _storage_unavailable(error: robots.StorageUnavailable) -> str:
    return (
        f"{error.fault}; shipped robots and robots in the body of a request work; repeat the"
        " request later"
    )


RENDERINGS: dict[type[Exception], Rendering] = {
    DHSyntaxError: Rendering(MALFORMED_BODY),
    DHError: Rendering(ProblemType("invalid-table", 422, "The D-H table cannot be used")),
    robots.InvalidURDF: Rendering(ProblemType("invalid-urdf", 422, "The URDF cannot be used")),
    robots.RobotTooLarge: Rendering(ProblemType("robot-too-large", 422, "The robot is too large")),
    robots.UnknownFrame: Rendering(
        ProblemType("unknown-frame", 422, "The robot has no such frame")
    ),
    robots.RobotNotFound: Rendering(ProblemType("robot-not-found", 404, "There is no such robot")),
    robots.InvalidRobotId: Rendering(
        ProblemType("invalid-robot-id", 422, "This id cannot name a robot")
    ),
    robots.MeshNotFound: Rendering(
        ProblemType("mesh-not-found", 404, "The robot has no such mesh")
    ),
    robots.RobotExists: Rendering(
        ProblemType("robot-exists", 409, "The id is taken"), _robot_exists
    ),
    robots.AnothersRobot: Rendering(
        ProblemType("unconfirmed-overwrite", 428, "The id holds another robot"), _robot_of_another
    ),
    robots.SharedRobot: Rendering(
        ProblemType("shared-robot", 403, "Shared robots are changed by keys that share"),
        _shared_robot,
    ),
    robots.ReadOnlyRobot: Rendering(
        ProblemType("read-only-robot", 409, "Shipped robots are read-only")
    ),
    robots.RevisionMismatch: Rendering(
        ProblemType("revision-mismatch", 412, "The robot has changed"), _revision_mismatch
    ),
    robots.DamagedRobot: Rendering(
        ProblemType("damaged-robot", 409, "The stored robot is damaged"), _damaged_robot
    ),
    robots.QuotaReached: Rendering(
        ProblemType("quota-reached", 409, "No more robots are taken"), _quota_reached
    ),
    robots.StorageFull: Rendering(
        ProblemType("storage-full", 507, "The disk is full"), _storage_full
    ),
    robots.StorageUnavailable: Rendering(
        ProblemType("storage-unavailable", 503, "Uploaded robots cannot be reached now"),
        _storage_unavailable,
    ),
    kinematics.WrongConfiguration: Rendering(
        ProblemType("invalid-q", 422, "q does not fit the robot")
    ),
    kinematics.WrongVector: Rendering(
        ProblemType("invalid-vector", 422, "A twist or wrench does not fit")
    ),
    kinematics.UnknownTask: Rendering(
        ProblemType("unknown-task", 422, "There is no such task space")
    ),
    kinematics.UnknownSequence: Rendering(
        ProblemType("unknown-euler-sequence", 422, "There is no such Euler sequence")
    ),
    kinematics.RepresentationSingularity: Rendering(
        ProblemType("representation-singularity", 422, "These Euler angles have no rates here")
    ),
    kinematics.InvalidTarget: Rendering(
        ProblemType("invalid-target", 422, "The target is no pose")
    ),
    kinematics.InvalidAnswer: Rendering(
        ProblemType("invalid-answer", 422, "The answer cannot be checked")
    ),
    kinematics.InvalidOption: Rendering(
        ProblemType("invalid-option", 422, "An option is out of range")
    ),
    SymbolicUnavailable: Rendering(
        ProblemType("symbolic-unavailable", 501, "SymPy is not installed")
    ),
    kinematics.WorkersBusy: Rendering(BUSY),
    kinematics.OutOfMemory: Rendering(TOO_LARGE),
    kinematics.OutOfTime: Rendering(
        ProblemType("out-of-time", 422, "The computation takes too long")
    ),
    kinematics.RankDeficient: Rendering(
        ProblemType("rank-deficient", 422, "The Jacobian has lost rank")
    ),
    kinematics.MethodUnavailable: Rendering(
        ProblemType("method-unavailable", 501, "The method needs a package that is not installed")
    ),
}

ALL_TYPES = {
    type_.slug: type_ for type_ in (*(one.type for one in RENDERINGS.values()), *GENERIC_TYPES)
}


def rendered(error: Exception) -> tuple[ProblemType, Sequence[ErrorEntry], dict[str, str]]:
    """Return type, entries and headers of the problem that an exception of the table stands for."""
    kind = next(kind for kind in type(error).__mro__ if kind in RENDERINGS)
    rendering = RENDERINGS[kind]
    if isinstance(error, DHError):
        faults = [ErrorEntry(json_pointer(one.location), one.message) for one in error.faults]
        return rendering.type, faults, {}
    retry = getattr(error, "retry_after", None)
    headers = {} if retry is None else {"Retry-After": str(math.ceil(retry))}
    return rendering.type, [ErrorEntry(_pointer(error), rendering.message(error))], headers


def _pointer(error: Exception) -> str:
    """Return where the value at fault stands: within the document, or within the argument."""
    if isinstance(error, (robots.InvalidURDF, robots.RobotTooLarge, kinematics.KinematicsError)):
        return json_pointer(error.location)
    argument, index = getattr(error, "argument", ""), getattr(error, "index", ())
    return json_pointer((argument, *index) if argument else index)
