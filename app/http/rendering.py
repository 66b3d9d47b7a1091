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
from dh_to_urdf.messages import say
from kinematics import errors as kinematics
from kinematics.symbolic import SymbolicUnavailable
from robots import errors as robots


@dataclass(frozen=True, slots=True)
class Rendering:
    """How an exception leaves the service.

    Attributes:
        type: The kind of problem.
        message: Writes what is wrong and what to send instead; for a ``DHError`` and an
            ``InvalidURDF``, whose faults are written one by one, not called.
    """

    type: ProblemType
    message: Callable[[Any], str] = str


def _robot_exists(error: robots.RobotExists) -> str:
    return say(
        "{error}; choose another name, or repeat the request with ?overwrite=true to replace it",
        error=error,
    )


def _invalid_archive(error: robots.InvalidArchive) -> str:
    if not error.several:
        return str(error)
    return say("{error}, as ?urdf=arm/urdf/arm.urdf", error=error)


_CHANGES = {"replace": say("replace"), "delete": say("delete")}


def _robot_of_another(error: robots.AnothersRobot) -> str:
    return say(
        "{error}; to {change} it, send If-Match with its ETag (GET"
        " /v1/robots/{robot_id}), or add ?overwrite=true",
        error=error,
        change=_CHANGES[error.change],
        robot_id=error.robot_id,
    ) + (say("; else choose another id") if error.change == "replace" else "")


def _shared_robot(error: robots.SharedRobot) -> str:
    return say(
        "{error}; one of scope share changes it; PUT stores a robot of your own under this id",
        error=error,
    )


def _revision_mismatch(error: robots.RevisionMismatch) -> str:
    if error.current == robots.DAMAGED:
        return say("{error}; upload it without If-Match", error=error)
    return say("{error}; read it again and repeat the request", error=error)


def _damaged_robot(error: robots.DamagedRobot) -> str:
    return say(
        "{error}; upload the robot again (PUT /v1/robots/{robot_id}), or delete it",
        error=error,
        robot_id=error.robot_id,
    )


def _quota_reached(error: robots.QuotaReached) -> str:
    counted, setting = {
        ("robots", "store"): (say("uploaded robots"), "DENAVIT_MAX_ROBOTS"),
        ("bytes", "store"): (say("bytes of uploaded robots"), "DENAVIT_MAX_STORED_BYTES"),
        ("robots", "namespace"): (say("uploaded robots"), "DENAVIT_MAX_NAMESPACE_ROBOTS"),
        ("bytes", "namespace"): (say("bytes of uploaded robots"), "DENAVIT_MAX_NAMESPACE_BYTES"),
    }[error.quota, error.holder]
    whose = say("store") if error.holder == "store" else say("namespace of a key")
    return say(
        "the {whose} takes {limit} {counted} at most ({setting}), and this"
        " robot would exceed that; delete robots (DELETE /v1/robots/{{id}}), or"
        " send the robot in the body of a computation: that stores nothing",
        whose=whose,
        limit=error.limit,
        counted=counted,
        setting=setting,
    )


def _storage_full(_: robots.StorageFull) -> str:
    return say(
        "the disk of the service is full and the robot was not stored; what was"
        " stored before is intact; delete robots, or have the operator make"
        " room, then repeat the request"
    )


def _storage_unavailable(error: robots.StorageUnavailable) -> str:
    return say(
        "{fault}; shipped robots and robots in the body of a request work;"
        " repeat the request later",
        fault=error.fault,
    )


RENDERINGS: dict[type[Exception], Rendering] = {
    DHSyntaxError: Rendering(MALFORMED_BODY),
    DHError: Rendering(ProblemType("invalid-table", 422, say("The D-H table cannot be used"))),
    robots.InvalidURDF: Rendering(ProblemType("invalid-urdf", 422, say("The URDF cannot be used"))),
    robots.RobotTooLarge: Rendering(
        ProblemType("robot-too-large", 422, say("The robot is too large"))
    ),
    robots.UnknownFrame: Rendering(
        ProblemType("unknown-frame", 422, say("The robot has no such frame"))
    ),
    robots.WrongLimits: Rendering(
        ProblemType("invalid-limits", 422, say("The limits do not fit the robot"))
    ),
    robots.RobotNotFound: Rendering(
        ProblemType("robot-not-found", 404, say("There is no such robot"))
    ),
    robots.InvalidRobotId: Rendering(
        ProblemType("invalid-robot-id", 422, say("This id cannot name a robot"))
    ),
    robots.InvalidMesh: Rendering(ProblemType("invalid-mesh", 422, say("The mesh cannot be used"))),
    robots.InvalidArchive: Rendering(
        ProblemType("invalid-archive", 422, say("The archive cannot be used")), _invalid_archive
    ),
    robots.MeshesTooLarge: Rendering(
        ProblemType("meshes-too-large", 422, say("The meshes of the robot are too large"))
    ),
    robots.AmbiguousMesh: Rendering(
        ProblemType("ambiguous-mesh", 422, say("Several meshes have this name"))
    ),
    robots.MeshNotFound: Rendering(
        ProblemType("mesh-not-found", 404, say("The robot has no such mesh"))
    ),
    robots.RobotExists: Rendering(
        ProblemType("robot-exists", 409, say("The id is taken")), _robot_exists
    ),
    robots.AnothersRobot: Rendering(
        ProblemType("unconfirmed-overwrite", 428, say("The id holds another robot")),
        _robot_of_another,
    ),
    robots.SharedRobot: Rendering(
        ProblemType("shared-robot", 403, say("Shared robots are changed by keys that share")),
        _shared_robot,
    ),
    robots.ReadOnlyRobot: Rendering(
        ProblemType("read-only-robot", 409, say("Shipped robots are read-only"))
    ),
    robots.RevisionMismatch: Rendering(
        ProblemType("revision-mismatch", 412, say("The robot has changed")), _revision_mismatch
    ),
    robots.DamagedRobot: Rendering(
        ProblemType("damaged-robot", 409, say("The stored robot is damaged")), _damaged_robot
    ),
    robots.QuotaReached: Rendering(
        ProblemType("quota-reached", 409, say("No more robots are taken")), _quota_reached
    ),
    robots.StorageFull: Rendering(
        ProblemType("storage-full", 507, say("The disk is full")), _storage_full
    ),
    robots.StorageUnavailable: Rendering(
        ProblemType("storage-unavailable", 503, say("Uploaded robots cannot be reached now")),
        _storage_unavailable,
    ),
    kinematics.WrongConfiguration: Rendering(
        ProblemType("invalid-q", 422, say("q does not fit the robot"))
    ),
    kinematics.WrongVector: Rendering(
        ProblemType("invalid-vector", 422, say("A twist or wrench does not fit"))
    ),
    kinematics.UnknownTask: Rendering(
        ProblemType("unknown-task", 422, say("There is no such task space"))
    ),
    kinematics.UnknownSequence: Rendering(
        ProblemType("unknown-euler-sequence", 422, say("There is no such Euler sequence"))
    ),
    kinematics.RepresentationSingularity: Rendering(
        ProblemType("representation-singularity", 422, say("These Euler angles have no rates here"))
    ),
    kinematics.InvalidTarget: Rendering(
        ProblemType("invalid-target", 422, say("The target is no pose"))
    ),
    kinematics.InvalidAnswer: Rendering(
        ProblemType("invalid-answer", 422, say("The answer cannot be checked"))
    ),
    kinematics.InvalidOption: Rendering(
        ProblemType("invalid-option", 422, say("An option is out of range"))
    ),
    SymbolicUnavailable: Rendering(
        ProblemType("symbolic-unavailable", 501, say("SymPy is not installed"))
    ),
    kinematics.WorkersBusy: Rendering(BUSY),
    kinematics.OutOfMemory: Rendering(TOO_LARGE),
    kinematics.OutOfTime: Rendering(
        ProblemType("out-of-time", 422, say("The computation takes too long"))
    ),
    kinematics.RankDeficient: Rendering(
        ProblemType("rank-deficient", 422, say("The Jacobian has lost rank"))
    ),
    kinematics.MethodUnavailable: Rendering(
        ProblemType(
            "method-unavailable", 501, say("The method needs a package that is not installed")
        )
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
    if isinstance(error, robots.InvalidURDF):
        pointer = json_pointer(error.location)
        entries = [ErrorEntry(pointer, one.message, one.line, one.xpath) for one in error.faults]
        return rendering.type, entries, {}
    retry = getattr(error, "retry_after", None)
    headers = {} if retry is None else {"Retry-After": str(math.ceil(retry))}
    return rendering.type, [ErrorEntry(_pointer(error), rendering.message(error))], headers


def _pointer(error: Exception) -> str:
    """Return where the value at fault stands: within the document, or within the argument."""
    if isinstance(error, (robots.RobotTooLarge, robots.WrongLimits, kinematics.KinematicsError)):
        return json_pointer(error.location)
    argument, index = getattr(error, "argument", ""), getattr(error, "index", ())
    return json_pointer((argument, *index) if argument else index)
